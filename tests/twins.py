"""The same robot in Pinocchio, with joints matched by name."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from cutpoint import Robot
from cutpoint.model import WORLD, Mechanism

Array = NDArray[np.float64]


def pinocchio_of(mechanism: Mechanism) -> pin.Model:
    """A Pinocchio model built by hand, joint by joint; both number joints depth first."""
    model = pin.Model()
    model.gravity.linear = np.asarray(mechanism.gravity)
    for body in mechanism.bodies:
        parent = 0 if body.parent == WORLD else body.parent + 1
        index = model.addJoint(parent, _joint_model(body.joint), se3(body.placement), body.joint.name)
        model.appendBodyToJoint(index, pin.Inertia(body.mass, body.com, body.inertia), pin.SE3.Identity())
    for frame in mechanism.frames.values():
        model.addFrame(pin.Frame(frame.name, frame.body + 1, 0, se3(frame.placement), pin.FrameType.OP_FRAME))
    return model


def pinocchio_from(path: Any, floating_base: bool = False) -> pin.Model:
    """What Pinocchio itself makes of a URDF, rotors left out."""
    root = (pin.JointModelFreeFlyer(),) if floating_base else ()
    model = pin.buildModelFromUrdf(str(path), *root)
    model.armature = np.zeros(model.nv)
    return model


def se3(placement: Array) -> pin.SE3:
    return pin.SE3(np.array(placement[:3, :3]), np.array(placement[:3, 3]))


def _joint_model(joint: Any) -> Any:
    if joint.kind == "floating":
        return pin.JointModelFreeFlyer()
    unaligned = pin.JointModelPrismaticUnaligned if joint.kind == "prismatic" else pin.JointModelRevoluteUnaligned
    return unaligned(np.array(joint.axis))


@dataclass(frozen=True)
class Twin:
    """Pinocchio's side of a robot, in the robot's own order of coordinates; one state at a time."""

    robot: Robot
    model: pin.Model

    @cached_property
    def data(self) -> pin.Data:
        return self.model.createData()

    @cached_property
    def _columns(self) -> tuple[list[int], list[int]]:
        """For each of our coordinates, and for each of our speeds, where it stands in theirs."""
        q, v = [], []
        for body in self.robot.mechanism.bodies:
            joint = self.model.joints[self.model.getJointId(body.joint.name)]
            q += range(joint.idx_q, joint.idx_q + joint.nq)
            v += range(joint.idx_v, joint.idx_v + joint.nv)
        return q, v

    def theirs(self, *ours: Array) -> list[Array]:
        """Coordinates first, then speeds, accelerations, torques: in Pinocchio's order."""
        found = []
        for x, columns in zip(ours, (self._columns[0], *[self._columns[1]] * len(ours)), strict=False):
            found.append(np.zeros(len(columns)))
            found[-1][columns] = x
        return found

    def ours(self, tau: Any) -> Array:
        """A vector of speeds, or what has such an axis last, in our order."""
        return np.asarray(tau)[..., self._columns[1]]

    def inverse_dynamics(self, q: Array, v: Array, a: Array, forces: Any = None) -> Array:
        more = () if forces is None else (forces,)
        return self.ours(pin.rnea(self.model, self.data, *self.theirs(q, v, a), *more))

    def forward_dynamics(self, q: Array, v: Array, tau: Array, forces: Any = None) -> Array:
        more = () if forces is None else (forces,)
        return self.ours(pin.aba(self.model, self.data, *self.theirs(q, v, tau), *more))

    def mass_matrix(self, q: Array) -> Array:
        M = np.triu(pin.crba(self.model, self.data, *self.theirs(q)))
        return self.ours(self.ours(M + np.triu(M, 1).T).T)

    def bias_forces(self, q: Array, v: Array) -> Array:
        return self.ours(pin.nle(self.model, self.data, *self.theirs(q, v)))

    def gravity_forces(self, q: Array) -> Array:
        return self.ours(pin.computeGeneralizedGravity(self.model, self.data, *self.theirs(q)))

    def frame_pose(self, q: Array, frame: str) -> Array:
        pin.framesForwardKinematics(self.model, self.data, *self.theirs(q))
        return self.data.oMf[self.model.getFrameId(frame)].homogeneous

    def jacobian(self, q: Array, frame: str, expressed_in: str) -> Array:
        way = getattr(pin.ReferenceFrame, expressed_in.upper())
        return self.ours(
            pin.computeFrameJacobian(self.model, self.data, *self.theirs(q), self.model.getFrameId(frame), way)
        )

    def kinetic_energy(self, q: Array, v: Array) -> float:
        return pin.computeKineticEnergy(self.model, self.data, *self.theirs(q, v))

    def potential_energy(self, q: Array) -> float:
        return pin.computePotentialEnergy(self.model, self.data, *self.theirs(q))

    def momentum(self, q: Array, v: Array) -> Array:
        """About the world's origin."""
        pin.computeCentroidalMomentum(self.model, self.data, *self.theirs(q, v))
        linear = self.data.hg.linear
        return np.concatenate([linear, self.data.hg.angular + np.cross(self.data.com[0], linear)])

    def regressor(self, q: Array, v: Array, a: Array) -> Array:
        """Columns body by body, each with our order of the ten parameters."""
        theirs = pin.computeJointTorqueRegressor(self.model, self.data, *self.theirs(q, v, a))
        order = [0, 1, 2, 3, 4, 5, 7, 6, 8, 9]  # they list xx xy yy xz yz zz
        columns = []
        for body in self.robot.mechanism.bodies:
            first = 10 * (self.model.getJointId(body.joint.name) - 1)
            columns += [first + k for k in order]
        return self.ours(theirs.T).T[:, columns]

    def external(self, wrenches: dict[str, Array]) -> Any:
        """Wrenches on frames, in their axes, as Pinocchio wants them: on joints."""
        forces = pin.StdVec_Force()
        forces.extend([pin.Force.Zero() for _ in range(self.model.njoints)])
        for name, wrench in wrenches.items():
            frame = self.model.frames[self.model.getFrameId(name)]
            forces[frame.parentJoint] += frame.placement.act(pin.Force(np.array(wrench)))
        return forces

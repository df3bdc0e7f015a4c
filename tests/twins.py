"""The same robot in Pinocchio, with joints matched by name."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from cutpoint import Robot
from cutpoint.model import Mechanism

Array = NDArray[np.float64]


def pinocchio_of(mechanism: Mechanism) -> pin.Model:
    """A Pinocchio model built by hand, joint by joint; both number joints depth first.

    Its planar joints move in the x-y plane: their frames, and what hangs on them, are turned so that z is the normal.
    """
    model = pin.Model()
    model.gravity.linear = np.asarray(mechanism.gravity)
    turns = [pin.SE3.Identity()]  # of the world, and of each body
    for body in mechanism.bodies:
        placement = turns[body.parent + 1].inverse() * se3(body.placement) * _turn_of(body.joint)
        turns.append(_turn_of(body.joint))
        index = model.addJoint(body.parent + 1, _joint_model(body.joint), placement, body.joint.name)
        model.appendBodyToJoint(index, pin.Inertia(body.mass, body.com, body.inertia), turns[-1].inverse())
    for frame in mechanism.frames.values():
        placement = turns[frame.body + 1].inverse() * se3(frame.placement)
        model.addFrame(pin.Frame(frame.name, frame.body + 1, 0, placement, pin.FrameType.OP_FRAME))
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
    match joint.kind:
        case "floating":
            return pin.JointModelFreeFlyer()
        case "spherical":
            return pin.JointModelSpherical()
        case "planar":
            return pin.JointModelPlanar()
        case "helical":
            return pin.JointModelHelicalUnaligned(np.array(joint.axis), joint.pitch)
        case "prismatic":
            return pin.JointModelPrismaticUnaligned(np.array(joint.axis))
    return pin.JointModelRevoluteUnaligned(np.array(joint.axis))


def _turn_of(joint: Any) -> pin.SE3:
    """Of a planar joint: z along its normal, x along the next of x, y, z after the normal's largest, in the plane."""
    if joint.kind != "planar":
        return pin.SE3.Identity()
    z = np.array(joint.axis)
    x = np.eye(3)[(np.argmax(np.abs(z)) + 1) % 3]
    x = x - z * (z @ x)
    x /= np.linalg.norm(x)
    return pin.SE3(np.column_stack([x, np.cross(z, x), z]), np.zeros(3))


@dataclass(frozen=True)
class Twin:
    """Pinocchio's side of a robot, in the robot's own order of coordinates; one state at a time."""

    robot: Robot
    model: pin.Model

    @cached_property
    def data(self) -> pin.Data:
        return self.model.createData()

    @cached_property
    def _joints(self) -> list[Any]:
        """Their joint of each of our bodies."""
        return [self.model.joints[self.model.getJointId(b.joint.name)] for b in self.robot.mechanism.bodies]

    @cached_property
    def _columns(self) -> list[int]:
        """For each of our speeds, where it stands in theirs."""
        return [k for joint in self._joints for k in range(joint.idx_v, joint.idx_v + joint.nv)]

    def coordinates(self, q: Array) -> Array:
        """A configuration as they have it: a planar joint's angle as its cosine and sine."""
        found, first = np.zeros(self.model.nq), 0
        for joint, body in zip(self._joints, self.robot.mechanism.bodies, strict=True):
            if body.joint.kind == "planar":
                x, y, angle = q[first : first + 3]
                own, first = [x, y, np.cos(angle), np.sin(angle)], first + 3
            else:
                own, first = q[first : first + joint.nq], first + joint.nq
            found[joint.idx_q : joint.idx_q + joint.nq] = own
        return found

    def theirs(self, q: Array, *ours: Array) -> list[Array]:
        """Coordinates, then speeds, accelerations, torques: in Pinocchio's order."""
        found = [self.coordinates(q)]
        for x in ours:
            found.append(np.zeros(len(self._columns)))
            found[-1][self._columns] = x
        return found

    def ours(self, tau: Any) -> Array:
        """A vector of speeds, or what has such an axis last, in our order."""
        return np.asarray(tau)[..., self._columns]

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

    def frame_acceleration(self, q: Array, v: Array, a: Array, frame: str, expressed_in: str) -> Array:
        way, known = getattr(pin.ReferenceFrame, expressed_in.upper()), self.model.getFrameId(frame)
        pin.forwardKinematics(self.model, self.data, *self.theirs(q, v, a))
        # along the world's axes the derivative of the velocity of the frame's origin is what they call classical
        is_classical = expressed_in == "local_world_aligned"
        found = pin.getFrameClassicalAcceleration if is_classical else pin.getFrameAcceleration
        return found(self.model, self.data, known, way).vector

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

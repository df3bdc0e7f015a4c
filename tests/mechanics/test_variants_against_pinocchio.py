"""Robots made from robots, and coordinates that follow others, against what Pinocchio makes of the same change."""

from collections.abc import Iterator

import numpy as np
import pinocchio as pin
import pytest

from cutpoint import Drive, Rotor
from cutpoint.model import Mechanism
from random_trees import placement, random_tree
from robot_library import Array, Robot, assert_close, coupled_panda, load, robot, states, urdf
from twins import Twin, pinocchio_from, pinocchio_of, se3


def assert_same_dynamics(ours: Robot, model: pin.Model) -> None:
    twin = Twin(ours, model)
    for state in zip(*states(ours), strict=True):
        assert_close(ours.inverse_dynamics(*state), twin.inverse_dynamics(*state))
        assert_close(ours.forward_dynamics(*state), twin.forward_dynamics(*state))


@pytest.mark.parametrize(("name", "frame"), [("ur10", "tool0"), ("panda", "panda_hand"), ("floating", "base")])
def test_payload_is_a_body_fixed_to_a_frame(name, frame):
    ours, com, tensor = robot(name), np.array([0.1, -0.05, 0.2]), np.diag([0.02, 0.03, 0.04])
    model = pinocchio_of(ours.mechanism)
    held = model.frames[model.getFrameId(frame)]
    model.appendBodyToJoint(held.parentJoint, pin.Inertia(2.5, com, tensor), held.placement)
    assert_same_dynamics(ours.with_payload(2.5, com, tensor, frame), model)


def test_locked_joints_are_rigid():
    lock = {"elbow_joint": 0.7, "wrist_2_joint": -1.1}
    whole = pinocchio_from(urdf("ur10_robot.urdf"))
    q = pin.neutral(whole)
    for name, value in lock.items():
        q[whole.joints[whole.getJointId(name)].idx_q] = value
    model = pin.buildReducedModel(whole, [whole.getJointId(name) for name in lock], q)
    assert_same_dynamics(load("ur10_robot.urdf", lock=lock), model)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (1.0, -2.0, 3.0), (0.0, 0.0, -1.62)])
def test_gravity_may_be_any(gravity):
    ours = robot("ur10").with_gravity(gravity)
    model = pinocchio_from(urdf("ur10_robot.urdf"))
    model.gravity.linear = np.array(gravity)
    assert_same_dynamics(ours, model)


def test_base_may_be_mounted_anywhere():
    mounting = placement(np.random.default_rng(4))
    model = pinocchio_from(urdf("ur10_robot.urdf"))
    model.jointPlacements[1] = se3(mounting) * model.jointPlacements[1]
    ours = robot("ur10").with_base(mounting)
    assert_same_dynamics(ours, model)
    for q in states(ours).q:
        assert_close(ours.frame_pose(q, "tool0"), Twin(ours, model).frame_pose(q, "tool0"), 1e-13)
    assert_close(ours.frame_pose(q, "base_link"), mounting, 1e-15)


def test_rotors_of_rigid_drives_are_armature():
    bare = robot("tree", "numpy")
    ours = bare.with_drives({name: Drive(ratio=-80.0 - k, rotor=Rotor(2e-5)) for k, name in enumerate(bare.joints)})
    twin = Twin(ours, pinocchio_of(ours.mechanism))
    armature = np.array([drive.reflected_inertia for drive in ours.drives.values()])
    twin.model.armature = armature
    assert_same_dynamics(ours, twin.model)
    for q, v, _ in zip(*states(ours), strict=True):
        M = ours.mass_matrix(q)
        assert_close(M - bare.mass_matrix(q), np.diag(armature))
        assert_close(ours.kinetic_energy(q, v), v @ M @ v / 2)


COUPLED = {
    "panda": coupled_panda,
    "tree": lambda: Robot(random_tree(7, 6, mimic=True)),
    "floating tree": lambda: Robot(random_tree(8, 5, mimic=True, floating=True)),
}


@pytest.mark.parametrize("name", COUPLED)
def test_followers_act_on_their_leaders(name):
    """q_full = G q + o: torques are G^T tau, inertia is G^T M G."""
    ours = COUPLED[name]()
    twin = Twin(ours, pinocchio_of(ours.mechanism))
    G = speed_map(ours.mechanism)
    assert G.shape == (twin.model.nv, ours.nv)
    for q, v, a in zip(*states(ours), strict=True):
        q_full = np.concatenate([*full_coordinates(ours.mechanism, q)])
        M = G.T @ twin.mass_matrix(q_full) @ G
        assert_close(ours.mass_matrix(q), M)
        assert_close(ours.inverse_dynamics(q, v, a), G.T @ twin.inverse_dynamics(q_full, G @ v, G @ a))
        assert_close(ours.forward_dynamics(q, v, a), np.linalg.solve(M, a - G.T @ twin.bias_forces(q_full, G @ v)))
        assert_close(ours.kinetic_energy(q, v), v @ M @ v / 2)
        for frame in [*ours.frames][-2:]:
            assert_close(ours.jacobian(q, frame), twin.jacobian(q_full, frame, "local") @ G)


def speed_map(mechanism: Mechanism) -> Array:
    """G, from free speeds to all: a follower's row is its leader's, times the multiplier."""
    rows: dict[str, Array] = {}
    width = sum(_size(body.joint.kind) for body in mechanism.bodies if not body.joint.mimic)
    free = iter(np.eye(width))
    for body in mechanism.bodies:
        mimic = body.joint.mimic
        own = (
            [next(free) for _ in range(_size(body.joint.kind))]
            if not mimic
            else [mimic.multiplier * rows[mimic.joint][0]]
        )
        rows[body.joint.name] = np.array(own)
    return np.concatenate([*rows.values()])


def full_coordinates(mechanism: Mechanism, q: Array) -> Iterator[Array]:
    """Coordinates of all joints, in the mechanism's order."""
    known: dict[str, Array] = {}
    start = 0
    for body in mechanism.bodies:
        mimic = body.joint.mimic
        if mimic:
            known[body.joint.name] = mimic.multiplier * known[mimic.joint] + mimic.offset
        else:
            stop = start + (7 if body.joint.kind == "floating" else 1)
            known[body.joint.name], start = q[start:stop], stop
        yield known[body.joint.name]


def _size(kind: str) -> int:
    return 6 if kind == "floating" else 1

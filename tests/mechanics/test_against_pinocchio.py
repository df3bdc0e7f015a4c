"""Every algorithm of the rigid robot against Pinocchio: arms, a hand, a floating humanoid, trees of all joint kinds."""

import numpy as np
import pytest

from random_trees import random_tree
from robot_library import BACKENDS, Robot, assert_close, robot, states, urdf
from twins import Twin, pinocchio_from, pinocchio_of

FILES = {"ur10": ("ur10_robot.urdf", False), "panda": ("panda.urdf", False), "talos": ("talos_reduced.urdf", True)}
TREES = ("tree", "floating", "xia2019")
CASES = [("ur10", "llvm"), ("ur10", "numpy"), ("panda", "llvm"), ("talos", "llvm")]
CASES += [(name, backend) for name in TREES for backend in BACKENDS]

both = pytest.mark.parametrize(("name", "backend"), CASES)


def twin_of(name: str, backend: str = "llvm") -> Twin:
    """Pinocchio reads files by itself; trees are rebuilt for it joint by joint."""
    ours = robot(name, backend)
    return Twin(
        ours, pinocchio_from(urdf(FILES[name][0]), FILES[name][1]) if name in FILES else pinocchio_of(ours.mechanism)
    )


@both
def test_inverse_dynamics(name, backend):
    twin = twin_of(name, backend)
    s = states(twin.robot)
    for ours, state in zip(twin.robot.inverse_dynamics(*s), zip(*s, strict=True), strict=True):
        assert_close(ours, twin.inverse_dynamics(*state))


@both
def test_forward_dynamics(name, backend):
    twin = twin_of(name, backend)
    s = states(twin.robot)
    for ours, state in zip(twin.robot.forward_dynamics(*s), zip(*s, strict=True), strict=True):
        assert_close(ours, twin.forward_dynamics(*state))


@both
def test_mass_matrix(name, backend):
    twin = twin_of(name, backend)
    q = states(twin.robot).q
    for ours, q_i in zip(twin.robot.mass_matrix(q), q, strict=True):
        assert_close(ours, twin.mass_matrix(q_i))


@both
def test_bias_and_gravity_forces(name, backend):
    twin = twin_of(name, backend)
    q, v, _ = states(twin.robot)
    for q_i, v_i in zip(q, v, strict=True):
        assert_close(twin.robot.bias_forces(q_i, v_i), twin.bias_forces(q_i, v_i))
        assert_close(twin.robot.gravity_forces(q_i), twin.gravity_forces(q_i))


@both
def test_energies_and_momentum(name, backend):
    twin = twin_of(name, backend)
    q, v, _ = states(twin.robot)
    # a sum over bodies of both signs may cancel: measured by the weight of all at arm's length
    weight = sum(body.mass for body in twin.robot.mechanism.bodies) * 10.0
    for q_i, v_i in zip(q, v, strict=True):
        assert_close(twin.robot.kinetic_energy(q_i, v_i), twin.kinetic_energy(q_i, v_i))
        assert_close(twin.robot.potential_energy(q_i), twin.potential_energy(q_i), 1e-12, scale=weight)
        assert_close(twin.robot.momentum(q_i, v_i), twin.momentum(q_i, v_i))


@pytest.mark.parametrize("name", [*FILES, *TREES])
def test_every_frame_is_where_pinocchio_has_it(name):
    twin = twin_of(name)
    known = {frame.name for frame in twin.model.frames}
    frames = [frame for frame in twin.robot.frames if frame in known][:: 8 if name == "talos" else 1]
    for frame in frames:
        for q_i in states(twin.robot).q:
            assert_close(twin.robot.frame_pose(q_i, frame), twin.frame_pose(q_i, frame), 1e-13)


FRAMES = [
    ("ur10", "tool0"), ("panda", "panda_leftfinger"), ("panda", "panda_hand_tcp"), ("talos", "arm_left_7_link"),
    ("talos", "left_sole_link"), ("tree", "link6"), ("floating", "link4"), ("xia2019", "tool"), ("xia2019", "base"),
]  # fmt: skip


@pytest.mark.parametrize("expressed_in", ["local", "world", "local_world_aligned"])
@pytest.mark.parametrize(("name", "frame"), FRAMES)
def test_jacobians_in_all_three_expressions(name, frame, expressed_in):
    twin = twin_of(name)
    for q_i in states(twin.robot).q:
        assert_close(twin.robot.jacobian(q_i, frame, expressed_in), twin.jacobian(q_i, frame, expressed_in), 1e-12)


@pytest.mark.parametrize("expressed_in", ["local", "world", "local_world_aligned"])
@pytest.mark.parametrize(("name", "frame"), FRAMES)
def test_accelerations_in_all_three_expressions(name, frame, expressed_in):
    twin = twin_of(name)
    for state in zip(*states(twin.robot), strict=True):
        found, known = (x.frame_acceleration(*state, frame, expressed_in) for x in (twin.robot, twin))
        assert_close(found, known, 1e-12)


@pytest.mark.parametrize("name", ["ur10", "panda", "tree", "floating"])
def test_regressor(name):
    twin = twin_of(name)
    for state in zip(*states(twin.robot), strict=True):
        assert_close(twin.robot.regressor(*state), twin.regressor(*state))


@pytest.mark.parametrize(
    ("name", "frames"), [("ur10", ("tool0", "forearm_link")), ("floating", ("link4", "base")), ("tree", ("link2",))]
)
def test_wrenches_act_on_the_robot_as_pinocchios_external_forces(name, frames):
    twin = twin_of(name)
    wrenches = dict(zip(frames, np.random.default_rng(5).normal(0, 20, (len(frames), 6)), strict=True))
    forces = twin.external(wrenches)
    for q, v, a in zip(*states(twin.robot), strict=True):
        assert_close(twin.robot.inverse_dynamics(q, v, a, wrenches), twin.inverse_dynamics(q, v, a, forces))
        assert_close(twin.robot.forward_dynamics(q, v, a, wrenches), twin.forward_dynamics(q, v, a, forces))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("floating", [False, True])
def test_trees_of_any_joints(seed, floating):
    ours = Robot(random_tree(10 + seed, 3 + seed, floating=floating), backend="numpy")
    twin = Twin(ours, pinocchio_of(ours.mechanism))
    s = states(ours)
    tau, a, M = ours.inverse_dynamics(*s), ours.forward_dynamics(*s), ours.mass_matrix(s.q)
    for k, state in enumerate(zip(*s, strict=True)):
        assert_close(tau[k], twin.inverse_dynamics(*state))
        assert_close(a[k], twin.forward_dynamics(*state))
        assert_close(M[k], twin.mass_matrix(state[0]))


@pytest.mark.parametrize("backend", BACKENDS)
def test_batches_are_the_single_results_in_any_shape(backend):
    ours = robot("panda", backend)
    q, v, a = (np.stack([x, x[::-1]])[:, :, None] for x in states(ours))
    tau = ours.inverse_dynamics(q, v[:1], a[0, 0])
    assert tau.shape == (2, 7, 1, ours.nv)
    assert np.array_equal(tau[1, 3, 0], ours.inverse_dynamics(q[1, 3, 0], v[0, 3, 0], a[0, 0, 0]))

"""Derivatives of large robots, as loops or swept instead of compiled: the same as compiled ones, and as Pinocchio's."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
import pytest
from test_large_trees import model_of

from cutpoint import Drive, Flexspline, LinearSpring, Robot, Rotor, Stribeck, derivatives
from cutpoint.derivatives import definitions, sweeps
from cutpoint.derivatives.functions import elastic_loops
from cutpoint.derivatives.large import inverse_of
from cutpoint.errors import InputError
from cutpoint.export import export_function
from cutpoint.functions.compiled import machine_of
from cutpoint.kernels.programs.compiled import program_ir
from cutpoint.kernels.programs.plan import plan
from cutpoint.mechanics.elastic_inverse import Options
from cutpoint.model import Mechanism
from cutpoint.rolled import DERIVATIVES, RECIPES, RolledFunction
from cutpoint.rolled.bodies import columns_of
from cutpoint.rolled.passes import one_by_one
from large_robots import assert_close, based, chain
from random_trees import random_tree, tree_of_every_kind
from twins import pinocchio_of

EPS = np.finfo(float).eps
SMALL = {"chain": chain(5), "floating": based("floating", 4), **{f"tree {k}": tree_of_every_kind(k) for k in (3, 5)}}


def sprung(mechanism: Mechanism, coupling: Any = "reduced") -> Robot:
    drive = Drive(100.0, Rotor(1e-4, coupling=coupling), LinearSpring(2e4), damping=2.0)
    return Robot(mechanism, dict.fromkeys(Robot(mechanism).joints, drive), backend="numpy")


def states(robot: Robot, *shape: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    q, theta = robot.random(rng, shape), rng.normal(size=(*shape, len(robot.drives)))
    driven = q[..., [d.q for d in robot.machine.drives]]
    motors = {"theta": driven + 1e-3 * theta, "theta_dot": theta, "motor_torque": 10 * theta}
    return {"q": q, "v": rng.normal(size=(*shape, robot.nv)), "a": rng.normal(size=(*shape, robot.nv)), **motors}


@pytest.mark.parametrize("coupling", ["reduced", "full"])
@pytest.mark.parametrize("name", SMALL)
def test_swept_derivatives_are_the_compiled_ones(name: str, coupling: str) -> None:
    robot = sprung(SMALL[name], coupling)
    s = states(robot, 2)
    q, v, a = s.pop("q"), s.pop("v"), s.pop("a")
    compiled = (
        derivatives.inverse_dynamics(robot, q, v, a),
        derivatives.elastic_forward_dynamics(robot, q, v, **s),
    )
    swept = (
        sweeps.inverse_dynamics(robot, q=q, v=v, a=a),
        sweeps.elastic_forward_dynamics(robot, q=q, v=v, **s),
    )
    for theirs, ours in zip(compiled, swept, strict=True):
        for x, y in zip(ours, theirs, strict=True):
            assert x.shape == y.shape
            np.testing.assert_allclose(x, y, rtol=0, atol=1e-12 * np.abs(y).max(initial=1.0))


def test_swept_derivatives_have_no_kernel_to_export(tmp_path: Path) -> None:
    robot = Robot(chain(25, ("revolute", "spherical")))
    for name in ("inverse_dynamics", "forward_dynamics", "elastic_forward_dynamics"):
        with pytest.raises(InputError, match=rf"{name}_derivatives: with 25 bodies .* has no kernel .* or to export"):
            export_function(robot, f"{name}_derivatives", tmp_path)


LOOPED = {
    "one body": chain(1),
    "every kind": chain(9, ("helical", "revolute", "prismatic")),
    "tree": random_tree(1, 16),
    "floating": based("floating", 14),
    "planar": based("planar", 16),
    "spherical": based("spherical", 5, branching=False),
}


@pytest.mark.parametrize(("tree", "backend"), [(tree, "llvm") for tree in LOOPED] + [("floating", "numpy")])
def test_loops_find_what_sweeps_find(tree: str, backend: str) -> None:
    joints = Robot(LOOPED[tree]).joints
    robot = Robot(LOOPED[tree], dict.fromkeys(joints, Drive(50.0, Rotor(1e-3))), backend="numpy")  # it never loops
    s = states(robot, 3)
    given = s["q"], s["v"], s["a"]
    function = RolledFunction(DERIVATIVES, robot.machine, backend, derivatives.InverseDynamicsDerivatives)
    found = function(*given)
    for ours, theirs in zip(found, sweeps.inverse_dynamics(robot, **dict(zip("qva", given, strict=True))), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13 * np.abs(theirs).max(initial=1.0))
    for one, of_batch in zip(function(*(x[2] for x in given)), found, strict=True):
        np.testing.assert_array_equal(one, of_batch[2])


def driven_by_turns(mechanism: Mechanism) -> dict[str, Drive]:
    """Elastic drives with friction, rigid ones and no drive, joint after joint."""
    friction = Stribeck(0.3, 0.6, 0.2, 0.1, 0.02)
    spring = Flexspline(2e4, 0.04)
    elastic = Drive(100.0, Rotor(1e-4), spring, damping=2.0, link_friction=friction, motor_friction=friction)
    rigid = Drive(50.0, Rotor(1e-3), motor_friction=friction)
    choices = (elastic, rigid, None, elastic)
    chosen = ((name, choices[k % 4]) for k, name in enumerate(Robot(mechanism).joints))
    return {name: drive for name, drive in chosen if drive}


@pytest.mark.parametrize("mechanism", [chain(30), based("floating", 28)], ids=["chain", "floating"])
def test_elastic_derivatives_that_follow_from_loops_are_the_swept_ones(mechanism: Mechanism) -> None:
    robot = Robot(mechanism, driven_by_turns(mechanism))
    s = states(robot, 2)
    del s["a"]
    assert elastic_loops(robot)
    found = derivatives.elastic_forward_dynamics(robot, **s)
    for ours, theirs in zip(found, sweeps.elastic_forward_dynamics(robot, **s), strict=True):
        assert ours.shape == theirs.shape
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * np.abs(theirs).max(initial=1.0))
    for one, of_batch in zip(
        derivatives.elastic_forward_dynamics(robot, **{k: x[1] for k, x in s.items()}), found, strict=True
    ):
        np.testing.assert_array_equal(one, of_batch[1])


@pytest.mark.parametrize("options", [Options(), Options(friction_rates=True)], ids=str)
@pytest.mark.parametrize("tree", ["one body", "every kind", "tree"])
def test_loops_find_elastic_inverse_dynamics_derivatives_as_straight_code_does(tree: str, options: Options) -> None:
    mechanism = random_tree(1, 8) if tree == "tree" else LOOPED[tree]
    robot = Robot(mechanism, driven_by_turns(mechanism), backend="numpy")
    key = ("elastic_inverse_dynamics_derivatives", options)
    function = RolledFunction(key, robot.machine, "llvm", definitions.MotorTorqueDerivatives)
    # so fast that friction, smoothed within 0.02 rad/s, has derivatives of the size of the others
    motion = np.random.default_rng(3).choice([-1, 1], (5, 3, robot.nv)) * np.linspace(1, 1.5, robot.nv)
    found = function(*motion)
    straight = derivatives.elastic_inverse_dynamics(robot, *motion, friction_rates=options.friction_rates)
    for ours, theirs in zip(found, straight[:5], strict=True):
        assert_close(ours, theirs, 1e-12)
    for one, of_batch in zip(function(*(x[2] for x in motion)), found, strict=True):
        np.testing.assert_array_equal(one, of_batch[2])


def test_elastic_inverse_dynamics_derivatives_of_a_large_robot_are_its_differences() -> None:
    mechanism = chain(60)
    robot = Robot(mechanism, driven_by_turns(mechanism))
    motion = np.random.default_rng(4).choice([-1, 1], (5, robot.nv)) * np.linspace(1, 1.5, robot.nv)
    found = derivatives.elastic_inverse_dynamics(robot, *motion)
    for k, ours in enumerate(found[:5]):
        steps = 1e-4 * np.eye(robot.nv)
        ends = ([*motion[:k], motion[k] + sign * steps, *motion[k + 1 :]] for sign in (1, -1))
        after, before = (robot.elastic_inverse_dynamics(*end).motor_torque for end in ends)
        assert_close(ours, (after - before).T / 2e-4, 1e-6)


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("mechanism", [chain(26), based("floating", 26)], ids=["chain", "floating"])
def test_large_robots_are_linearised_as_well_from_loops_as_by_sweeps(mechanism: Mechanism, friction: bool) -> None:
    looped, swept = (Robot(mechanism, driven_by_turns(mechanism), backend=x) for x in ("llvm", "numpy"))
    assert elastic_loops(looped) and not elastic_loops(swept)
    q, v = looped.random(1), np.zeros(looped.nv)
    v[-26:] = np.linspace(-0.1, 0.1, 26)
    torque = np.ones(len(looped.drives))
    ours, theirs = (robot.linearize(q, v, torque, friction=friction) for robot in (looped, swept))
    assert ours.states == theirs.states
    for x, y in ((ours.A, theirs.A), (ours.B, theirs.B), (ours.drift, theirs.drift)):
        np.testing.assert_allclose(x, y, rtol=0, atol=1e-11 * np.abs(y).max())


def test_modes_of_a_large_robot_that_falls_are_the_same_from_loops_as_by_sweeps() -> None:
    mechanism = based("floating", 26)
    drives = dict.fromkeys(Robot(mechanism).joints, Drive(100.0, Rotor(1e-3), LinearSpring(2e4), damping=2.0))
    looped, swept = (Robot(mechanism, drives, backend=x).modes(Robot(mechanism).random(1)) for x in ("llvm", "numpy"))
    np.testing.assert_allclose(looped.frequencies, swept.frequencies, rtol=1e-9)
    np.testing.assert_allclose(looped.damping, swept.damping, rtol=1e-7)


def assert_pinocchios(ours: Any, model: Any, data: Any, *state: np.ndarray) -> None:
    pinocchio.computeRNEADerivatives(model, data, *state)
    assert_close(ours.d_q, data.dtau_dq)
    assert_close(ours.d_v, data.dtau_dv)


def test_derivatives_of_a_large_floating_robot_are_pinocchios() -> None:
    robot = Robot(based("floating", 30))
    model = pinocchio_of(robot.mechanism)
    data, s = model.createData(), states(robot)
    q, v, a = s["q"], s["v"], s["a"]
    ours = derivatives.inverse_dynamics(robot, q, v, a)
    assert_pinocchios(ours, model, data, q, v, a)
    derivatives.forward_dynamics(robot, q, v, a)
    for name in ("inverse_dynamics_derivatives", "forward_dynamics_derivatives"):
        with pytest.raises(InputError, match=rf"{name}: with 31 bodies it runs as loops over them .*: lock joints"):
            robot.kernel(name)
    zero = np.where(np.arange(robot.nq) < 7, 0.0, q)
    with pytest.raises(InputError, match="inverse_dynamics_derivatives: the quaternion of joint 'base' is zero"):
        derivatives.inverse_dynamics(robot, zero, v, a)


def test_a_mass_matrix_without_an_inverse_is_refused() -> None:
    """Robots have none: where joints move no inertia they are refused before."""
    with pytest.raises(InputError, match=r"forward_dynamics_derivatives: the first 2 rows of the mass matrix"):
        inverse_of(np.array([np.eye(3), np.ones((3, 3))]), "forward_dynamics_derivatives")


def test_motions_too_fast_for_their_accelerations_to_be_taken_are_refused() -> None:
    robot = Robot(chain(30))
    s = states(robot)
    with pytest.raises(InputError, match=r"forward_dynamics_derivatives: .* accelerations up to .*, more than 1e\+15"):
        derivatives.forward_dynamics(robot, s["q"], 1e8 * s["v"], s["a"])


def test_rotors_that_loops_do_not_take_are_swept() -> None:
    mechanism = chain(25)
    drives = dict.fromkeys(Robot(mechanism).joints, Drive(50.0, Rotor(1e-3, coupling="full")))
    robot = Robot(mechanism, drives)
    s = states(robot)
    given = {"q": s["q"], "v": s["v"], "a": s["a"]}
    for x, y in zip(derivatives.inverse_dynamics(robot, **given), sweeps.inverse_dynamics(robot, **given), strict=True):
        np.testing.assert_array_equal(x, y)


def test_few_joints_of_many_axes_are_swept() -> None:
    robot = Robot(chain(20, ("spherical", "revolute")))
    s, h = states(robot), 1e-6
    q, v, tau, along = s["q"], s["v"], s["a"], np.random.default_rng(2).normal(size=robot.nv)
    found = derivatives.forward_dynamics(robot, q, v, tau)
    accelerations = (robot.forward_dynamics(robot.integrate(q, along, x), v, tau) for x in (h, -h))
    difference = np.subtract(*accelerations) / (2 * h)
    assert robot.nv > sweeps.MOST_STRAIGHT_SPEEDS
    np.testing.assert_allclose(found.d_q @ along, difference, rtol=0, atol=1e-6 * np.abs(difference).max())
    np.testing.assert_allclose(found.d_tau @ robot.mass_matrix(q), np.eye(robot.nv), rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", ["floating", "revolute"])
def test_code_of_derivatives_is_as_long_for_ten_bodies_as_for_a_thousand(kind: str) -> None:
    texts = []
    for size in (10, 1000):
        columns = columns_of(machine_of(based(kind, size, branching=False), {}).system)
        built = one_by_one(RECIPES[DERIVATIVES].steps(columns), columns, 8)
        texts.append(program_ir(plan(built.body, built.regions)))
    assert texts[0] == texts[1]


def test_derivatives_of_a_chain_of_96_are_pinocchios() -> None:
    robot = Robot(chain(96))
    model = model_of(robot.mechanism)
    data, s = model.createData(), states(robot)
    q, v, a = s["q"], s["v"], s["a"]
    ours = derivatives.inverse_dynamics(robot, q, v, a)
    assert_pinocchios(ours, model, data, q, v, a)
    assert_close(ours.d_a, robot.mass_matrix(q))
    tau = robot.inverse_dynamics(q, v, a)
    pinocchio.computeABADerivatives(model, data, q, v, tau)
    upper = np.triu(data.Minv)
    accuracy = 100 * EPS * np.linalg.cond(robot.mass_matrix(q))
    for x, y in zip(
        derivatives.forward_dynamics(robot, q, v, tau),
        (data.ddq_dq, data.ddq_dv, upper + np.triu(upper, 1).T),
        strict=True,
    ):
        assert_close(x, y, rtol=accuracy)


def test_a_long_elastic_chain_has_a_mode_for_every_drive_and_balances() -> None:
    robot = sprung(chain(30))
    q = robot.random(2)
    modes = robot.modes(q)
    assert len(modes.frequencies) == 30
    assert np.abs(modes.model.drift).max() < 1e-9 * np.abs(robot.gravity_forces(q)).max()


@pytest.mark.parametrize("key", ["mass_matrix", "regressor", "coriolis_matrix", DERIVATIVES], ids=str)
@pytest.mark.parametrize("tree", ["every kind", "tree", "floating"])
def test_matrices_of_a_batch_have_the_bits_of_single_calls(tree: str, key: Any) -> None:
    drive = Drive(100.0, Rotor(1e-4))  # rigid: what links feel of rotors is in the mass matrix
    bare = Robot(LOOPED[tree])
    robot = bare.with_drives(dict.fromkeys(bare.joints[-5:], drive))
    function, s = RolledFunction(key, robot.machine, "llvm"), states(robot, 19)
    given = [s["q"], s["v"], s["a"]][: {"mass_matrix": 1, "coriolis_matrix": 2}.get(key, 3)]
    whole = function.computed(given)
    for k in range(19):
        for x, one in zip(whole, function.computed([x[k] for x in given]), strict=True):
            np.testing.assert_array_equal(x[k], one)


BROADCAST = [((), (3,), ()), ((3,), (), ()), ((1,), (3,), (1,)), ((2, 1), (3,), ()), ((0,), (), ())]


@pytest.mark.parametrize("size", [29, 40])  # by the mass matrix' factors, and through the bodies
def test_derivatives_of_accelerations_broadcast(size: int) -> None:
    made, rng = sprung(chain(size)), np.random.default_rng(2)
    robot = Robot(made.mechanism, made.drives)
    functions = (derivatives.forward_dynamics, (0, 1, 2)), (derivatives.elastic_forward_dynamics, (0, 1, 3, 1, 2))
    for axes, (function, given) in itertools.product(BROADCAST, functions):
        q, v, tau = (rng.normal(size=(*x, size)) for x in axes)
        theta, shape = q + 1e-3, np.broadcast_shapes(*axes)
        whole = np.broadcast_arrays(q, v, tau, theta)
        found = function(robot, *[(q, v, tau, theta)[k] for k in given])
        for x in found:
            assert x.shape == (*shape, size, size)
        for at in np.ndindex(shape):
            for x, one in zip(found, function(robot, *[whole[k][at] for k in given]), strict=True):
                np.testing.assert_array_equal(x[at], one)


def test_a_batch_of_a_large_robot_is_its_configurations_one_by_one() -> None:
    robot = Robot(chain(25))
    s = states(robot, 2)
    whole = derivatives.inverse_dynamics(robot, s["q"], s["v"], s["a"][0])
    one = derivatives.inverse_dynamics(robot, s["q"][1], s["v"][1], s["a"][0])
    np.testing.assert_array_equal(whole.d_q[1], one.d_q)
    assert derivatives.inverse_dynamics(robot, s["q"][:0], s["v"][:0], s["a"][0]).d_v.shape == (0, 25, 25)
    with pytest.raises(InputError, match=r"leading axes do not broadcast: q \(2,\), v \(3,\)"):
        derivatives.inverse_dynamics(robot, s["q"], np.zeros((3, 25)), s["a"])


@pytest.mark.parametrize("name", ["inverse_dynamics", "forward_dynamics", "elastic_inverse_dynamics"])
def test_what_is_too_large_to_sweep_is_refused_with_a_remedy(name: str) -> None:
    robot = Robot(chain(501), backend="numpy")
    zeros = [np.zeros(501)] * (5 if name.startswith("elastic") else 3)
    with pytest.raises(InputError, match=r"501 bodies are too many, at most (500|48); use finite differences"):
        getattr(derivatives, name)(robot, *zeros)


@pytest.mark.parametrize("tree", [tree for tree in LOOPED if tree != "one body"])  # of which it is zero
def test_loops_find_the_coriolis_matrix_of_virtual_decomposition(tree: str) -> None:
    robot = Robot(LOOPED[tree], backend="numpy")
    q, v = robot.random(5, 3), np.random.default_rng(5).normal(size=(3, robot.nv))
    found = RolledFunction("coriolis_matrix", robot.machine, "llvm")(q, v)
    assert_close(found, robot.coriolis_matrix(q, v), 1e-13)


@pytest.mark.parametrize("mechanism", [chain(400), based("floating", 100)], ids=["chain", "floating"])
def test_coriolis_matrices_of_large_robots_take_the_bias_from_gravity(mechanism: Mechanism) -> None:
    robot = Robot(mechanism)
    q, v = robot.random(6), np.random.default_rng(6).normal(size=robot.nv)
    assert_close(robot.coriolis_matrix(q, v) @ v, robot.bias_forces(q, v) - robot.gravity_forces(q), 1e-11)


@pytest.mark.parametrize("name", ["regressor", "velocity_map"])
def test_matrices_that_cannot_be_compiled_are_refused_before_they_are_traced(name: str) -> None:
    """With a joint that loops do not support."""
    robot, inputs = Robot(chain(400, ("revolute",) * 399 + ("planar",))), {"regressor": 3, "velocity_map": 1}
    with pytest.raises(InputError, match=rf"{name}: with 400 bodies it takes far more than 200000 operations"):
        getattr(robot, name)(*[np.zeros(robot.nv)] * inputs[name])

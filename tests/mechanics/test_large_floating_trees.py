"""Large robots on a base that moves freely run as loops too: its joint has several axes, every other one."""

import time
from typing import Any

import numpy as np
import pinocchio
import pytest

from cutpoint import Robot
from cutpoint.functions.compiled import machine_of
from cutpoint.kernels.programs.compiled import program_ir
from cutpoint.kernels.programs.plan import plan
from cutpoint.mechanics.drives.compliance import LinearSpring
from cutpoint.model import Drive
from cutpoint.model.drive import Rotor
from cutpoint.rolled import RECIPES, RolledFunction
from cutpoint.rolled import rolled as suited_to
from cutpoint.rolled.bodies import columns_of
from cutpoint.rolled.passes import one_by_one, side_by_side
from large_robots import assert_close, based, longest
from twins import pinocchio_of

RIGID = ("inverse_dynamics", "bias_forces", "gravity_forces", "forward_dynamics", "mass_matrix")
ELASTIC = ("elastic_inverse_dynamics", "elastic_forward_dynamics")


def given_to(robot: Robot, name: str, *shape: int) -> list[np.ndarray]:
    """What a function asks for: coordinates, and numbers for each speed or for each drive."""
    rng, drives = np.random.default_rng(1), ("theta", "theta_dot", "motor_torque")
    sizes = {x: len(robot.drives) if x in drives else robot.nv for x in RECIPES[name].inputs if x != "q"}
    rest = {x: rng.uniform(-1.0, 1.0, (*shape, n)) for x, n in sizes.items()}
    q = robot.random(2, shape)
    if "theta" in rest:  # near rest of the springs
        rest["theta"] = q[..., robot.nq - len(robot.drives) :] + 1e-3 * rest["theta"]
    return [q, *rest.values()]


def as_list(found: Any) -> list[np.ndarray]:
    return [*found] if isinstance(found, tuple) else [found]


TREES = {
    "floating": based("floating", 14),
    "planar": based("planar", 14),
    "spherical": based("spherical", 14),
    "one body on a floating base": based("floating", 1, branching=False),
}


@pytest.mark.parametrize(("tree", "backend"), [("floating", "llvm"), *((tree, "numpy") for tree in TREES)])
def test_loops_on_a_base_give_what_straight_line_code_gives(tree: str, backend: str) -> None:
    spring = Drive(100.0, Rotor(1e-4), LinearSpring(2e4))
    full = Drive(80.0, Rotor(2e-4, coupling="full"))
    joints = Robot(TREES[tree]).joints
    for names, drive in ((RIGID, None), (RIGID, full), (ELASTIC, spring)):
        robot = Robot(TREES[tree], dict.fromkeys(joints, drive) if drive else {}, backend="numpy")  # it never loops
        for name in names:
            given = given_to(robot, name, 9)
            for x in given[1:] if name != "elastic_forward_dynamics" else ():
                x[1] = 0.0  # at rest
            expected = getattr(robot, name)(*given)
            record = type(expected) if isinstance(expected, tuple) else None
            function = RolledFunction(name, robot.machine, backend, record)
            found, single = as_list(function(*given)), as_list(function(*(x[8] for x in given)))
            for ours, theirs, one in zip(found, as_list(expected), single, strict=True):
                np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * np.abs(theirs).max())
                np.testing.assert_array_equal(one, ours[8])


@pytest.mark.parametrize("branching", [True, False])
def test_a_floating_robot_of_150_moves_as_pinocchio_says(branching: bool) -> None:
    robot = Robot(based("floating", 150, branching))
    model = pinocchio_of(robot.mechanism)
    data = model.createData()
    q, v, a = given_to(robot, "inverse_dynamics")
    assert_close(robot.inverse_dynamics(q, v, a), pinocchio.rnea(model, data, q, v, a))
    assert_close(robot.forward_dynamics(q, v, a), pinocchio.aba(model, data, q, v, a), 1e-11)
    assert_close(robot.gravity_forces(q), pinocchio.computeGeneralizedGravity(model, data, q))
    assert_close(robot.bias_forces(q, v), pinocchio.nonLinearEffects(model, data, q, v))
    M = np.triu(pinocchio.crba(model, data, q))
    assert_close(robot.mass_matrix(q), M + np.triu(M, 1).T)


@pytest.mark.parametrize("name", RIGID)
def test_large_floating_robots_loop_and_small_ones_do_not(name: str) -> None:
    most = longest(name, first=6)
    assert suited_to(name, Robot(based("floating", most - 1, branching=False)).machine, "llvm") is None
    assert suited_to(name, Robot(based("floating", most, branching=False)).machine, "llvm") is not None


@pytest.mark.parametrize("name", [*RIGID, *ELASTIC])
def test_code_of_a_floating_robot_is_as_long_for_ten_bodies_as_for_a_thousand(name: str) -> None:
    """The same text, so that the second one is found on disk."""
    texts = []
    for size in (10, 1000):
        mechanism = based("floating", size, branching=False)
        springs = {x.joint.name: Drive(100.0, Rotor(1e-4), LinearSpring(2e4)) for x in mechanism.bodies[1:]}
        machine = machine_of(mechanism, springs if name in ELASTIC else {})
        columns = columns_of(machine.system, machine.drives)
        arranged = (one_by_one,) if name == "mass_matrix" else (one_by_one, side_by_side)
        built = [arrange(RECIPES[name].steps(columns), columns, 8) for arrange in arranged]
        texts.append([program_ir(plan(x.body, x.regions)) for x in built])
    assert texts[0] == texts[1]


def test_what_falls_freely_stays_in_shape_with_ten_thousand_joints() -> None:
    """From rest and without torques everything falls as one; in seconds, however long the chain is."""
    robot = Robot(based("floating", 10_000, branching=False))
    q, still = robot.random(1), np.zeros(robot.nv)
    start = time.process_time()
    a = robot.forward_dynamics(q, still, still)
    first_call = time.process_time() - start
    R = robot.machine.system.segments[0].joint.pose(q[:7]).rotation
    base = robot.mechanism.bodies[0].placement[:3, :3] @ np.array([[*row] for row in R], dtype=float)
    expected = np.concatenate([base.T @ robot.gravity, np.zeros(robot.nv - 3)])
    np.testing.assert_allclose(a, expected, rtol=0, atol=1e-7)
    tau = robot.inverse_dynamics(q, still, a)
    assert np.abs(tau).max() < 1e-7
    assert first_call < 15

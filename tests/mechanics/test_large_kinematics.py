"""Frames and energies of large robots are found by loops over bodies: the same results as by straight-line code."""

import time
from typing import Any, get_args

import numpy as np
import pytest

from cutpoint import Robot
from cutpoint.errors import InputError
from cutpoint.functions.compiled import machine_of
from cutpoint.kernels.programs.compiled import program_ir
from cutpoint.kernels.programs.plan import plan
from cutpoint.mechanics.kinematics import ExpressedIn
from cutpoint.model import Drive
from cutpoint.model.drive import Rotor
from cutpoint.rolled import RECIPES, RolledFunction
from cutpoint.rolled import rolled as suited_to
from cutpoint.rolled.bodies import columns_of
from cutpoint.rolled.passes import one_by_one, side_by_side
from large_robots import assert_close, based, chain
from random_trees import random_tree

WAYS = get_args(ExpressedIn)
TOTALS = ("kinetic_energy", "potential_energy", "momentum")
FRAMES: list[Any] = [("frame_pose",), *((name, way) for name in ("jacobian", "frame_acceleration") for way in WAYS)]
TREES = {
    "tree": random_tree(1, 14),
    "one body": chain(1),
    "floating": based("floating", 14),
    "planar": based("planar", 16),
}


@pytest.mark.parametrize(("tree", "backend"), [("floating", "llvm"), ("tree", "llvm"), *((x, "numpy") for x in TREES)])
def test_loops_find_frames_where_straight_line_code_does(tree: str, backend: str) -> None:
    robot = Robot(TREES[tree], backend="numpy")  # it never loops
    q, motion = robot.random(1, 9), np.random.default_rng(1).uniform(-1.0, 1.0, (2, 9, robot.nv))
    q[1], motion[:, 1:3] = robot.neutral(), [[[0.0], [0.0]], [[0.0], [1.0]]]
    for k, frame in enumerate(robot.frames[::4]):
        pose = RolledFunction(("frame_pose",), robot.machine, backend, frame=frame)
        assert_close(pose(q), robot.frame_pose(q, frame))
        np.testing.assert_array_equal(pose(q[8]), pose(q)[8])
        way = WAYS[k % 3]
        J = RolledFunction(("jacobian", way), robot.machine, backend, frame=frame)
        np.testing.assert_allclose(J(q), robot.jacobian(q, frame, way), rtol=0, atol=1e-13)
        np.testing.assert_array_equal(J(q[8]), J(q)[8])
        acceleration = RolledFunction(("frame_acceleration", way), robot.machine, backend, frame=frame)
        np.testing.assert_allclose(
            acceleration(q, *motion), robot.frame_acceleration(q, *motion, frame, way), rtol=0, atol=1e-12
        )
        np.testing.assert_array_equal(acceleration(q[8], *motion[:, 8]), acceleration(q, *motion)[8])


@pytest.mark.parametrize(("tree", "backend"), [("floating", "llvm"), *((x, "numpy") for x in TREES)])
def test_loops_sum_up_energies_and_momentum(tree: str, backend: str) -> None:
    rotors = dict.fromkeys(Robot(TREES[tree]).joints, Drive(100.0, Rotor(2e-4, coupling="full")))
    for drives in ({}, rotors):
        robot = Robot(TREES[tree], drives, backend="numpy")
        q, v = robot.random(1, 9), np.random.default_rng(1).uniform(-1.0, 1.0, (9, robot.nv))
        q[1], v[1] = robot.neutral(), 0.0
        for name in TOTALS:
            given = (q,) if name == "potential_energy" else (q, v)
            function = RolledFunction(name, robot.machine, backend)
            assert_close(function(*given), getattr(robot, name)(*given))
            np.testing.assert_array_equal(function(*(x[8] for x in given)), function(*given)[8])
            np.testing.assert_array_equal(function(*(x[8] for x in given)), function(*given)[8])  # nothing piles up


@pytest.mark.parametrize("key", [*TOTALS, *FRAMES])
@pytest.mark.parametrize("kind", ["floating", "revolute"])
def test_code_for_frames_is_as_long_for_ten_bodies_as_for_a_thousand(key: Any, kind: str) -> None:
    texts = []
    for size in (10, 1000):
        columns = columns_of(machine_of(based(kind, size, branching=False), {}).system)
        arranged = (one_by_one,) if key[0] == "jacobian" else (one_by_one, side_by_side)
        built = [arrange(RECIPES[key].steps(columns), columns, 8) for arrange in arranged]
        texts.append([program_ir(plan(x.body, x.regions)) for x in built])
    assert texts[0] == texts[1]


@pytest.mark.parametrize("key", FRAMES)
def test_only_frames_far_out_are_found_by_loops(key: Any) -> None:
    """However large the robot is: code without loops knows only the bodies that carry the frame."""
    machine, most = machine_of(chain(200), {}), RECIPES[key].most_bodies
    name, *way = key
    assert suited_to((name, f"link{most - 1}", *way), machine, "llvm") is None
    assert suited_to((name, f"link{most}", *way), machine, "llvm") is not None
    assert suited_to((name, f"link{most}", *way), machine, "numpy") is None


def test_a_function_of_frames_that_loops_has_no_kernel() -> None:
    robot = Robot(chain(200))
    robot.jacobian(robot.neutral(), "link199")
    with pytest.raises(InputError, match="jacobian: with 200 bodies it runs as loops over them and has no kernel"):
        robot.kernel("jacobian")
    robot.jacobian(robot.neutral(), "link3")
    assert robot.kernel("jacobian").operations


def test_a_velocity_is_the_jacobian_s_with_ten_thousand_joints() -> None:
    """A frame's velocity by its Jacobian is how its pose changes; kinetic energy is half of v M v, power its rate."""
    robot = Robot(chain(10_000))
    frame, h = robot.frames[-1], 1e-6
    q, v = robot.random(1), 0.01 * np.random.default_rng(2).uniform(-1.0, 1.0, robot.nv)
    start = time.process_time()
    J = robot.jacobian(q, frame, "local_world_aligned")
    ahead, behind = (robot.frame_pose(q + s * h * v, frame) for s in (1, -1))
    assert time.process_time() - start < 15
    velocity, R_dot = (ahead - behind)[:3, 3] / (2 * h), (ahead - behind)[:3, :3] / (2 * h)
    turning = R_dot @ robot.frame_pose(q, frame)[:3, :3].T
    np.testing.assert_allclose((J @ v)[:3], velocity, rtol=0, atol=1e-6)
    later, before = (robot.jacobian(q + s * h * v, frame, "local_world_aligned") @ v for s in (1, -1))
    found = robot.frame_acceleration(q, v, -v, frame, "local_world_aligned")
    np.testing.assert_allclose(found, (later - before) / (2 * h) - J @ v, rtol=0, atol=1e-5)
    np.testing.assert_allclose((J @ v)[3:], [turning[2, 1], turning[0, 2], turning[1, 0]], rtol=0, atol=1e-6)
    # the rate of all energy is the power of the torques
    tau, zero = robot.inverse_dynamics(q, v, v), np.zeros(robot.nv)
    assert robot.kinetic_energy(q, v) == pytest.approx(
        v @ (robot.inverse_dynamics(q, zero, v) - robot.gravity_forces(q)) / 2, rel=1e-9
    )
    rise = [robot.kinetic_energy(q + s * h * v, v + s * h * v) + robot.potential_energy(q + s * h * v) for s in (1, -1)]
    assert (rise[0] - rise[1]) / (2 * h) == pytest.approx(v @ tau, rel=1e-4, abs=1e-3)

"""Regressors of large robots, as loops over bodies: the same as without loops, and as inverse dynamics."""

from typing import Any

import numpy as np
import pytest

from cutpoint import Drive, Robot, Rotor
from cutpoint.errors import InputError
from cutpoint.model import Mechanism
from cutpoint.rolled import RolledFunction
from large_robots import assert_close, based, chain
from random_trees import random_tree

TREES = {
    "one body": chain(1),
    "every kind": chain(9, ("helical", "revolute", "prismatic")),
    "tree of 16": random_tree(1, 16),
    "tree of 21": random_tree(4, 21),
    "floating": based("floating", 14),
    "floating, two blocks": based("floating", 16),
    "planar": based("planar", 9),
    "spherical": based("spherical", 5, branching=False),
}


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("tree", TREES)
def test_loops_give_what_straight_line_code_gives(tree: str, backend: str) -> None:
    robot = Robot(TREES[tree], backend="numpy")  # it never loops
    rng, loops = np.random.default_rng(3), RolledFunction("regressor", robot.machine, backend)
    q, v, a = robot.random(rng, (3,)), *rng.normal(size=(2, 3, robot.nv))
    expected = robot.regressor(q, v, a)
    assert_close(loops(q, v, a), expected, 1e-13)
    assert np.array_equal(loops(q[1], v[1], a[1]), loops(q, v, a)[1])


def test_a_joint_feels_nothing_of_bodies_that_it_does_not_carry() -> None:
    robot = Robot(random_tree(2, 20))
    Y = RolledFunction("regressor", robot.machine, "llvm")(*[np.ones(robot.nv)] * 3).reshape(robot.nv, -1, 10)
    for k, body in enumerate(robot.machine.system.segments):
        carriers = {i for i in range(robot.nv) if k in _carried(robot, i)}
        felt = {*np.flatnonzero(np.abs(Y[:, k]).any(axis=1)).tolist()}
        assert felt <= carriers, body.name
        assert k in felt


def _carried(robot: Robot, i: int) -> set[int]:
    parents = [body.parent for body in robot.machine.system.segments]
    found = {i}
    for k in range(i + 1, len(parents)):
        if parents[k] in found:
            found.add(k)
    return found


@pytest.mark.parametrize("mechanism", [chain(20), chain(400), based("floating", 200)], ids=["20", "400", "floating"])
def test_it_times_the_parameters_is_what_inverse_dynamics_says(mechanism: Mechanism) -> None:
    robot, rng = Robot(mechanism), np.random.default_rng(7)
    q, v, a = robot.random(rng), *rng.normal(size=(2, robot.nv)) / robot.nv
    assert_close(robot.regressor(q, v, a) @ robot.inertial_parameters, robot.inverse_dynamics(q, v, a), 1e-11)


@pytest.mark.parametrize("coupling", ["reduced", "full"])
def test_what_rotors_spin_costs_is_no_part_of_it(coupling: Any) -> None:
    mechanism = chain(24)
    names = [body.joint.name for body in mechanism.bodies]
    rotors = dict.fromkeys(names, Drive(ratio=100.0, rotor=Rotor(1e-4, coupling=coupling)))
    state = np.random.default_rng(8).normal(size=(3, 24))
    assert_close(Robot(mechanism, rotors).regressor(*state), Robot(mechanism, backend="numpy").regressor(*state), 1e-13)


def test_one_that_memory_would_not_hold_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cutpoint.rolled.functions.MOST_NUMBERS", 40 * 400 - 1)
    with pytest.raises(InputError, match=r"regressor: a matrix \(40, 400\) has more than 15999 numbers.*smaller model"):
        Robot(chain(40)).regressor(*np.zeros((3, 40)))

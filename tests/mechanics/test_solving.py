"""Equations with a tree's mass matrix, solved without the zeros between its branches: as LAPACK solves them."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pinocchio
import pytest

from cutpoint import Robot, derivatives
from cutpoint.derivatives.large import forward_dynamics
from cutpoint.errors import InputError
from cutpoint.rolled.solving import TreeSolver, is_sparse
from large_robots import assert_close, based, chain
from random_trees import tree_of_every_kind
from robot_library import load
from twins import pinocchio_of

EPS = np.finfo(float).eps
TREES = {
    "one joint": chain(1),
    "chain": chain(9),
    "floating": based("floating", 12),
    "branches": based("revolute", 25),
    **{f"every kind, {k}": tree_of_every_kind(k) for k in (1, 4)},
}


@pytest.mark.parametrize("widths", [(3, 8, 17), ()], ids=str)
@pytest.mark.parametrize("tree", TREES)
def test_solutions_are_lapacks(tree: str, widths: tuple[int, ...]) -> None:
    robot, rng = Robot(TREES[tree]), np.random.default_rng(2)
    M = robot.mass_matrix(robot.random(rng, 4))
    given = [rng.normal(size=(4, robot.nv, width)) for width in widths]
    solver = TreeSolver(robot.machine.system, widths)
    found = solver(M, *given)
    assert found is not None
    accuracy = 100 * EPS * np.linalg.cond(M).max()
    for x, b in zip(found, [*given, -np.eye(robot.nv)], strict=True):
        assert_close(x, -np.linalg.solve(M, np.broadcast_to(b, x.shape)), rtol=accuracy)
    for k in range(4):
        one = solver(M[k], *(b[k] for b in given))
        assert one is not None
        for x, of_batch in zip(one, found, strict=True):
            np.testing.assert_array_equal(x, of_batch[k])


def test_matrices_without_an_inverse_are_told() -> None:
    robot = Robot(chain(5))
    solver, M = TreeSolver(robot.machine.system, [2]), robot.mass_matrix(robot.neutral())
    given = np.ones((5, 2))
    for wrong in (-M, np.zeros((5, 5)), np.ones((5, 5)), M * np.nan):
        assert solver(wrong, given) is None
        assert solver(np.stack([M, wrong]), np.stack([given, given])) is None
    with pytest.raises(InputError, match="forward_dynamics_derivatives: the first 2 rows of the mass matrix"):
        forward_dynamics(np.ones((5, 5)), np.ones((5, 5)), np.ones((5, 5)), TreeSolver(robot.machine.system, [5, 5]))


def test_no_matrices_have_no_solutions() -> None:
    found = TreeSolver(Robot(chain(3)).machine.system, [2])(np.empty((0, 3, 3)), np.empty((0, 3, 2)))
    assert found is not None and [x.shape for x in found] == [(0, 3, 2), (0, 3, 3)]


def test_calls_from_several_threads_do_not_meet() -> None:
    robot, rng = Robot(based("revolute", 25)), np.random.default_rng(3)
    solver = TreeSolver(robot.machine.system, [robot.nv])
    given = [(robot.mass_matrix(robot.random(rng, 50)), rng.normal(size=(50, robot.nv, robot.nv))) for _ in range(8)]
    expected = [solver(*x) for x in given]
    with ThreadPoolExecutor(4) as pool:
        for found, alone in zip(pool.map(lambda x: solver(*x), given), expected, strict=True):
            assert found is not None and alone is not None
            for x, y in zip(found, alone, strict=True):
                np.testing.assert_array_equal(x, y)


def test_humanoids_are_sparse_and_long_chains_are_not() -> None:
    assert is_sparse(load("talos_reduced.urdf", floating_base=True).machine.system)
    assert not is_sparse(Robot(chain(96)).machine.system)


@pytest.mark.parametrize("rows", [(), (3,)], ids=str)
def test_derivatives_of_a_humanoids_accelerations_are_pinocchios(rows: tuple[int, ...]) -> None:
    robot = load("talos_reduced.urdf")
    model = pinocchio_of(robot.mechanism)
    data, rng = model.createData(), np.random.default_rng(4)
    q, v, tau = (rng.uniform(-1, 1, (*rows, robot.nv)) for _ in range(3))
    ours = derivatives.forward_dynamics(robot, q, v, tau)
    for at in np.ndindex(rows):
        pinocchio.computeABADerivatives(model, data, q[at], v[at], tau[at])
        upper = np.triu(data.Minv)
        accuracy = 100 * EPS * np.linalg.cond(robot.mass_matrix(q[at]))
        for x, y in zip(ours, (data.ddq_dq, data.ddq_dv, upper + np.triu(upper, 1).T), strict=True):
            assert_close(x[at], y, rtol=accuracy)

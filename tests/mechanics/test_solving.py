"""Equations with a tree's mass matrix, by its factors or through its bodies: as LAPACK solves them."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pinocchio
import pytest

from cutpoint import Robot, derivatives
from cutpoint.derivatives.large import solved
from cutpoint.errors import InputError
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from cutpoint.rolled.equations import solver_of
from cutpoint.rolled.equations.articulated_bodies import ArticulatedBodies
from cutpoint.rolled.equations.factored import Factored, is_sparse
from cutpoint.rolled.equations.solver import Solver
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


ALONG_ONE_AXIS = ("revolute", "prismatic", "helical")
CASES = [(Factored, tree) for tree in TREES.values()] + [
    (ArticulatedBodies, tree)
    for tree in (
        *(TREES[name] for name in ("one joint", "chain", "branches")),
        chain(130, ALONG_ONE_AXIS),
        based("revolute", 60),
        TREES["floating"],
        based("floating", 70, branching=False),
        *(based(kind, 20) for kind in ("planar", "spherical")),
    )
]


@pytest.mark.parametrize("widths", [(3, 8, 17), (16, 33), ()], ids=str)
@pytest.mark.parametrize("case", range(len(CASES)))
def test_solutions_are_lapacks(case: int, widths: tuple[int, ...]) -> None:
    equations, tree = CASES[case]
    robot, rng = Robot(tree), np.random.default_rng(2)
    M = robot.mass_matrix(q := robot.random(rng, 4))
    given = [rng.normal(size=(4, robot.nv, width)) for width in widths]
    solver = Solver(equations(robot.machine.system), widths)
    state = M if solver.reads == "M" else q
    found = solver(state, *given)
    assert found is not None
    accuracy = 100 * EPS * np.linalg.cond(M).max()
    for x, b in zip(found, [*given, -np.eye(robot.nv)], strict=True):
        assert_close(x, -np.linalg.solve(M, np.broadcast_to(b, x.shape)), rtol=accuracy)
    for k in range(4):
        one = solver(state[k], *(b[k] for b in given))
        assert one is not None
        for x, of_batch in zip(one, found, strict=True):
            np.testing.assert_array_equal(x, of_batch[k])


def test_matrices_without_an_inverse_are_told() -> None:
    robot = Robot(chain(5))
    solver, M = Solver(Factored(robot.machine.system), [2]), robot.mass_matrix(robot.neutral())
    given = np.ones((5, 2))
    for wrong in (-M, np.zeros((5, 5)), np.ones((5, 5)), M * np.nan):
        assert solver(wrong, given) is None
        assert solver(np.stack([M, wrong]), np.stack([given, given])) is None
    with pytest.raises(InputError, match="forward_dynamics_derivatives: the first 2 rows of the mass matrix"):
        M, *B = np.ones((3, 5, 5))
        solved(np.zeros(5), M, B, Solver(Factored(robot.machine.system), [5, 5]), "forward_dynamics_derivatives")


def test_a_joint_that_moves_no_inertia_is_told() -> None:
    links = [Link("base"), *(Link(f"link{k}", 1.0) for k in range(40))]  # points, the last at its joint
    T = np.eye(4)
    T[:3, 3] = 0.1, 0.2, 0.3
    names = [link.name for link in links]
    joints = [Joint(f"joint{k}", "revolute", *names[k : k + 2], T, np.eye(3)[k % 3]) for k in range(40)]
    robot = Robot(build("points", links, joints))
    solver, q, given = solver_of(robot.machine.system, [2]), robot.neutral(), np.ones((40, 2))
    assert solver is not None and solver.reads == "q"
    assert solver(q, given) is None
    assert solver(np.stack([q, q]), np.stack([given, given])) is None


def test_no_matrices_have_no_solutions() -> None:
    found = Solver(Factored(Robot(chain(3)).machine.system), [2])(np.empty((0, 3, 3)), np.empty((0, 3, 2)))
    assert found is not None and [x.shape for x in found] == [(0, 3, 2), (0, 3, 3)]


@pytest.mark.parametrize("equations", [Factored, ArticulatedBodies])
def test_calls_from_several_threads_do_not_meet(equations: type[Factored | ArticulatedBodies]) -> None:
    robot, rng = Robot(based("revolute", 25)), np.random.default_rng(3)
    solver, n = Solver(equations(robot.machine.system), [robot.nv]), robot.nv
    states = [robot.random(rng, 50) for _ in range(8)]
    given = [(robot.mass_matrix(q) if solver.reads == "M" else q, rng.normal(size=(50, n, n))) for q in states]
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
@pytest.mark.parametrize("which", ["humanoid", "chain"])
def test_derivatives_of_accelerations_are_pinocchios(which: str, rows: tuple[int, ...]) -> None:
    robot = load("talos_reduced.urdf") if which == "humanoid" else Robot(chain(96))
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

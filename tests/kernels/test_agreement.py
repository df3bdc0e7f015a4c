"""One table of agreement: whatever computes a graph gives the same numbers, for robots and for random expressions.

Machine code one by one and in packs, C99, CUDA C and JAX agree to the last bit for any input.  NumPy, and SymPy in 60
digits, are within the running error bound of each result.
"""

from collections import namedtuple
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from emitters import EXACT, Rows, bounded_row, flat, numpy_rows, single, sympy_row
from graph_recipes import (
    Step,
    choices_between_zeros,
    cook,
    cook_unbounded,
    every_turned_sign,
    signed_ones_and_zeros,
    steps,
    unbounded_steps,
)
from hypothesis import Phase, given, note, settings
from hypothesis import strategies as st

import robot_library
from c_builds import assert_same_bits
from cutpoint.kernels import Kernel, compile

EDGES = [0.0, -0.0, 5e-324, 1e-300, 1e-8, 0.5, -1.0, 3.0, 1e5, 1e17, -1e300, np.inf, -np.inf, np.nan]
SCALES = [0.0, 5e-324, 1e-300, 1e-150, 1e-8, *[1.0] * 60, 10.0, 1e3, 1e9, 1e100, 1e200, np.inf, np.nan]
"""Of a robot's inputs, a row each: enough rows for packs."""
TAME = (0, 2, 4, *range(5, 9), 65)
"""Rows whose results have a running error bound worth the name."""

WITHOUT_SHRINKING = (Phase.explicit, Phase.reuse, Phase.generate)
"""Every try of a smaller example would compile anew."""

ROBOTS = [
    ("xia2019", "inverse_dynamics"), ("xia2019", "forward_dynamics"), ("xia2019", "elastic_inverse_dynamics"),
    ("mixed", "inverse_dynamics"), ("mixed", "mass_matrix"), ("mixed_floating", "forward_dynamics"),
]  # fmt: skip


@cache
def robot_kernel(robot: str, function: str) -> Kernel:
    machine = robot_library.MAKERS[robot]()
    vectors = {"mass_matrix": 0, "elastic_inverse_dynamics": 4}.get(function, 2)
    getattr(machine, function)(machine.neutral(), *np.zeros((vectors, machine.nv)))
    return machine.kernel(function)


@cache
def robot_rows(robot: str, function: str) -> Rows:
    """Random inputs of every scale; positions around the neutral ones, the drives' numbers around the robot's own."""
    machine, rng, scales = robot_library.MAKERS[robot](), np.random.default_rng(7), np.array(SCALES)
    rows = []
    for p in robot_kernel(robot, function).graph.inputs:
        random = rng.normal(size=(len(scales), *p.shape))
        if p.name == "parameters":
            rows.append(machine.drive_parameters * (1 + random / 100))
        else:
            rows.append((machine.neutral() if p.name == "q" else 0.0) + scales[:, None] * random)
    return rows


@pytest.mark.parametrize("emitter", EXACT)
@pytest.mark.parametrize(("robot", "function"), ROBOTS)
def test_emitters_give_the_bits_of_machine_code_for_robots(
    robot: str, function: str, emitter: str, tmp_path: Path
) -> None:
    kernel, rows = robot_kernel(robot, function), robot_rows(robot, function)
    for ours, theirs in zip(EXACT[emitter](kernel, tmp_path)(rows), single(kernel, tmp_path)(rows), strict=True):
        assert_same_bits(ours, theirs)


@pytest.mark.parametrize("emitter", EXACT)
@pytest.mark.parametrize(("function", "size"), [(every_turned_sign, 9), (choices_between_zeros, 2)])
def test_emitters_keep_the_signs_of_exact_zeros(function: Any, size: int, emitter: str, tmp_path: Path) -> None:
    kernel, rows = compile(function, x=size, backend="llvm"), [signed_ones_and_zeros(size)]
    (found,), (expected,) = EXACT[emitter](kernel, tmp_path)(rows), single(kernel, tmp_path)(rows)
    assert np.count_nonzero(expected == 0) > 100
    assert_same_bits(found, expected)


@pytest.mark.parametrize(("robot", "function"), ROBOTS)
def test_numpy_and_sympy_are_within_the_running_error_bound_for_robots(
    robot: str, function: str, tmp_path: Path
) -> None:
    kernel, rows = robot_kernel(robot, function), [x[[*TAME]] for x in robot_rows(robot, function)]
    assert_within_bounds(kernel, rows, tmp_path)


def assert_within_bounds(kernel: Kernel, rows: Rows, folder: Path) -> None:
    """Machine code and NumPy in every row, SymPy in the first and the last two."""
    machine, array = single(kernel, folder)(rows), numpy_rows(kernel, rows)
    count = len(rows[0])
    for k in range(count):
        row = [x[k] for x in rows]
        candidates = [flat(machine, k), flat(array, k)]
        if k in (0, count - 2, count - 1):
            candidates.append(sympy_row(kernel, row))
        expected = bounded_row(kernel, row)
        for found in candidates:
            for x, bound in zip(found, expected, strict=True):
                assert abs(x - bound.value) <= bound.error


Outputs = namedtuple("Outputs", "vector number matrix")


def fuzzed(cooked: Any, recipes: list[list[Step]], name: str) -> Kernel:
    """Random expressions of a vector, a number and a matrix, as outputs of every kind."""

    def function(x: Any, k: Any, M: Any) -> Outputs:
        found = [y for recipe in recipes for y in cooked(recipe, [*x, k, *M[0], *M[1]])]
        return Outputs([*found, 2.5, x[0], float("inf")], found[0], [found[:2], [-0.0, k]])

    return compile(function, name=name, x=3, k=(), M=(2, 2), backend="llvm")


def fuzzed_rows(seed: int, edges: bool) -> Rows:
    rng = np.random.default_rng(seed)
    shapes = ((3,), (), (2, 2))
    random = [rng.uniform(-3, 3, (50, *shape)) for shape in shapes]
    odd = [rng.choice(EDGES, (80, *shape)) for shape in shapes]
    return [np.concatenate(pair) for pair in zip(random, odd, strict=True)] if edges else [x[:3] for x in random]


def recipes_of(step: st.SearchStrategy[Step]) -> st.SearchStrategy[list[list[Step]]]:
    return st.lists(st.lists(step, min_size=1, max_size=25), min_size=8, max_size=8)


@given(recipes_of(unbounded_steps), st.integers(0, 2**32 - 1))
@settings(max_examples=5, phases=WITHOUT_SHRINKING)
def test_emitters_give_the_bits_of_machine_code_for_random_expressions(
    tmp_path_factory: Any, recipes: list[list[Step]], seed: int
) -> None:
    kernel, rows = fuzzed(cook_unbounded, recipes, "fuzzed"), fuzzed_rows(seed, edges=True)
    expected = single(kernel, tmp_path_factory.mktemp("none"))(rows)
    for name, emitter in EXACT.items():
        note(name)
        found = emitter(kernel, tmp_path_factory.mktemp("fuzzed"))(rows)
        for ours, theirs in zip(found, expected, strict=True):
            assert_same_bits(ours, theirs)


@given(recipes_of(steps), st.integers(0, 2**32 - 1))
@settings(max_examples=10, phases=WITHOUT_SHRINKING)
def test_numpy_and_sympy_are_within_the_running_error_bound_for_random_expressions(
    tmp_path_factory: Any, recipes: list[list[Step]], seed: int
) -> None:
    kernel = compile(
        lambda x, k, M: [y for recipe in recipes for y in cook(recipe, [*x, k, *M[0], *M[1]])],
        name="fuzzed", x=3, k=(), M=(2, 2), backend="llvm",
    )  # fmt: skip
    assert_within_bounds(kernel, fuzzed_rows(seed, edges=False), tmp_path_factory.mktemp("none"))

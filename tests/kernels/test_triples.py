"""Stages whose numbers come in threes: wide registers give what numbers one by one give."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutpoint.errors import InputError
from cutpoint.kernels import LaneLoop, Loop, Region, Stage, View, compile_program, graph_of
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.lowering.fusion import fuse
from cutpoint.kernels.programs.superwords import Superwords, Word

BACKENDS = ("llvm", "numpy")
Vector = list[Any]


def dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def quadratic(a: Vector, rows: list[Vector]) -> Any:
    """a^T R a, by products of a."""
    return sum(dot([x * y for y in a], row) for x, row in zip(a, rows, strict=True))


OPERATIONS: dict[str, Callable[[Vector, Vector], Vector]] = {
    "plus": lambda a, b: [x + y for x, y in zip(a, b, strict=True)],
    "less": lambda a, b: [x - y for x, y in zip(a, b, strict=True)],
    "crossed": cross,
    "scaled": lambda a, b: [x * b[1] for x in a],
    "divided": lambda a, b: [x / (1 + dot(b, b)) for x in a],
    "along": lambda a, b: [dot(a, b) * x for x in b],
    "turned": lambda a, _: [a[2], a[0], a[1]],
    "beside": lambda a, b: [a[2], b[0], -b[1]],
    "column": lambda a, b: [a[0], b[0], a[1]],
    "squared": lambda a, b: [x * quadratic(a, [b, a, cross(a, b)]) for x in b],
    "flat": lambda a, _: [-a[1], a[0], 0.0],
    "mixed": lambda a, b: [a[0] * b[0], a[1] + b[1], 0.5],
    "shared": lambda a, b: [a[0] * b[1] + a[2], a[0] * b[1] - b[2], a[0] * b[1]],
}
steps = st.tuples(st.sampled_from([*OPERATIONS]), st.integers(0, 20), st.integers(0, 20))


def cook(recipe: list[tuple[str, int, int]], given: list[Vector]) -> list[Vector]:
    """The last two vectors of a recipe, each step kept in bounds."""
    found = [*given]
    for name, i, j in recipe:
        new = OPERATIONS[name](found[i % len(found)], found[j % len(found)])
        found.append([x / (1 + dot(new, new)) for x in new])
    return found[-2:]


def stage_of(recipe: list[tuple[str, int, int]]) -> Callable[..., Any]:
    def step(own: Any, above: Any, number: Any) -> Any:
        first, second = cook(recipe, [own[:3], own[3:], above[:3], above[3:], [number[0], number[1], number[0]]])
        return [*first, *second], [first[0] + second[1], number[0]]

    return step


def run(recipe: list[tuple[str, int, int]], parents: np.ndarray, x: np.ndarray, s: np.ndarray, backend: str) -> Any:
    stage = Stage(stage_of(recipe), ("x", "above", "s"), ("x", "s"))
    loop = LaneLoop("bodies", [stage], ("x", "s"), views=[View("above", "x", "parents")])
    program = compile_program(Loop(1, [loop]), [Region("x", 6, triples=True), Region("s", 2)], backend)
    rows = np.zeros((len(x), 2, 4))
    rows[:, :, :3] = x.reshape(-1, 2, 3)
    arrays = {"x": rows.reshape(-1, 8), "s": s.copy()}
    program.run({"bodies": len(parents)}, parents=parents, **arrays)
    return rows[:, :, :3].reshape(-1, 6), arrays["s"]


def plainly(recipe: list[tuple[str, int, int]], parents: np.ndarray, x: np.ndarray, s: np.ndarray) -> Any:
    x, s, step = x.copy(), s.copy(), stage_of(recipe)
    for k, parent in enumerate(parents):
        x[k], s[k] = step([*x[k]], [*x[parent]], [*s[k]])
    return x, s


@given(st.lists(steps, min_size=1, max_size=12), st.integers(0, 2**32 - 1), st.booleans())
def test_any_stage_of_threes_is_what_its_numbers_are_one_by_one(
    recipe: list[tuple[str, int, int]], seed: int, is_chain: bool
) -> None:
    rng, n = np.random.default_rng(seed), 7
    parents = np.array([n if k == 0 else k - 1 if is_chain else rng.integers(0, k) for k in range(n)], np.int64)
    x, s = rng.uniform(-1, 1, (n + 1, 6)), rng.uniform(-1, 1, (n + 1, 2))
    expected = plainly(recipe, parents, x, s)
    for backend in BACKENDS:
        for ours, plain in zip(run(recipe, parents, x, s, backend), expected, strict=True):
            np.testing.assert_allclose(ours, plain, rtol=0, atol=1e-12)


def test_like_operations_go_into_words() -> None:
    """Of cross products and sums nothing is left to be computed number by number."""

    def step(a: Any, b: Any, c: Any) -> Any:
        return [x + y for x, y in zip(cross(a, b), cross(b, cross(a, c)), strict=True)]

    graph = graph_of(step, a=3, b=3, c=3)
    found = Superwords(graph, range(0, 9, 3), [0])
    assert found.words[0].op != "join"
    assert all(isinstance(unit, Word) and unit.op != "join" for unit in found.order)


def test_what_adds_up_to_one_number_goes_into_a_word() -> None:
    """Of a quadratic form only the sum of the last three numbers is computed number by number."""
    graph = graph_of(lambda a, R: [quadratic(a, [R[:3], R[3:6], R[6:]])], a=3, R=9)
    found = Superwords(fuse(graph, again=True), range(0, 12, 3), [])
    alone = [unit.op for unit in found.order if isinstance(unit, Node)]
    assert [op for op in alone if op != "input"] == ["add", "add"]
    assert all(unit.op != "join" for unit in found.order if isinstance(unit, Word))


def test_columns_of_rows_are_joined_word_by_word() -> None:
    graph = graph_of(lambda R, x: [x[k] * R[3 * k] for k in range(3)], R=9, x=3)
    found = Superwords(graph, range(0, 12, 3), [0])
    (join,) = [unit for unit in found.order if isinstance(unit, Word) and unit.op == "join"]
    assert [(word.op, word.slot, lane) for word, lane in zip(join.operands, join.lanes, strict=True)] == [
        ("read", 0, 0), ("read", 3, 0), ("read", 6, 0),
    ]  # fmt: skip


@pytest.mark.parametrize("backend", BACKENDS)
def test_rows_are_turned_into_columns(backend: str) -> None:
    stage = Stage(lambda x: [x[3 * (k % 3) + k // 3] for k in (0, 4, 5, 1, 2, 3, 8, 6, 7)], ("x",), ("x",))
    loop, x = LaneLoop(1, [stage], ("x",)), np.arange(12.0)[None]
    compile_program(Loop(1, [loop]), [Region("x", 9, triples=True)], backend).run({}, x=x)
    np.testing.assert_array_equal(x.reshape(3, 4)[:, :3], [[0, 5, 9], [4, 8, 1], [10, 2, 6]])


def one_after_another(x: Any, s: Any) -> list[Any]:
    """Like operations, but each on what the one before gives."""
    first = x[0] / s[0]
    return [first, first / s[0], first / s[0] / s[0], *x[3:]]


def for_each_other(x: Any, s: Any) -> list[Any]:
    """Two threes of like operations, of which each needs a number of the other."""
    second = x[4] + s[1]
    a = [x[0] / s[0], second / s[0], x[2] / s[0]]
    return [*a, a[0] + s[1], second, x[5] + s[1]]


@pytest.mark.parametrize("function", [one_after_another, for_each_other])
def test_numbers_that_wait_for_each_other_are_no_word(function: Callable[..., Any]) -> None:
    stage = Stage(function, ("x", "s"), ("x",))
    loop, x, s = LaneLoop(1, [stage], ("x",)), np.arange(1.0, 9.0)[None], np.array([3.0, 0.7])
    expected = function([1.0, 2.0, 3.0, 5.0, 6.0, 7.0], s)
    compile_program(Loop(1, [loop]), [Region("x", 6, triples=True), Region("s", 2)]).run({}, x=x, s=s)
    np.testing.assert_array_equal(x.reshape(2, 4)[:, :3].ravel(), expected)


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_bodies_may_add_to_one_parent(backend: str) -> None:
    """Inward, rows are added to that the iteration before wrote."""

    def inward(own: Any, borne: Any) -> Any:
        return [2 * x + y for x, y in zip(own, borne, strict=True)]

    parents, n = np.array([5, 0, 0, 1, 1], np.int64), 5
    stage = Stage(inward, ("x", "borne"), ("borne",))
    loop = LaneLoop("bodies", [stage], ("x",), backward=True, views=[View("borne", "x", "parents")])
    x = np.ones((n + 1, 4))
    program = compile_program(Loop(1, [loop]), [Region("x", 3, triples=True)], backend)
    program.run({"bodies": n}, parents=parents, x=x)
    np.testing.assert_array_equal(x[:, :3], np.repeat([[13], [5], [1], [1], [1], [27]], 3, axis=1))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_stage_leaves_threes_to_the_next_in_a_region_without_rows(backend: str) -> None:
    stages = [
        Stage(lambda x: [*cross(x[:3], x[3:]), *x[:3]], ("x",), ("left",)),
        Stage(lambda left, x: [*OPERATIONS["plus"](left[:3], x[3:]), *left[3:]], ("left", "x"), ("x",)),
    ]
    x = np.random.default_rng(2).normal(size=(5, 2, 4))
    a, b = x[:, 0, :3].copy(), x[:, 1, :3].copy()
    regions = [Region("x", 6, triples=True), Region("left", 6, triples=True)]
    compile_program(LaneLoop(5, stages, ("x",)), regions, backend).run({}, x=x.reshape(5, 8), left=np.zeros(8))
    np.testing.assert_allclose(x[:, :, :3], np.stack([np.cross(a, b) + b, a], axis=1), rtol=1e-12)


def test_threes_are_for_one_body_after_another() -> None:
    stage, wide = (Stage(lambda x: x, ("x",), ("x",), lanes) for lanes in (1, 2))
    for region, loop, told in [
        (Region("x", 4, triples=True), LaneLoop("n", [stage], ("x",)), "whole in threes"),
        (Region("x", 6, 2, triples=True), LaneLoop("n", [stage], ("x",)), "of one lane"),
        (Region("x", 3, triples=True), Loop("n", [stage], ("x",)), "LaneLoop"),
        (Region("x", 3, triples=True), Loop("n", [wide]), "of one lane"),
    ]:
        with pytest.raises(InputError, match=told):
            compile_program(loop, [region])

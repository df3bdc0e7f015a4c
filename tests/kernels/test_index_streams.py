"""Loops over the rows of a tree: rows that a list names, streams that run backward, streams that go on."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cutpoint.errors import InputError
from cutpoint.kernels import Loop, Program, Region, Stage, View, compile_program

BACKENDS = ("llvm", "numpy")


def outward(x: Any, own: Any, above: Any) -> Any:
    return [above[0] / 2 + x[0], own[1]], [0, 1]


def inward(load: Any, borne: Any, total: Any) -> Any:
    return [borne[0] + load[0] * total[0], borne[1] + load[1]]


def gather(x: Any, total: Any, load: Any) -> Any:
    return [total[0], x[0]], [x[0] * x[0], load[1]]


def tree_program(backend: str) -> Program:
    """Each node's total is half its parent's plus its own; its load, and how many nodes it bears, go to its parent."""
    views = (View("above", "total", "parents"), View("borne", "load", "parents"))
    there = [Stage(outward, ("x", "total", "above"), ("total", "load")), Stage(first, ("x", "load"), ("load",))]
    back = Stage(inward, ("load", "borne", "total"), ("borne",))
    passes = [
        Loop("nodes", there, ("total", "load", "x"), views=views),
        Loop("nodes", [back, Stage(keep, ("load",), ("result",))], ("total", "load", "result"), None, True, views),
    ]
    regions = [Region("x", 1), Region("total", 2), Region("load", 2), Region("result", 2)]
    return compile_program(Loop(1, passes), regions, backend)


def first(x: Any, load: Any) -> Any:
    return [x[0], load[1]]


def keep(load: Any) -> Any:
    return load


def plainly(parents: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The same with plain loops: (n, 2) load and count of each node."""
    n = len(parents)
    total, load, count = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    for i in range(n):
        total[i], load[i], count[i] = total[parents[i]] / 2 + x[i], x[i], 1
    for i in reversed(range(n)):
        load[parents[i]] += load[i] * total[i]
        count[parents[i]] += count[i]
    return np.stack([load, count], axis=1)[:n]


def random_parents(rng: np.random.Generator, n: int) -> np.ndarray:
    """Before their children; row n stands for the world."""
    return np.array([n if i == 0 else rng.choice([i - 1, rng.integers(0, i), n]) for i in range(n)], dtype=np.int64)


def memory(n: int, x: np.ndarray) -> dict[str, np.ndarray]:
    kept = {"total": np.zeros((n + 1, 2)), "load": np.zeros((n + 1, 2))}
    return kept | {"x": x.reshape(-1, 1), "result": np.full((x.size, 2), np.nan)}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("n", [1, 2, 7, 30])
def test_any_tree_is_walked_outward_and_inward(backend: str, n: int) -> None:
    program = tree_program(backend)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        parents, x = random_parents(rng, n), rng.normal(size=n)
        arrays = memory(n, x)
        assert program.run({"nodes": n}, parents=parents, **arrays) == 1
        expected = plainly(parents, x)
        # at most n sums and products of numbers of either sign
        scale = np.abs(plainly(parents, np.abs(x))).max()
        np.testing.assert_allclose(arrays["result"], expected, rtol=0, atol=4 * n * np.finfo(float).eps * scale)


def test_both_backends_agree_in_every_place() -> None:
    n, ends = 12, []
    rng = np.random.default_rng(9)
    parents, x = random_parents(rng, n), rng.normal(size=n)
    for backend in BACKENDS:
        arrays = memory(n, x)
        tree_program(backend).run({"nodes": n}, parents=parents, **arrays)
        ends.append(arrays)
    for name in ends[0]:
        np.testing.assert_allclose(ends[0][name], ends[1][name], rtol=1e-12, atol=1e-14, err_msg=name)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_backward_stream_ends_with_its_first_row(backend: str) -> None:
    digit = Stage(lambda row, out: [out[0] * 10 + row[0]], ("row", "out"), ("out",))
    for backward, expected in ((False, 123), (True, 321)):
        loop = Loop(3, [digit], ("row",), backward=backward)
        out = np.zeros(1)
        row = np.array([[1.0], [2.0], [3.0], [9.0]])
        compile_program(loop, [Region("row", 1), Region("out", 1)], backend).run({}, row=row, out=out)
        assert out[0] == expected


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bound_program_runs_again_on_what_its_arrays_hold_now(backend: str) -> None:
    n, rng = 5, np.random.default_rng(2)
    parents, x = random_parents(rng, n), rng.normal(size=(1, n))
    arrays = memory(n, x)
    run = tree_program(backend).bound({"nodes": n}, parents=parents, **arrays)
    for _ in range(2):
        arrays["x"][:] = rng.normal(size=(n, 1))
        assert run() == 1
        expected = plainly(parents, arrays["x"][:, 0])
        np.testing.assert_allclose(arrays["result"], expected, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("backend", BACKENDS)
def test_lanes_find_their_rows_too(backend: str) -> None:
    """A wide stage writes a row that the next stage, of single numbers, reads under another name."""

    def wide(x: Any) -> Any:
        return [x[0] + 1]

    def narrow(again: Any, total: Any) -> Any:
        return [total[0] + sum(again)]

    body = [Stage(wide, ("x",), ("x",), 4), Stage(narrow, ("again", "total"), ("total",))]
    loop = Loop(3, body, ("x",), views=(View("again", "x", "rows"),))
    x, total = np.arange(12.0).reshape(3, 4), np.zeros(1)
    program = compile_program(loop, [Region("x", 4, 4), Region("total", 1)], backend)
    program.run({}, x=x, total=total, rows=np.array([0, 1, 2]))
    assert total[0] == 66 + 12


@pytest.mark.parametrize("backend", BACKENDS)
def test_lanes_see_what_was_written_under_another_name(backend: str) -> None:
    up, tenfold = (lambda x: [n + 1 for n in x]), (lambda again: [10 * n for n in again])
    wide = Stage(lambda x: [x[0] + 1], ("x",), ("y",), 4)
    body = [Stage(up, ("x",), ("x",)), Stage(tenfold, ("again",), ("again",)), wide]
    loop = Loop(2, body, ("x", "y"), views=(View("again", "x", "rows"),))
    x, y = np.arange(8.0).reshape(2, 4), np.zeros((2, 4))
    program = compile_program(loop, [Region("x", 4, 4), Region("y", 4, 4)], backend)
    program.run({}, x=x, y=y, rows=np.array([0, 1]))
    assert y.tolist() == [[11, 21, 31, 41], [51, 61, 71, 81]]


WRONG_ROWS: list[tuple[Any, str]] = [
    (np.array([3, 0, 4]), "names row 4; region 'total' has rows 0 to 3"),
    (np.array([3, -1, 0]), "names row -1"),
    (np.array([3, 0]), "has 2 entries, but must have at least 3"),
    (np.array([3.0, 0.0, 1.0]), "of int64"),
    (np.array([3, 0, 1], np.int32), "of int64"),
    (np.array([3, 9, 0, 9, 1])[::2], "contiguous"),
    ([3, 0, 1], "of int64"),
]


@pytest.mark.parametrize("case", range(len(WRONG_ROWS)))
def test_no_wrong_list_of_rows_reaches_machine_code(case: int) -> None:
    rows, message = WRONG_ROWS[case]
    with pytest.raises(InputError) as caught:
        tree_program("llvm").bound({"nodes": 3}, parents=rows, **memory(3, np.ones((1, 3))))
    assert message in str(caught.value)


def test_a_stream_needs_rows_for_all_its_iterations() -> None:
    arrays = memory(3, np.ones((1, 3)))
    with pytest.raises(InputError, match=r"region 'x' streams: .* at least 4 rows of 1"):
        tree_program("llvm").run({"nodes": 4}, parents=np.array([3, 0, 1, 2]), **arrays)
    with pytest.raises(InputError, match="array 'parents' is missing"):
        tree_program("llvm").run({"nodes": 3}, **arrays)


def same(x: Any) -> Any:
    return x


@pytest.mark.parametrize("backend", BACKENDS)
def test_rows_that_only_lists_name_are_as_many_as_the_array_has(backend: str) -> None:
    """Rows that no list names stay as they are."""
    stage = Stage(lambda x, y: [x[0] + 10 * y[0]], ("from", "to"), ("to",))
    views = (View("from", "x", "i"), View("to", "y", "j"))
    program = compile_program(Loop("pairs", [stage], views=views), [Region("x", 1), Region("y", 1)], backend)
    x, y, i, j = np.arange(3.0)[:, None], np.ones((4, 1)), np.array([2, 1, 2]), np.array([0, 3, 0])
    program.run({"pairs": 3}, x=x, y=y, i=i, j=j)
    np.testing.assert_array_equal(y[:, 0], [122, 1, 1, 11])
    with pytest.raises(InputError, match="list of rows 'j' names row 4; region 'y' has rows 0 to 3"):
        program.run({"pairs": 3}, x=x, y=y, i=i, j=np.array([0, 3, 4]))


UNSOUND: list[tuple[Callable[[], Loop], str]] = [
    (lambda: Loop(1, [Stage(same, ("x",), ("x",))], views=(View("y", "x", "i"),)), "only be used inside the loop"),
    (lambda: Loop(1, [], ("x",), views=(View("y", "w", "i"),)), "no region is named 'w'"),
    (lambda: Loop(1, [], ("x",), views=(View("x", "x", "i"),)), "names that nothing else has"),
    (lambda: Loop(1, [], ("x",), views=(View("y", "x", "x"),)), "names that nothing else has"),
    (lambda: Loop(1, [], ("x",), views=(View("y", "x", "y"),)), "names that nothing else has"),
    (lambda: Loop(1, [], ("x",), views=(View("y", "x", "i"), View("y", "x", "j"))), "names that nothing else has"),
    (lambda: Loop(1, [Loop(1, [], ("x",), views=(View("y", "x", "i"),)), Stage(same, ("y",), ("y",))]), "only be used"),
    (lambda: Loop(1, [Stage(same, ("y",), ("y",))], ("x",)), "no region is named 'y'"),
    (lambda: Loop(1, [Stage(same, ("z",), ("y",))], ("x",), views=(View("y", "x", "i"),)), "there are: 'x', 'y'"),
    (lambda: Loop(1, [], ("x",), "y", views=(View("y", "x", "i"),)), "no region is named 'y'"),
]


@pytest.mark.parametrize("case", range(len(UNSOUND)))
def test_unsound_views_are_explained(case: int) -> None:
    loop, message = UNSOUND[case]
    with pytest.raises(InputError) as caught:
        compile_program(loop(), [Region("x", 1)])
    assert message in str(caught.value)

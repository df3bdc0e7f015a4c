"""Loops that go through like things lane by lane, on memory where other stages take them side by side."""

import threading
from typing import Any

import numpy as np
import pytest

from cutpoint.errors import InputError
from cutpoint.kernels import LaneLoop, Loop, Program, Region, Stage, View, compile_program
from cutpoint.kernels.arrays.fastcall import Front
from cutpoint.kernels.programs.front import front_of
from cutpoint.kernels.programs.outputs import whole
from cutpoint.scalars import sin

BACKENDS = ("llvm", "numpy")
LANES = 4


def alone(x: Any) -> Any:
    return [sin(x[0]), x[1] * x[1]]


def outward(own: Any, total: Any, above: Any) -> Any:
    return [above[0] / 2 + own[0], total[1]]


def inward(total: Any, borne: Any) -> Any:
    return [borne[0], borne[1] + total[0]]


def program(backend: str) -> Program:
    """Of a tree's nodes: what each has alone, half of the parent's total more outward, totals summed up inward."""
    views = (View("above", "total", "parents"), View("borne", "total", "parents"))
    names = ("x", "own", "total")
    passes = [
        Loop("blocks", [Stage(alone, ("x",), ("own",), LANES)], names),
        LaneLoop("nodes", [Stage(outward, ("own", "total", "above"), ("total",))], names, views=views),
        LaneLoop("nodes", [Stage(inward, ("total", "borne"), ("borne",))], names, backward=True, views=views),
    ]
    return compile_program(Loop(1, passes), [Region(name, 2 * LANES, LANES) for name in names], backend)


def plainly(parents: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The same with plain loops: (n + 1, 2); the last row is the world's."""
    n = len(parents)
    total = np.zeros((n + 1, 2))
    for i in range(n):
        total[i, 0] = total[parents[i], 0] / 2 + np.sin(x[i, 0])
    for i in reversed(range(n)):
        total[parents[i], 1] += total[i, 0]
    return total


def memory(n: int, x: np.ndarray) -> dict[str, np.ndarray]:
    blocks = n // LANES + 1
    arrays = {name: np.zeros((blocks, 2, LANES)) for name in ("x", "own", "total")}
    for i in range(n):
        arrays["x"][i // LANES, :, i % LANES] = x[i]
    return {name: array.reshape(blocks, 2 * LANES) for name, array in arrays.items()}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("n", [1, 3, 4, 9, 31])
def test_lane_by_lane_is_row_by_row(backend: str, n: int) -> None:
    rng = np.random.default_rng(n)
    parents, x = np.array([n if i == 0 else rng.integers(0, i) for i in range(n)], np.int64), rng.normal(size=(n, 2))
    arrays = memory(n, x)
    program(backend).run({"blocks": -(-n // LANES), "nodes": n}, parents=parents, **arrays)
    found = arrays["total"].reshape(-1, 2, LANES).swapaxes(1, 2).reshape(-1, 2)
    expected = plainly(parents, x)
    np.testing.assert_allclose(
        found[: n + 1], expected, rtol=0, atol=4 * n * np.finfo(float).eps * np.abs(expected).max()
    )
    assert not found[n + 1 :].any()


def test_rows_that_lanes_need_are_counted() -> None:
    arrays, run = memory(9, np.ones((9, 2))), program("llvm").run
    counts = {"blocks": 3, "nodes": 9}
    with pytest.raises(InputError, match=r"region 'own' streams: .* at least 3 rows of 8"):
        run(counts, parents=np.zeros(9, np.int64), **(arrays | {"own": np.zeros((2, 8))}))
    with pytest.raises(InputError, match=r"names row 12; region 'total' has rows 0 to 11"):
        run(counts, parents=np.full(9, 12), **arrays)
    with pytest.raises(InputError, match=r"region 'x' streams: .* at least 4 rows of 8"):
        run({"blocks": 3, "nodes": 13}, parents=np.zeros(13, np.int64), **arrays)


def test_stages_that_see_lanes_and_rows_are_refused() -> None:
    single = Stage(lambda x: x, ("x",), ("x",))
    with pytest.raises(InputError, match=r"uses x lane by lane: it must be of one lane"):
        compile_program(LaneLoop(1, [Stage(lambda x: x, ("x",), ("x",), LANES)], ("x",)), [Region("x", 8, LANES)])
    with pytest.raises(InputError, match=r"uses x lane by lane: .* do so in every loop that holds it"):
        both = Loop(1, [LaneLoop(1, [single], ("x",)), Loop(1, [single], ("x",))])
        compile_program(both, [Region("x", 8, LANES)])
    with pytest.raises(InputError, match=r"view 'y' by 'i': both must have names"):
        view = (View("y", "x", "i"),)
        compile_program(
            Loop(1, [LaneLoop(1, [], ("x",), views=view), Loop(1, [], ("x",), views=view)]), [Region("x", 8, 4)]
        )


def test_a_front_takes_vectors_and_gives_its_callers_their_own() -> None:
    n = 9
    arrays, parents = memory(n, np.ones((n, 2))), np.array([n, *range(n - 1)])
    run = program("llvm").bound({"blocks": 3, "nodes": n}, parents=parents, **arrays)
    own = {"x": arrays["x"].reshape(-1)[:4]}, {"total": whole(arrays["total"].reshape(-1)[:4])}
    front = front_of(run, "walk", *own, Front(lambda *given: ("general", *given), largest=1e15))
    x = np.array([0.1, 0.2, 0.3, 0.4])
    first = front(x)
    kept = first.copy()
    assert front(x + 1) is not first and (first == kept).all() and not (front(x + 1) == kept).all()
    halves = [0.5**k for k in range(4)]
    np.testing.assert_allclose(first, np.convolve(np.sin(x), halves)[:4], rtol=0, atol=1e-15)
    assert front([1.0])[0] == front(x * np.nan)[0] == "general"


def test_fronts_called_from_threads_do_not_meet() -> None:
    n = 9
    arrays, parents = memory(n, np.ones((n, 2))), np.array([n, *range(n - 1)])
    run = program("llvm").bound({"blocks": 3, "nodes": n}, parents=parents, **arrays)
    own = {"x": arrays["x"].reshape(-1)[:4]}, {"total": whole(arrays["total"].reshape(-1)[:4])}
    front = front_of(run, "walk", *own, Front(lambda *given: None))
    inputs = np.random.default_rng(0).normal(size=(4, 4))
    expected, wrong = [front(x) for x in inputs], []

    def work(k: int) -> None:
        wrong.extend(k for _ in range(500) if not np.array_equal(front(inputs[k]), expected[k]))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong

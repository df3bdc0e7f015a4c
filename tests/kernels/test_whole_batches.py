"""Contiguous batches bypass NumPy's machinery without a visible difference; all others use it."""

import sys
import tracemalloc
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from cutpoint import InputError
from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.arrays import gufunc, whole_batches
from cutpoint.scalars import sin

RNG = np.random.default_rng(17)
SHAPES = ((3,), (), (2, 2))
COUNT = 5


class Found(NamedTuple):
    column: Any
    number: Any


def law(q: Any, t: Any, M: Any) -> Found:
    return Found([x * t + M[0][1] for x in q], sin(t) / M[1][0] + q[2])


@pytest.fixture(params=[np.float64, np.float32], ids=["double", "single"])
def kernel(request: pytest.FixtureRequest) -> Kernel:
    made = compile(law, q=3, t=(), M=(2, 2), backend="llvm")
    return made if request.param is np.float64 else made.float32


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether each batch from now on went without NumPy's machinery."""
    seen: list[bool] = []

    def made(*arguments: Any, **named: Any) -> Callable[..., Any]:
        run = whole_batches.whole_batches(*arguments, **named)
        assert run is not None

        def counted(arguments: Any, out: Any) -> Any:
            found = run(arguments, out)
            seen.append(found is not None)
            return found

        return counted

    monkeypatch.setattr(gufunc, "whole_batches", made)
    return seen


def batch(kernel: Kernel, count: int = COUNT) -> list[np.ndarray]:
    return [RNG.normal(size=(count, *shape)).astype(kernel.graph.precision.dtype) for shape in SHAPES]


def empty(kernel: Kernel, count: int = COUNT) -> tuple[np.ndarray, ...]:
    return tuple(np.full((count, *p.shape), 7.0, kernel.graph.precision.dtype) for p in kernel.graph.outputs)


def one_by_one(kernel: Kernel, rows: list[np.ndarray]) -> list[np.ndarray]:
    found = [kernel(*row) for row in zip(*rows, strict=True)]
    return [np.stack(column) for column in zip(*found, strict=True)]


def assert_same(found: Any, expected: Any) -> None:
    for x, y in zip(found, expected, strict=True):
        assert (x.shape, x.dtype) == (y.shape, y.dtype)
        assert x.tobytes() == y.tobytes()


def test_what_is_whole_goes_the_short_way(runs: list[bool], kernel: Kernel) -> None:
    rows = batch(kernel)
    found, targets = kernel(*rows), empty(kernel)
    into = kernel(*rows, out=targets)
    assert runs == [True, True] and type(found) is type(into) is type(kernel(*(x[0] for x in rows)))
    assert all(x is y for x, y in zip(into, targets, strict=True))
    for x in found, into:
        assert_same(x, one_by_one(kernel, rows))


def test_blocks_that_are_whole_go_the_short_way(runs: list[bool], kernel: Kernel) -> None:
    rows = batch(kernel, 21)
    blocks = kernel.blocks
    found = blocks(*map(blocks.of, rows))
    targets = tuple(np.empty_like(x) for x in found)
    assert blocks(*map(blocks.of, rows), out=targets)[0] is targets[0]
    assert runs == [True, True]
    for x in found, targets:
        assert_same(blocks.rows(x, 21), one_by_one(kernel, rows))


def test_earlier_results_may_be_filled_again(runs: list[bool], kernel: Kernel) -> None:
    first, second = batch(kernel), batch(kernel)
    expected, found = kernel(*second), kernel(*first)
    again = kernel(*second, out=found)
    assert all(x is y for x, y in zip(again, found, strict=True)) and all(runs)
    assert_same(again, expected)
    assert_same(kernel(*first[:2], first[2][::-1][::-1], out=again, threads=2), kernel(*first))


@pytest.mark.parametrize(("place", "is_short"), [(0, False), (2, True)])
def test_all_elements_may_share_an_array(runs: list[bool], kernel: Kernel, place: int, is_short: bool) -> None:
    rows = batch(kernel)
    shared: list[Any] = [x[1] if k == place else x for k, x in enumerate(rows)]
    repeated = [np.repeat(x[1:2], COUNT, axis=0) if k == place else x for k, x in enumerate(rows)]
    assert_same(kernel(*shared), one_by_one(kernel, repeated))
    assert any(runs) == is_short
    assert_same(kernel(*shared, out=empty(kernel)), one_by_one(kernel, repeated))


@pytest.mark.parametrize(
    ("kind", "is_short"), [(float, True), (np.float64, True), (np.float32, False), (np.array, False), (int, False)]
)
def test_all_elements_may_share_a_number(runs: list[bool], kernel: Kernel, kind: Callable[..., Any], is_short: bool):
    t, dtype = kind(np.float32(-2.25)), kernel.graph.precision.dtype
    q, _, M = batch(kernel)
    assert_same(kernel(q, t, M), one_by_one(kernel, [q, np.full(COUNT, t, dtype), M]))
    assert any(runs) == (is_short and dtype == np.float64)


@pytest.mark.parametrize("text", ["2.25", b"2.25", None, [1.0, 2.0]])
def test_what_is_no_number_for_all_elements_is_told(kernel: Kernel, text: object) -> None:
    q, _, M = batch(kernel)
    with pytest.raises(InputError, match=r"^law: (t|leading axes do not broadcast)"):
        kernel(q, text, M)


def test_no_result_is_written_where_a_shared_array_lies(kernel: Kernel) -> None:
    rows, memory = batch(kernel), np.zeros((COUNT, 3), kernel.graph.precision.dtype)
    M = memory.reshape(-1)[-4:].reshape(2, 2)
    M[:] = rows[2][0]
    expected = kernel(rows[0], rows[1], M.copy())
    assert_same(kernel(rows[0], rows[1], M, out=(memory, empty(kernel)[1])), expected)


@pytest.mark.parametrize("given", [lambda out: out, lambda out: (out,)], ids=["array", "tuple"])
def test_a_result_alone_is_an_array(runs: list[bool], given: Callable[[np.ndarray], Any]) -> None:
    kernel = compile(lambda q: [x * x for x in q], q=3, backend="llvm")
    rows, target = RNG.normal(size=(COUNT, 3)), np.empty((COUNT, 3))
    assert kernel(rows, out=given(target)) is target
    assert np.array_equal(kernel(rows), rows * rows) and np.array_equal(target, rows * rows)
    assert runs[-1]


def overlapping(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    memory = np.empty((len(x) + 1, *x.shape[1:]), x.dtype)
    memory[:-1] = x
    return memory[:-1], memory[1:]


def test_results_may_lie_where_arguments_lie(runs: list[bool], kernel: Kernel) -> None:
    rows = batch(kernel)
    expected, targets = one_by_one(kernel, rows), empty(kernel)
    q, behind = overlapping(rows[0])
    found = kernel(q, *rows[1:], out=(behind, targets[1]))
    assert found[0] is behind
    assert_same(found, expected)
    assert_same(kernel(*rows, out=(rows[0], targets[1])), expected)
    assert runs[-2:] == [False, False]


class Odd(np.ndarray): ...


BROKEN: dict[str, Callable[[np.ndarray], Any]] = {
    "a list": lambda x: x.tolist(),
    "other precision": lambda x: x.astype(np.float32 if x.dtype == np.float64 else np.float64),
    "other byte order": lambda x: x.astype(x.dtype.newbyteorder()),
    "backwards": lambda x: x[::-1].copy()[::-1],
    "every second": lambda x: np.repeat(x, 2, axis=0)[::2],
    "one for all": lambda x: x[:1],
    "two axes of batch": lambda x: x[None],
    "a subclass": lambda x: x.view(Odd),
    "odd in memory": lambda x: np.frombuffer(b"." + x.tobytes(), np.uint8)[1:].view(x.dtype).reshape(x.shape),
}


@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("change", BROKEN.values(), ids=BROKEN)
def test_what_is_not_whole_gives_the_same(
    runs: list[bool], kernel: Kernel, change: Callable[[np.ndarray], Any], place: int
) -> None:
    rows: list[Any] = batch(kernel)
    rows[place] = change(rows[place])
    found = kernel(*rows)
    assert not any(runs)
    dtype = kernel.graph.precision.dtype
    plain = [np.asarray(x).astype(dtype) for x in rows]
    spread = [np.broadcast_to(x, (1, COUNT, *shape))[0] for x, shape in zip(plain, SHAPES, strict=True)]
    ours = [x.reshape(COUNT, *p.shape) for x, p in zip(found, kernel.graph.outputs, strict=True)]
    assert_same(ours, one_by_one(kernel, spread))


def test_an_empty_batch_has_empty_results(kernel: Kernel) -> None:
    found = kernel(*batch(kernel, 0))
    assert [x.shape for x in found] == [(0, 3), (0,)]


WRONG: dict[str, Callable[[list[np.ndarray], tuple[np.ndarray, ...]], Any]] = {
    "fewer": lambda rows, out: (rows[:2], None),
    "none": lambda rows, out: ([], None),
    "of another length": lambda rows, out: ([rows[0], rows[1][:2], rows[2]], None),
    "of another shape": lambda rows, out: ([rows[0][:, :2], *rows[1:]], None),
    "out too short": lambda rows, out: (rows, (out[0][:2], out[1])),
    "out alone": lambda rows, out: (rows, out[0]),
    "out of too many": lambda rows, out: (rows, (*out, out[0])),
    "out that is none": lambda rows, out: (rows, "no array"),
}


@pytest.mark.parametrize("change", WRONG.values(), ids=WRONG)
def test_what_does_not_fit_is_told(kernel: Kernel, change: Callable[..., Any]) -> None:
    arguments, out = change(batch(kernel), empty(kernel))
    with pytest.raises(InputError, match="law"):
        kernel(*arguments, out=out)


def test_what_may_not_be_written_to_is_left_alone(kernel: Kernel) -> None:
    targets = empty(kernel)
    targets[0].flags.writeable = False
    with pytest.raises(InputError, match="law: output array is read-only"):
        kernel(*batch(kernel), out=targets)
    assert (targets[0] == 7).all()


def test_calls_keep_and_lose_no_references(kernel: Kernel) -> None:
    rows, targets = batch(kernel), empty(kernel)
    held = [*rows, targets, *targets, None]

    def counts() -> list[int]:
        return [sys.getrefcount(x) for x in held[:-1]]

    kernel(*rows), kernel(*rows, out=targets)
    before = counts()
    for _ in range(100):
        found = kernel(*rows)
        kernel(*rows, out=targets)
        assert kernel.general(*rows[:2], rows[2][:1], out=targets) is not None
    assert counts() == before
    assert all(sys.getrefcount(x) == sys.getrefcount(np.empty(1)) + 2 for x in found)


def test_large_results_lie_together_and_are_arrays_of_their_own(kernel: Kernel) -> None:
    rows = batch(kernel, 9001)
    parts = [kernel(*(x[k : k + 100] for x in rows)) for k in range(0, 9001, 100)]
    for _ in range(3):
        found = kernel(*rows)
    assert_same(found, [np.concatenate(column) for column in zip(*parts, strict=True)])
    column, number = found
    memory, alone = column.base, sys.getrefcount(np.empty(1))
    held = sys.getrefcount(memory)
    assert held == alone + 3  # by its name and by two arrays
    assert number.base is memory and not np.shares_memory(column, number)
    assert all(type(x) is np.ndarray and x.flags.carray and x.ctypes.data % 64 == 0 for x in found)
    kept = number.copy()
    del found, column
    held = sys.getrefcount(memory)
    assert np.array_equal(number, kept) and held == alone + 2


def test_without_the_python_it_knows_numpy_does_the_work(kernel: Kernel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(whole_batches, "is_possible", lambda: False)
    fresh = compile(law, q=3, t=(), M=(2, 2), backend="llvm")
    fresh = fresh if kernel.graph.precision.dtype == np.float64 else fresh.float32
    rows = batch(kernel)
    assert_same(fresh(*rows), kernel(*rows))


LARGEST = 1e3
LONG = 2 * whole_batches._CHUNK + 77


@pytest.fixture(scope="module")
def guarded() -> tuple[Kernel, Callable[..., Any], np.ndarray]:
    """A kernel, its function for whole batches with the last input bound, and what is bound."""
    kernel, last = compile(law, q=3, t=(), M=(2, 2), backend="llvm"), RNG.normal(size=(2, 2))
    run = kernel.whole(bound=[last], largest=LARGEST)
    assert run is not None
    return kernel, run, last


@pytest.mark.parametrize("count", [0, 1, 7, 8, LONG - 77, LONG])
def test_what_is_bound_is_the_same_for_all(guarded: Any, count: int) -> None:
    kernel, run, last = guarded
    q, t = RNG.normal(size=(count, 3)), RNG.normal(size=count)
    assert_same(run((q, t), None), kernel(q, t, last))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1001.0, -1e300])
@pytest.mark.parametrize("place", [0, 1, 255, 256, LONG - 2, LONG - 1])
def test_no_work_is_done_on_numbers_out_of_bounds(guarded: Any, bad: float, place: int) -> None:
    _, run, _ = guarded
    for argument, where in ((0, (place, 2)), (0, (place, 0)), (1, (place,))):
        given = (RNG.uniform(-LARGEST, LARGEST, (LONG, 3)), RNG.uniform(-LARGEST, LARGEST, LONG))
        assert run(given, None) is not None
        given[argument][where] = np.copysign(LARGEST, bad)
        assert run(given, None) is not None
        given[argument][where] = bad
        assert run(given, None) is None


def test_refusals_keep_no_memory(guarded: Any) -> None:
    _, run, _ = guarded
    given = (np.full((LONG, 3), np.nan), np.zeros(LONG))
    run(given, None)
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    for _ in range(200):
        assert run(given, None) is None
    assert tracemalloc.get_traced_memory()[0] - before < 10_000
    tracemalloc.stop()


def test_what_cannot_be_bound_is_told() -> None:
    kernel = compile(law, q=3, t=(), M=(2, 2), backend="llvm")
    for wrong in (np.zeros((2, 3)), np.zeros((2, 2), np.float32), np.zeros((2, 4))[:, ::2]):
        with pytest.raises(InputError, match="bound to M"):
            kernel.whole(bound=[wrong])

"""Threads: results are bitwise independent of their number."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest

from cutpoint import InputError
from cutpoint.kernels import Kernel, compile, graph_of
from cutpoint.kernels.arrays import threads
from cutpoint.scalars import exp, sin

RNG = np.random.default_rng(7)


class Pair(NamedTuple):
    square: Any
    both: Any


def mixture(q: Any, k: Any) -> Any:
    return [exp(sin(q[0]) * k), q[1] / (1 + q[2] * q[2]), sin(q[1]) * k]


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Chunks of a few elements, so that small batches are shared."""
    monkeypatch.setattr(threads, "CHUNK", 1)
    yield


@pytest.fixture(params=["llvm", "numpy"])
def kernel(request: pytest.FixtureRequest) -> Kernel:
    return compile(mixture, q=3, k=(), backend=request.param)


@pytest.mark.parametrize("count", [1, 2, 3, 8])
@pytest.mark.parametrize("size", [0, 1, 7, 8, 9, 64, 1003])
def test_every_number_of_threads_gives_the_same_bits(kernel: Kernel, size: int, count: int) -> None:
    q, k = RNG.normal(size=(size, 3)), RNG.normal(size=size)
    assert kernel(q, k, threads=count).tobytes() == kernel(q, k).tobytes()
    blocks = compile(mixture, q=3, k=(), backend=kernel.backend).blocks
    if size:
        arguments = [*map(blocks.of, (q, k))]
        assert blocks(*arguments, threads=count).tobytes() == blocks(*arguments).tobytes()


def test_leading_axes_broadcast_as_ever(kernel: Kernel) -> None:
    q, k = RNG.normal(size=(5, 1, 3)), RNG.normal(size=70)
    for arguments in ((q, k), (q[0, 0], k), (np.moveaxis(q, 0, 1), 2.0), (q, k[:, None, None]), (q[0, 0], 1.0)):
        assert np.array_equal(kernel(*arguments, threads=2), kernel(*arguments))
        assert np.array_equal(kernel(q=arguments[0], k=arguments[1], threads=2), kernel(*arguments))


@pytest.mark.parametrize("count", [1, 3])
def test_one_array_in_a_tuple_is_filled_and_returned(kernel: Kernel, count: int) -> None:
    out = np.empty((300, 3))
    assert kernel(RNG.normal(size=(300, 3)), 1.0, threads=count, out=(out,)) is out


def test_lists_and_strided_arrays_are_taken_too(kernel: Kernel) -> None:
    q, k = RNG.normal(size=(300, 3)), RNG.normal(size=300)
    expected = kernel(q, k)
    assert np.array_equal(kernel(q.tolist(), [*k], threads=2), expected)
    assert np.array_equal(kernel(np.asfortranarray(q), k[::-1].copy()[::-1], threads=2), expected)


def test_out_is_filled(kernel: Kernel) -> None:
    q, k = RNG.normal(size=(300, 3)), RNG.normal(size=300)
    for out in (np.empty((300, 3)), np.empty((3, 300)).T, np.empty((300, 3), np.float32)):
        assert kernel(q, k, out=out, threads=2) is out
        assert np.array_equal(out, kernel(q, k).astype(out.dtype))


def test_out_may_overlap_an_input(kernel: Kernel) -> None:
    memory = RNG.normal(size=(301, 3))
    q, out = memory[:-1], memory[1:]
    expected = kernel(q.copy(), 0.5)
    kernel(q, 0.5, out=out, threads=2)
    assert np.array_equal(out, expected)


def test_several_outputs_come_as_without_threads() -> None:
    kernel = compile(lambda x: Pair(x * x, [x, -x]), name="pair", x=())
    x = RNG.normal(size=500)
    found, expected = kernel(x, threads=2), kernel(x)
    assert type(found) is type(expected)
    assert all(a.tobytes() == b.tobytes() for a, b in zip(found, expected, strict=True))


def run_in_two(call: Callable[[np.ndarray, np.ndarray, bool], None], x: np.ndarray) -> np.ndarray:
    """Two threads run call(part, part of the result, whether another thread is at it); both get a part."""
    meeting, seen, mine = threading.Barrier(2, timeout=20), set(), threading.get_ident()

    def met(part: np.ndarray, out: tuple[np.ndarray]) -> None:
        me = threading.get_ident()
        if me not in seen:
            seen.add(me)
            meeting.wait()
        call(part, out[0], me != mine)

    return threads.Threaded(graph_of(lambda x: x, x=()), 1, met)(2, [x], None)


def test_nothing_returns_before_the_last_thread_has_finished() -> None:
    def call(x: np.ndarray, out: np.ndarray, elsewhere: bool) -> None:
        time.sleep(0.05 * elsewhere)
        out[...] = 2 * x

    assert np.array_equal(run_in_two(call, np.arange(100.0)), 2 * np.arange(100.0))


@pytest.mark.parametrize("where", [False, True])
def test_an_error_on_any_thread_is_raised_when_all_have_stopped(where: bool) -> None:
    running = []

    def call(x: np.ndarray, out: np.ndarray, elsewhere: bool) -> None:
        if elsewhere == where:
            raise ValueError("no")
        running.append(1)
        time.sleep(0.02)
        running.pop()

    with pytest.raises(ValueError, match="no"):
        run_in_two(call, np.arange(100.0))
    assert not running


def test_what_does_not_fit_is_explained_as_ever(kernel: Kernel) -> None:
    with pytest.raises(InputError, match=r"q has shape \(100, 2\): its last axis must be 3"):
        kernel(np.zeros((100, 2)), 0.0, threads=2)
    with pytest.raises(InputError, match=r"leading axes do not broadcast"):
        kernel(np.zeros((100, 3)), np.zeros(99), threads=2)
    with pytest.raises(InputError, match=r"out for .* has shape \(99, 3\)"):
        kernel(np.zeros((100, 3)), 0.0, out=np.zeros((99, 3)), threads=2)


@pytest.mark.parametrize("wrong", [0, -1, 1.5, "2", np.zeros(3)])
def test_the_number_of_threads_is_a_whole_number_from_1(kernel: Kernel, wrong: Any) -> None:
    with pytest.raises(InputError, match=r"mixture: threads=.* must be a whole number from 1"):
        kernel(np.zeros((100, 3)), 0.0, threads=wrong)


def test_no_more_threads_are_started_than_there_are_parts(kernel: Kernel) -> None:
    q, k = RNG.normal(size=(64, 3)), RNG.normal(size=64)
    before = threading.active_count()
    found = kernel(q, k, threads=100_000)
    assert found.tobytes() == kernel(q, k).tobytes()
    assert threading.active_count() - before < 64 // 16

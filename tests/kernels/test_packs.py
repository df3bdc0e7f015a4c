"""Packs: long batches run many elements at once, and nobody can tell from the numbers."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st

from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.arrays import packs
from cutpoint.kernels.arrays.strided import WORTH_MAKING
from cutpoint.kernels.machine import strided_loop
from cutpoint.kernels.machine.batch_loop import WORTH_MAKING_PACKS
from cutpoint.kernels.machine.jit import vector_width
from cutpoint.scalars import atan, exp, log, sin, tanh, where

WIDTH = vector_width()
LONG = 2 * WORTH_MAKING_PACKS + 3
SIZES = [*range(3 * WIDTH + 2), WORTH_MAKING_PACKS - 1, WORTH_MAKING_PACKS, LONG]
RNG = np.random.default_rng(5)
SHAPES = ((7,), (), (3, 4))


def every_kind(q: Any, v: Any, M: Any) -> Any:
    """Outputs that are computed, constant, and inputs as they came."""
    column = [where(sin(x) < v, exp(x) / (1 + x * x), -tanh(x * v)) for x in q]
    return [[*column, 2.5, M[i][3], -0.0, log(M[i][0] * M[i][0] + v * v) + atan(q[i])] for i in range(3)]


def batch(size: int) -> list[np.ndarray]:
    return [RNG.normal(size=(size, *shape)) for shape in SHAPES]


def one_by_one(kernel: Kernel, arguments: list[np.ndarray]) -> np.ndarray:
    return np.array([kernel(*[a[k] for a in arguments]) for k in range(len(arguments[0]))])


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    """With packs already made."""
    made = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm")
    made(*batch(LONG))
    return made


@pytest.mark.parametrize("size", SIZES)
def test_every_size_of_batch_gives_the_bits_of_single_calls(kernel: Kernel, size: int) -> None:
    arguments = batch(size)
    expected = one_by_one(kernel, arguments)
    assert kernel(*arguments).tobytes() == expected.tobytes()


@pytest.mark.parametrize("size", [WORTH_MAKING_PACKS - 1, WORTH_MAKING_PACKS, LONG])
def test_the_batch_that_makes_packs_gives_the_bits_of_single_calls(size: int) -> None:
    fresh = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm")
    arguments = batch(size)
    assert fresh(*arguments).tobytes() == one_by_one(fresh, arguments).tobytes()


@given(st.lists(steps, min_size=1, max_size=25), st.integers(0, 2**32))
@settings(max_examples=20)
def test_packs_do_exactly_what_single_calls_do(recipe: list[Step], seed: int) -> None:
    kernel = compile(lambda x: cook(recipe, x), x=3, backend="llvm")
    x = np.random.default_rng(seed).uniform(-3, 3, (WORTH_MAKING_PACKS + 1, 3))
    assert kernel(x).tobytes() == one_by_one(kernel, [x]).tobytes()


def test_numbers_that_are_zero_tiny_huge_or_not_finite_are_no_special_case() -> None:
    def function(x: Any, y: Any) -> Any:
        return [x + y, x / y, sin(x), exp(x), log(x), atan(y), tanh(x), where((x < y) | ~(x <= 1), x, y)]

    kernel = compile(function, x=(), y=(), backend="llvm")
    odd = np.array([0.0, -0.0, 5e-324, 1e-310, 1.0, -1.0, 1e5, 1e16, 1e308, -1e308, np.inf, -np.inf, np.nan])
    x, y = (side.ravel() for side in np.meshgrid(odd, odd))
    np.testing.assert_array_equal(kernel(x, y), one_by_one(kernel, [x, y]))


STRIDES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "every second": lambda x: np.repeat(x, 2, axis=0)[::2],
    "backwards": lambda x: x[::-1].copy()[::-1],
    "first of a wide row": lambda x: np.concatenate([x[:, None]] * 3, axis=1)[:, 0],
    "in Fortran's order": np.asfortranarray,
    "batch last": lambda x: np.moveaxis(np.moveaxis(x, 0, -1).copy(), -1, 0),
    "last axis of a pair": lambda x: np.stack([x, x], axis=-1)[..., 1],
    "all axes backwards": lambda x: x[(slice(None, None, -1),) * x.ndim].copy()[(slice(None, None, -1),) * x.ndim],
    "as it comes": lambda x: x,
}


@pytest.mark.parametrize("view", STRIDES.values(), ids=STRIDES)
def test_strides_change_no_bit(kernel: Kernel, view: Callable[[np.ndarray], np.ndarray]) -> None:
    arguments = batch(LONG)
    expected = one_by_one(kernel, arguments)
    out = view(np.zeros_like(expected))
    assert kernel(*map(view, arguments), out=out) is out
    assert np.array_equal(out, expected)


@pytest.mark.parametrize("size", [WORTH_MAKING, WORTH_MAKING + 1, 2 * WORTH_MAKING - 1])
@pytest.mark.parametrize("odd", range(len(SHAPES) + 1))
def test_one_strided_argument_among_tidy_ones_changes_no_bit(kernel: Kernel, odd: int, size: int) -> None:
    arguments = batch(size)
    expected = one_by_one(kernel, arguments)
    out = np.zeros_like(expected)
    sides = [*arguments, out]
    sides[odd] = STRIDES["last axis of a pair"](sides[odd])
    kernel(*sides[:-1], out=sides[-1])
    assert np.array_equal(sides[-1], expected)


def test_only_long_batches_of_strided_elements_make_a_loop_for_them(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    real = strided_loop.strided_loop
    monkeypatch.setattr(strided_loop, "strided_loop", lambda *given: made.append(given) or real(*given))
    kernel = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm")
    tidy, short = batch(LONG), [np.asfortranarray(x) for x in batch(WORTH_MAKING - 1)]
    for arguments in (tidy, short, [np.repeat(x, 2, axis=0)[::2] for x in tidy], [x.astype(np.float32) for x in tidy]):
        kernel(*arguments)
    assert not made
    for _ in range(2):
        kernel(*map(np.asfortranarray, tidy))
        assert len(made) == 1


def test_axes_of_length_1_change_no_bit() -> None:
    kernel = compile(lambda x, M: [[sin(x[0]) * M[0][i][0]] for i in range(2)], x=1, M=(1, 2, 1), backend="llvm")
    arguments = [RNG.normal(size=(LONG, *shape)) for shape in ((1,), (1, 2, 1))]
    assert kernel(*arguments).tobytes() == one_by_one(kernel, arguments).tobytes()


def test_strided_rows_of_a_grid_shorter_than_a_pack_change_no_bit(kernel: Kernel) -> None:
    arguments = [np.asfortranarray(RNG.normal(size=(LONG, 3, *shape))) for shape in SHAPES]
    flat = [np.ascontiguousarray(x).reshape(-1, *shape) for x, shape in zip(arguments, SHAPES, strict=True)]
    assert kernel(*arguments).tobytes() == one_by_one(kernel, flat).tobytes()


@pytest.mark.parametrize("fixed", range(len(SHAPES)))
def test_a_strided_argument_may_be_the_same_for_the_whole_batch(kernel: Kernel, fixed: int) -> None:
    arguments = [np.asfortranarray(x) for x in batch(LONG)]
    arguments[fixed] = arguments[fixed][0]
    whole = [np.broadcast_to(a, (LONG, *shape)) for a, shape in zip(arguments, SHAPES, strict=True)]
    assert kernel(*arguments).tobytes() == one_by_one(kernel, whole).tobytes()


@pytest.mark.parametrize("fixed", range(len(SHAPES)))
def test_an_argument_may_be_the_same_for_the_whole_batch(kernel: Kernel, fixed: int) -> None:
    arguments = batch(LONG)
    arguments[fixed] = arguments[fixed][0]
    whole = [np.broadcast_to(a, (LONG, *shape)) for a, shape in zip(arguments, SHAPES, strict=True)]
    assert kernel(*arguments).tobytes() == one_by_one(kernel, whole).tobytes()


def test_an_argument_may_change_from_one_row_of_a_grid_to_the_next(kernel: Kernel) -> None:
    q, v, M = batch(3)[0][:, None], batch(LONG)[1], batch(3)[2][:, None]
    found = kernel(q, v, M)
    for k in range(3):
        spread = [np.repeat(q[k], LONG, axis=0), v, np.repeat(M[k], LONG, axis=0)]
        assert found[k].tobytes() == one_by_one(kernel, spread).tobytes()


def test_nothing_is_written_beyond_the_results(kernel: Kernel) -> None:
    around = np.full((LONG + 2, 3, 11), 7.0)
    kernel(*batch(LONG), out=around[1:-1])
    assert (around[[0, -1]] == 7).all()
    wide = np.full((LONG, 2, 3, 11), 7.0)
    kernel(*batch(LONG), out=wide[:, 0])
    assert (wide[:, 1] == 7).all()
    loose = np.full((LONG + 2, 3, 11, 2), 7.0)
    kernel(*batch(LONG), out=loose[1:-1, ..., 0])
    assert (loose[[0, -1]] == 7).all()
    assert (loose[..., 1] == 7).all()


def test_out_may_be_an_input_that_packs_read() -> None:
    kernel = compile(lambda x: [x[2], x[0] * x[1], x[1]], x=3, backend="llvm")
    x = RNG.normal(size=(LONG, 3))
    expected = one_by_one(kernel, [x])
    kernel(x, out=x)
    assert np.array_equal(x, expected)


def test_many_threads_may_ask_for_packs_at_once() -> None:
    kernel = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm")
    arguments = batch(LONG)
    expected, found = one_by_one(kernel, arguments), [np.empty((LONG, 3, 11)) for _ in range(8)]
    threads = [threading.Thread(target=lambda out=out: kernel(*arguments, out=out)) for out in found]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(out.tobytes() == expected.tobytes() for out in found)


def test_a_kernel_too_wide_for_packs_takes_long_batches_all_the_same() -> None:
    kernel = compile(lambda x: [x[0] * x[-1], sin(x[1])], x=5000, backend="llvm")
    x = RNG.normal(size=(WORTH_MAKING_PACKS, 5000))
    assert kernel(x).tobytes() == one_by_one(kernel, [x]).tobytes()
    assert kernel(np.asfortranarray(x)).tobytes() == kernel(x).tobytes()


@pytest.mark.parametrize("width", [2, 4, 8])
def test_every_width_of_packs_gives_the_bits_of_single_calls(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cutpoint.kernels.arrays.packs.vector_width", lambda: width)
    kernel = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm")
    arguments = batch(LONG)
    assert kernel(*arguments).tobytes() == one_by_one(kernel, arguments).tobytes()
    assert kernel(*map(np.asfortranarray, arguments)).tobytes() == kernel(*arguments).tobytes()


def test_packs_that_cannot_be_made_are_told_of_once_and_done_without(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise RuntimeError("no memory for code")

    monkeypatch.setattr(packs, "pack_loop", fails)
    kernel = compile(lambda q: q * q + 1.2345678, name="unpacked", q=())
    q = np.linspace(-1.0, 1.0, LONG)
    with pytest.warns(UserWarning, match=r"unpacked: batches run element by element, .*: no memory for code") as caught:
        first = kernel(q)
    assert len(caught) == 1 and np.array_equal(first, kernel(q)) and np.array_equal(first[:1], [kernel(q[0])])

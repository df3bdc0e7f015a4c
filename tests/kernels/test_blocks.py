"""Blocks: batches kept as lanes give the bits of rows."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from cutpoint import InputError
from cutpoint.kernels import Kernel, compile
from cutpoint.scalars import atan, exp, sin, where

RNG = np.random.default_rng(6)
SHAPES = ((7,), (), (3, 4))


class Found(NamedTuple):
    column: Any
    number: Any
    table: Any


def every_kind(q: Any, v: Any, M: Any) -> Found:
    """Outputs of every rank: computed, constant, and inputs as they came."""
    column = [where(sin(x) < v, exp(x) / (1 + x * x), -x) for x in q]
    return Found([*column, 2.5], atan(v) * M[0][0], [[M[i][0], -0.0, M[i][1] * q[i]] for i in range(3)])


@pytest.fixture(scope="module", params=["llvm", "numpy", "narrow", "too large for packs", "past the caches"])
def kernel(request: pytest.FixtureRequest) -> Kernel:
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "narrow":
            patch.setattr("cutpoint.kernels.arrays.packs.vector_width", lambda: 2)
        if request.param == "too large for packs":
            patch.setattr("cutpoint.kernels.arrays.packs._MOST_NODES", 0)
        if request.param == "past the caches":
            patch.setattr("cutpoint.kernels.machine.block_loop.BEYOND_CACHES", -1)
        made = compile(every_kind, q=7, v=(), M=(3, 4), backend="numpy" if request.param == "numpy" else "llvm")
        assert made.blocks.width == 2 or request.param != "narrow"
    return made


def batch(size: int) -> list[np.ndarray]:
    return [RNG.normal(size=(size, *shape)) for shape in SHAPES]


@pytest.mark.parametrize("size", [1, 2, 7, 8, 9, 16, 203])
def test_blocks_give_the_bits_of_rows(kernel: Kernel, size: int) -> None:
    rows = batch(size)
    found = kernel.blocks(*map(kernel.blocks.of, rows))
    assert type(found) is type(kernel(*rows))
    for x, expected in zip(found, kernel(*rows), strict=True):
        assert kernel.blocks.rows(x, size).tobytes() == expected.tobytes()


@pytest.mark.parametrize("shape", [*SHAPES, (0,)])
@pytest.mark.parametrize("size", [1, 5, 8, 17])
def test_rows_become_blocks_and_rows_again(kernel: Kernel, size: int, shape: tuple[int, ...]) -> None:
    rows = RNG.normal(size=(size, *shape))
    blocks = kernel.blocks.of(rows)
    assert blocks.shape == (-(-size // kernel.blocks.width), *shape, kernel.blocks.width)
    assert np.array_equal(kernel.blocks.rows(blocks, size), rows)
    assert np.isfinite(blocks).all()


def test_what_is_the_same_for_all_is_given_once(kernel: Kernel) -> None:
    q, _, M = batch(16)
    blocks = kernel.blocks
    found = blocks(blocks.of(q), v=np.array([0.5]), M=M[0][..., None])
    for x, expected in zip(found, kernel(q, 0.5, M[0]), strict=True):
        assert blocks.rows(x, 16).tobytes() == expected.tobytes()


def test_blocks_may_lie_anywhere(kernel: Kernel) -> None:
    rows, blocks = batch(24), kernel.blocks
    tidy = [*map(blocks.of, rows)]
    expected = blocks(*tidy)
    for view in (np.asfortranarray, lambda x: np.stack([x, x], axis=1)[:, 1], lambda x: x[::-1].copy()[::-1]):
        for x, wanted in zip(blocks(*map(view, tidy)), expected, strict=True):
            assert np.array_equal(x, wanted)


def test_out_is_filled_and_nothing_else(kernel: Kernel) -> None:
    blocks = kernel.blocks
    arguments = [*map(blocks.of, batch(24))]
    expected = blocks(*arguments)
    around = [np.full((len(x), 3, *x.shape[1:]), 7.0) for x in expected]
    out = tuple(x[:, 1] for x in around)
    found = blocks(*arguments, out=out)
    for x, y, wanted, whole in zip(found, out, expected, around, strict=True):
        assert x is y
        assert np.array_equal(y, wanted)
        assert (whole[:, ::2] == 7).all()


def test_out_may_begin_where_vectors_do(kernel: Kernel) -> None:
    blocks = kernel.blocks
    arguments = [*map(blocks.of, batch(24))]
    expected = blocks(*arguments)
    out = tuple(blocks.of(np.zeros((24, *x.shape[1:-1]))) for x in expected)
    for x, wanted in zip(blocks(*arguments, out=out), expected, strict=True):
        assert np.array_equal(x, wanted)


@pytest.mark.parametrize("limit", [-1, 2**60])
@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_out_may_be_an_input(backend: str, limit: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cutpoint.kernels.machine.block_loop.BEYOND_CACHES", limit)
    kernel = compile(lambda x: [x[2], x[0] * x[1], x[1]], x=3, backend=backend)
    rows = RNG.normal(size=(40, 3))
    x = kernel.blocks.of(rows)
    assert kernel.blocks(x, out=x) is x
    assert np.array_equal(kernel.blocks.rows(x, 40), kernel(rows))


def test_a_single_block_and_a_grid_of_blocks_are_batches_too(kernel: Kernel) -> None:
    rows, blocks = batch(6 * kernel.blocks.width), kernel.blocks
    arguments = [*map(blocks.of, rows)]
    flat = blocks(*arguments)
    grid = blocks(*(x.reshape(2, 3, *x.shape[1:]) for x in arguments))
    one = blocks(*(x[4] for x in arguments))
    for x, y, z in zip(flat, grid, one, strict=True):
        assert x.tobytes() == y.tobytes()
        assert np.array_equal(z, x[4])


def test_lists_and_single_numbers_are_spread() -> None:
    blocks = compile(lambda q, s: [q[0] * s, q[1]], q=2, s=(), backend="llvm").blocks
    assert np.array_equal(blocks([[[1.0], [2.0]]], 3.0), np.array([[[3.0], [2.0]]]) * np.ones(blocks.width))


def test_overflow_in_blocks_warns_nobody() -> None:
    kernel = compile(lambda x, y: [x * x, x / y], x=(), y=(), backend="llvm")
    x = kernel.blocks.of(np.full(20, 1e300))
    assert np.isinf(kernel.blocks(x, np.zeros_like(x))).all()


def test_what_does_not_fit_is_explained() -> None:
    kernel = compile(lambda x: [x[0], x[1]], name="pair", x=2, backend="llvm")
    blocks, width = kernel.blocks, kernel.blocks.width
    good = np.zeros((3, 2, width))
    for wrong in (np.zeros((3, 2)), np.zeros((3, 2, width + 1)), np.zeros((3, 4, width))):
        with pytest.raises(InputError, match=rf"pair: x has shape .*: its last axes must be \(2, {width}\)"):
            blocks(wrong)
    with pytest.raises(InputError, match=r"pair: x missing"):
        blocks()
    with pytest.raises(InputError, match=r"pair: out for .* has shape"):
        blocks(good, out=np.zeros((2, 2, width)))
    with pytest.raises(InputError, match=r"pair: blocks of out for .* must be C-contiguous"):
        blocks(good, out=np.asfortranarray(good))
    with pytest.raises(InputError, match=r"pair: an array of shape \(\) has no rows"):
        blocks.of(np.float64(2.0))
    assert blocks.rows(blocks(blocks.of(np.zeros((0, 2)))), 0).shape[0] == 0
    for array, count in ((good, 3 * width + 1), (good[..., 1:], 1), (np.zeros(width), 1)):
        with pytest.raises(InputError, match=rf"pair: .* must be \(blocks, \.\.\., {width}\) with at least"):
            blocks.rows(array, count)
    wrong_counts: list[Any] = [-1, 1.5, None]
    for count in wrong_counts:
        with pytest.raises(InputError, match=rf"pair: count={count} of rows must be a whole number from 0"):
            blocks.rows(good, count)
    with pytest.raises(InputError, match=r"only kernels with inputs take blocks"):
        _ = compile(lambda: [1.0], name="constant").blocks


def test_several_outputs_become_rows_at_once(kernel: Kernel) -> None:
    rows = batch(11)
    blocks = kernel.blocks
    found = blocks.rows(blocks(*map(blocks.of, rows)), 11)
    assert type(found) is type(kernel(*rows))
    assert all(x.tobytes() == y.tobytes() for x, y in zip(found, kernel(*rows), strict=True))
    assert blocks.rows((blocks.of(rows[0]),), 11)[0].tobytes() == rows[0].tobytes()


def test_masked_numbers_are_refused_as_the_kernel_refuses_them() -> None:
    blocks = compile(lambda q: [2 * x for x in q], name="twice", q=3).blocks
    rows = np.ma.array(np.ones((2, 3)), mask=[[True, False, False], [False] * 3])
    with pytest.raises(InputError, match="twice: rows have masked numbers: fill them in"):
        blocks.of(rows)
    given = np.ma.array(np.ones((1, 3, blocks.width)), mask=False)
    assert (blocks(given) == 2.0).all()
    given[0, 0, 0] = np.ma.masked
    with pytest.raises(InputError, match="twice: q has masked numbers: fill them in"):
        blocks(given)
    with pytest.raises(InputError, match="twice: blocks have masked numbers: fill them in"):
        blocks.rows(given, 1)
    with pytest.raises(InputError, match="twice: rows must be an array of real numbers: <U1 is not a real number"):
        blocks.of([["a", "b", "c"]])

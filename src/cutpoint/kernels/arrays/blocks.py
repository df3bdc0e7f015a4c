"""Kernels on blocks: for batches stored as (blocks, *shape, width), which need no transposition."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import as_numbers
from cutpoint.kernels.arrays.array_call import Call
from cutpoint.kernels.arrays.block_function import block_function, wide
from cutpoint.kernels.arrays.function import Function
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.llvm_code import LINE
from cutpoint.kernels.machine.waiting import shown


class Blocks(Call):
    """A kernel on elements interleaved `width` at a time: an input of shape (n,) is given as (blocks, n, width).

    Leading axes are a batch of blocks and broadcast.  A last axis of length 1 is broadcast over the block, so that
    `parameters[:, None]` is the same for all.  Results equal those of rows to the last bit.

    Attributes:
        width: elements in a block: 8, 4 or 2, this processor's vector width in float64, or twice as many float32.
    """

    def __init__(self, name: str, graph: Graph, function: Function, record: type[tuple[Any, ...]] | None) -> None:
        if not graph.inputs:
            raise InputError(f"{name}: only kernels with inputs take blocks")
        with shown(f"{name} for blocks"):
            self._function = block_function(graph, name, function)
        self.width, self._whole = self._function.width, self._function.whole()
        ports = {"inputs": wide(graph.inputs, self.width), "outputs": wide(graph.outputs, self.width)}
        super().__init__(name, replace(graph, **ports), record, len(graph.nodes) * self.width)

    def __call__(self, *arguments: Any, out: Any = None, threads: int | None = None, **named: Any) -> Any:
        """The outputs, (..., *shape, width) each; called as the kernel is.

        Raises:
            InputError: an argument is missing, unknown, or of a shape or kind that does not fit; blocks in `out` are
                not C-contiguous.
        """
        if self._whole and threads is None and not named:
            found = self._whole(arguments, out)
            if found is not None:
                return found if self._make is None else self._made(found)
        return self._called(arguments, named, out, threads)

    def of(self, rows: Any) -> np.ndarray:
        """Blocks, (blocks, *shape, width), of an array of rows, (count, *shape); the last row pads the last block.

        Raises:
            InputError: a single number, masked entries or non-numbers.
        """
        array = self._numbers("rows", rows)
        if not array.ndim:
            raise InputError(f"{self._name}: an array of shape {array.shape} has no rows to make blocks of")
        blocks = _aligned((-(-len(array) // self.width), *array.shape[1:], self.width), self._graph.precision)
        full = len(array) // self.width
        blocks[:full] = np.moveaxis(array[: full * self.width].reshape(full, self.width, *array.shape[1:]), 1, -1)
        rest = array[full * self.width :]
        if len(rest):
            blocks[full] = array[-1][..., None]
            blocks[full, ..., : len(rest)] = np.moveaxis(rest, 0, -1)
        return blocks

    def rows(self, blocks: Any, count: int) -> Any:
        """The first count rows, (count, *shape), of blocks, (blocks, *shape, width): the inverse of `of`.

        For a tuple of blocks, as calls with several outputs return it, a tuple of rows.

        Raises:
            InputError: they are not blocks of this width, hold fewer rows, masked entries or non-numbers; the count is
                no whole number from 0.
        """
        if not isinstance(count, (int, np.integer)) or count < 0:
            raise InputError(f"{self._name}: count={count!r} of rows must be a whole number from 0", count=count)
        if isinstance(blocks, tuple):
            several = [self.rows(x, count) for x in blocks]
            return blocks._make(several) if hasattr(blocks, "_make") else tuple(several)  # type: ignore[attr-defined]
        array = self._numbers("blocks", blocks)
        if array.ndim < 2 or array.shape[-1] != self.width or count > len(array) * self.width:
            rule = f"it must be (blocks, ..., {self.width}) with at least {count} rows"
            raise InputError(f"{self._name}: an array of blocks has shape {array.shape}: {rule}")
        return np.moveaxis(array, -1, 1).reshape(len(array) * self.width, *array.shape[1:-1])[:count]

    def _numbers(self, what: str, given: Any) -> np.ndarray:
        if np.ma.is_masked(given):
            raise InputError(f"{self._name}: {what} have masked numbers: fill them in, or leave these out")
        try:
            return as_numbers(given, self._graph.precision)
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"{self._name}: {what} must be an array of real numbers: {error}") from None

    def _run(self, *arguments: Any, out: Any) -> Any:
        return self._function.call(*arguments, out=out)

    def _plain(self, arguments: Sequence[Any]) -> list[Any]:
        return [_spread(x, self.width) for x in super()._plain(arguments)]


def _spread(argument: Any, width: int) -> Any:
    """Numbers shared by a whole block, broadcast to its width."""
    try:
        array = np.atleast_1d(argument)
    except ValueError:  # explained elsewhere
        return argument
    return np.repeat(array, width, axis=-1) if array.shape[-1] == 1 else argument


def _aligned(shape: tuple[int, ...], precision: Precision) -> np.ndarray:
    """An array aligned to a cache line: vectors that straddle two lines take longer."""
    size = int(np.prod(shape)) * precision.item
    memory = np.empty(size + LINE, np.uint8)
    start = -memory.ctypes.data % LINE
    return memory[start : start + size].view(precision.dtype).reshape(shape)

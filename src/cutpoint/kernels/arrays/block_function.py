"""Execution of a graph on blocks: by machine code for blocks, or by any function of rows."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from cutpoint.kernels.arrays.function import Function, Whole
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, with_numbers

_USUAL_WIDTH = 8


class BlockFunction(Protocol):
    """A graph ready to run on blocks.

    call(*arrays, out=None): a NumPy generalised ufunc of axes (*shape, width).
    """

    width: int
    call: Callable[..., Any]

    def whole(self) -> Whole | None:
        """Makes `call` for whole batches, where that is supported."""


def block_function(graph: Graph, name: str, function: Function) -> BlockFunction:
    """function: the graph as a function of rows, the fallback where there is no machine code for packs."""
    if function.element is None:
        return RowsOfBlocks(graph, function)
    from cutpoint.kernels.arrays.packs import width_of_packs

    width = width_of_packs(graph, graph.inputs, graph.outputs)
    return MachineBlocks(graph, name, width) if width else RowsOfBlocks(graph, function)


class MachineBlocks:
    """Machine code that reads and writes blocks in place."""

    def __init__(self, graph: Graph, name: str, width: int) -> None:
        from cutpoint.kernels.arrays.gufunc import LoopGufunc
        from cutpoint.kernels.lowering.lower import lower
        from cutpoint.kernels.machine.block_loop import FUNCTION, block_loop

        self.width = width
        self._inputs, self._outputs = wide(graph.inputs, width), wide(graph.outputs, width)
        text = block_loop(lower(graph), with_numbers(graph.inputs), with_numbers(graph.outputs), width)
        self._gufunc = LoopGufunc(text, FUNCTION, graph.precision, self._inputs, self._outputs, name)

    def whole(self) -> Whole | None:
        return self._gufunc.whole()

    def call(self, *arguments: Any, out: Any = None) -> Any:
        """Inputs whose blocks are not C-contiguous are copied first."""
        arrays = [_tidy(p, np.asarray(x)) for p, x in zip(self._inputs, arguments, strict=True)]
        if out is None:
            return self._gufunc.call(*arrays)
        for port, target in zip(self._outputs, out if isinstance(out, tuple) else (out,), strict=False):
            if isinstance(target, np.ndarray) and _tidy(port, target) is not target:
                raise ValueError(f"blocks of out for {port.name} must be C-contiguous")
        return self._gufunc.call(*arrays, out=out)


class RowsOfBlocks:
    """A function of rows on views of blocks."""

    def __init__(self, graph: Graph, function: Function) -> None:
        self.width = _USUAL_WIDTH
        self._inputs, self._outputs, self._call = graph.inputs, graph.outputs, function.call

    def whole(self) -> None: ...

    def call(self, *arguments: Any, out: Any = None) -> Any:
        arrays = [_lane_first(p, np.asarray(x)) for p, x in zip(self._inputs, arguments, strict=True)]
        results = self._call(*arrays)
        found = results if isinstance(results, tuple) else (results,)
        blocks = [np.moveaxis(x, -1 - len(p.shape), -1) for p, x in zip(self._outputs, found, strict=True)]
        if out is None:
            made = [*map(np.ascontiguousarray, blocks)]
            return tuple(made) if len(made) > 1 else made[0]
        for target, x in zip(out if isinstance(out, tuple) else (out,), blocks, strict=True):
            if target.shape != x.shape:
                raise ValueError(f"out has shape {target.shape}: it must be {x.shape}")
            np.copyto(target, x, casting="same_kind")
        return out


def wide(ports: Sequence[Port], width: int) -> tuple[Port, ...]:
    """The ports of blocks."""
    return tuple(Port(p.name, (*p.shape, width)) for p in ports)


def _tidy(port: Port, x: np.ndarray) -> np.ndarray:
    """The array itself if its blocks are C-contiguous, or not blocks at all; otherwise a copy."""
    one = x[(0,) * (x.ndim - len(port.shape))] if x.size and x.ndim >= len(port.shape) else x
    return x if one.flags.c_contiguous else np.ascontiguousarray(x)


def _lane_first(port: Port, x: np.ndarray) -> np.ndarray:
    """Blocks as a batch of rows: the last axis moves before the port's own."""
    if x.ndim <= len(port.shape) or x.shape[-1] != _USUAL_WIDTH:
        raise ValueError(f"{port.name} has shape {x.shape}: its last axis must be {_USUAL_WIDTH}")
    return np.moveaxis(x, -1, -1 - len(port.shape))

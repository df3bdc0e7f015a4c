"""Long batches of elements that are not C-contiguous (Fortran order, every second column), also in packs.

The loop of every kernel reads such elements one by one, through scratch memory.  The one compiled here takes any
strides; it is slightly slower on C-contiguous elements, and most callers never need it.
"""

import sys
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, with_numbers
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.forks import new_lock
from cutpoint.kernels.machine.waiting import shown

WORTH_MAKING = 64
"""The shortest batch that goes this way: shorter ones gain less than compiling costs."""

_ARRAY = np.ndarray


class Strided:
    """A graph's loop over packs with any strides, compiled at first use."""

    def __init__(self, graph: Graph, name: str, otherwise: Callable[..., Any]) -> None:
        """otherwise: the fallback ufunc where the graph is too large for packs."""
        self._graph, self._name, self._otherwise = graph, name, otherwise
        self._inputs, self._outputs = ([_tidy(p, graph.precision) for p in x] for x in (graph.inputs, graph.outputs))
        self._item, self._lock = graph.precision.item, new_lock()
        self._made: Callable[..., Any] | None = None
        self._owner: Any = None  # owns the code that the ufunc runs

    def suits(self, arguments: Sequence[Any], out: Any) -> bool:
        """Whether a call benefits: elements of some long argument are not C-contiguous, or it is written to."""
        # an explicit loop for speed: all calls come here but single ones and contiguous batches
        for (size, own, strides), x in zip(self._inputs, arguments, strict=True):
            if type(x) is _ARRAY and x.size >= size and x.strides[own] != strides and self._is_broken(x, own, strides):
                return True
        if out is None:
            return False
        targets = out if isinstance(out, tuple) else (out,)
        for (size, own, strides), x in zip(self._outputs, targets, strict=False):
            if (
                type(x) is np.ndarray
                and x.size >= size
                and (self._is_broken(x, own, strides) or any(x is y for y in arguments))
            ):
                return True
        return False

    @property
    def call(self) -> Callable[..., Any]:
        """A generalised ufunc."""
        if self._made is None:
            with self._lock, shown(f"{self._name} for batches"):
                self._made = self._made or self._compiled()
        return self._made

    def _compiled(self) -> Callable[..., Any]:
        from cutpoint.kernels.arrays.gufunc import LoopGufunc
        from cutpoint.kernels.arrays.packs import width_of_packs
        from cutpoint.kernels.lowering.lower import lower
        from cutpoint.kernels.machine.strided_loop import FUNCTION, strided_loop

        graph, inputs, outputs = self._graph, self._graph.inputs, self._graph.outputs
        width = width_of_packs(graph, inputs, outputs)
        if width is None:
            return self._otherwise
        text = strided_loop(lower(graph), with_numbers(inputs), with_numbers(outputs), width)
        self._owner = LoopGufunc(text, FUNCTION, graph.precision, inputs, outputs, self._name)
        return self._owner.call

    def _is_broken(self, x: np.ndarray, own: slice, strides: tuple[int | None, ...]) -> bool:
        """Whether an element's numbers are further apart, or in another order, than in a C-contiguous one."""
        return x.strides[own] != tuple(n and n * x.itemsize // self._item for n in strides)


class _Tidy(NamedTuple):
    """Layout of long batches of a port's C-contiguous elements."""

    size: int
    own: slice
    strides: tuple[int | None, ...]


def _tidy(port: Port, precision: Precision) -> _Tidy:
    """How many numbers make a batch long, the port's own axes, and their strides in bytes."""
    # NumPy gives a ufunc's loop stride 0 along an axis of length 1: no strides match
    strides = (None,) * len(port.shape) if 1 in port.shape else np.empty(port.shape, precision.dtype).strides
    long = port.size * WORTH_MAKING or sys.maxsize
    return _Tidy(long, slice(-len(port.shape), None) if port.shape else slice(0), strides)

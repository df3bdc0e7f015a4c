"""Long batches whose elements are not C-contiguous, as in Fortran's order or every second column: in packs too.

The loop that every kernel has reads such elements one by one, through scratch memory.  The one made here takes any
strides; on C-contiguous elements it is a little slower, and most callers never need it.
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
    """A graph's loop over packs of any strides, compiled when first wanted."""

    def __init__(self, graph: Graph, name: str, otherwise: Callable[..., Any]) -> None:
        """otherwise: the ufunc that does the work where the graph is too large for packs."""
        self._graph, self._name, self._otherwise = graph, name, otherwise
        self._inputs, self._outputs = ([_tidy(p, graph.precision) for p in x] for x in (graph.inputs, graph.outputs))
        self._item, self._lock = graph.precision.item, new_lock()
        self._made: Callable[..., Any] | None = None
        self._owner: Any = None  # of the code that the ufunc runs

    def suits(self, arguments: Sequence[Any], out: Any) -> bool:
        """Whether a call gains: some long argument is not C-contiguous in its elements, or is written to."""
        # plainly written out: all calls come here but single ones and batches that lie in order
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
        from cutpoint.kernels.arrays.loop_gufunc import LoopGufunc
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
        """Whether numbers of an element are further apart, or in another order, than those of a C-contiguous one."""
        return x.strides[own] != tuple(n and n * x.itemsize // self._item for n in strides)


class _Tidy(NamedTuple):
    """What long batches of C-contiguous elements of a port look like."""

    size: int
    own: slice
    strides: tuple[int | None, ...]


def _tidy(port: Port, precision: Precision) -> _Tidy:
    """How many numbers make a batch long, which axes are the port's own, and their strides in bytes."""
    # NumPy tells the loop of a ufunc that the stride along an axis of length 1 is 0: none is right
    strides = (None,) * len(port.shape) if 1 in port.shape else np.empty(port.shape, precision.dtype).strides
    long = port.size * WORTH_MAKING or sys.maxsize
    return _Tidy(long, slice(-len(port.shape), None) if port.shape else slice(0), strides)

"""Long batches whose elements are not C-contiguous, as in Fortran's order or every second column: in packs too.

The loop that every kernel has reads such elements one by one, through scratch memory.  The one made here takes any
strides; on C-contiguous elements it is a little slower, and most callers never need it.
"""

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cutpoint.kernels.graph import Graph
from cutpoint.kernels.lane_memory import ITEM
from cutpoint.kernels.ports import Port
from cutpoint.kernels.waiting import shown

WORTH_MAKING = 64
"""The shortest batch that goes this way: shorter ones gain less than compiling costs."""


class Strided:
    """A graph's loop over packs of any strides, compiled when first wanted."""

    def __init__(self, graph: Graph, name: str, otherwise: Callable[..., Any]) -> None:
        """otherwise: the ufunc that does the work where the graph is too large for packs."""
        self._graph, self._name, self._otherwise = graph, name, otherwise
        self._inputs, self._outputs = ([_Tidy(p) for p in ports] for ports in (graph.inputs, graph.outputs))
        self._lock = threading.Lock()
        self._made: Any = None

    def suits(self, arguments: Sequence[Any], out: Any) -> bool:
        """Whether a call gains: some long argument is not C-contiguous in its elements, or is written to."""
        given = zip(self._inputs, arguments, strict=True)
        if out is None:
            return any(tidy.is_broken_by(x) for tidy, x in given)
        targets = out if isinstance(out, tuple) else (out,)
        pairs = [*given, *zip(self._outputs, targets, strict=False)]
        if any(tidy.is_broken_by(x) for tidy, x in pairs):
            return True
        return any(tidy.is_long(x) and any(x is y for y in targets) for tidy, x in pairs[: len(arguments)])

    @property
    def call(self) -> Callable[..., Any]:
        """A generalised ufunc."""
        with self._lock, shown(f"{self._name} for batches"):
            if self._made is None:
                self._made = self._compiled()
            return self._otherwise if self._made is False else self._made.call

    def _compiled(self) -> Any:
        from cutpoint.kernels.loop_gufunc import LoopGufunc
        from cutpoint.kernels.lowering import lower
        from cutpoint.kernels.packs import width_of_packs
        from cutpoint.kernels.strided_loop import FUNCTION, strided_loop

        lowered, inputs, outputs = lower(self._graph), self._graph.inputs, self._graph.outputs
        width = width_of_packs(lowered, inputs, outputs)
        if width is None:
            return False
        return LoopGufunc(strided_loop(lowered, inputs, outputs, width), FUNCTION, inputs, outputs, self._name)


class _Tidy:
    """What C-contiguous elements of a port look like."""

    def __init__(self, port: Port) -> None:
        self._size, self._rank = port.size * WORTH_MAKING, len(port.shape)
        self._strides = np.empty(port.shape, np.float64).strides
        # NumPy tells the loop of a ufunc that the stride along an axis of length 1 is 0
        self._never = 1 in port.shape

    def is_long(self, x: Any) -> bool:
        return type(x) is np.ndarray and x.size >= self._size

    def is_broken_by(self, x: Any) -> bool:
        """By a long array in whose elements numbers are further apart, or in another order."""
        if not self._rank or not self.is_long(x):
            return False
        own = x.strides[-self._rank :]
        return self._never or (own != self._strides and own != tuple(n * x.itemsize // ITEM for n in self._strides))

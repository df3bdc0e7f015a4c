"""Kernels with inputs or outputs of size 0, which NumPy's generalised ufuncs do not know: they go around the ufunc."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from cutpoint.kernels.arrays.arguments import as_numbers, batch_shape
from cutpoint.kernels.arrays.gufunc import Gufunc
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port

_BATCH = Port("batch", ())
"""A scalar input that only carries the shape of the batch."""


class AroundEmptyPorts:
    """A compiled graph with the same call as a Gufunc.

    Attributes:
        element: the address of its code, which takes no pointers to what is empty, and one to a number that it does not
            read, between inputs and outputs; None where all outputs are empty.
    """

    def __init__(self, graph: Graph, name: str) -> None:
        self._graph, self._precision = graph, graph.precision
        outputs = [p for p in graph.outputs if p.size]
        inputs = [*(p for p in graph.inputs if p.size), _BATCH]
        self._inner = Gufunc(graph, inputs, outputs, name) if outputs else None
        self.element = self._inner.element if self._inner else None

    def whole(self, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> None: ...

    def call(self, *arguments: Any, out: Any = None) -> Any:
        pairs = [(p, as_numbers(a, self._precision)) for p, a in zip(self._graph.inputs, arguments, strict=True)]
        batch = np.broadcast_shapes(*(batch_shape(p, a) for p, a in pairs))
        targets = self._targets(batch, out)
        if self._inner:
            full = [a for p, a in pairs if p.size]
            filled = tuple(t for p, t in zip(self._graph.outputs, targets, strict=True) if p.size)
            self._inner.call(*full, np.broadcast_to(self._precision.dtype.type(0), batch), out=filled)
        results = targets if out is not None else [t if t.ndim else t[()] for t in targets]
        return results[0] if len(results) == 1 else tuple(results)

    def _targets(self, batch: tuple[int, ...], out: Any) -> list[np.ndarray]:
        if out is None:
            return [np.empty((*batch, *p.shape), self._precision.dtype) for p in self._graph.outputs]
        targets = [*out] if isinstance(out, tuple) else [out]
        for port, target in zip(self._graph.outputs, targets, strict=True):
            if not isinstance(target, np.ndarray):
                raise TypeError("out must be arrays")
            batch_shape(port, target)
        return targets

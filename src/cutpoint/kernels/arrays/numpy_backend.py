"""A graph evaluated by NumPy, node by node: where LLVM is missing, and as a cross-check of it."""

import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cutpoint.kernels.arrays.arguments import as_numbers, batch_shape
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision

_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": np.divide, "neg": operator.neg,
    "sqrt": np.sqrt, "lt": np.less, "le": np.less_equal, "and": np.logical_and, "or": np.logical_or,
    "not": np.logical_not, "select": np.where, "sin": np.sin, "cos": np.cos, "tan": np.tan, "exp": np.exp,
    "log": np.log, "tanh": np.tanh, "atan": np.arctan,
}  # fmt: skip
"""What a graph holds before it is lowered."""


def evaluate(graph: Graph, inputs: Sequence[Any]) -> list[Any]:
    """The graph's results for a number or an array in each input slot."""
    values: dict[int, Any] = {}
    uses = graph.uses.copy()

    def value(x: Any) -> Any:
        if not isinstance(x, Node):
            return graph.precision.number(x)
        uses[x.serial] -= 1  # frees a large batch's arrays at their last use
        return values[x.serial] if uses[x.serial] else values.pop(x.serial)

    with np.errstate(all="ignore"):
        for x in graph.nodes:
            values[x.serial] = inputs[x.args[0]] if x.op == "input" else _FUNCTIONS[x.op](*map(value, x.args))
        return [value(x) for x in graph.results]


class NumpyFunction:
    """A graph as a callable with the semantics of a generalised ufunc."""

    element = None

    def __init__(self, graph: Graph) -> None:
        self._graph = graph

    def whole(self, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> None: ...

    def call(self, *arguments: Any, out: Any = None) -> Any:
        ports = self._graph.inputs
        arrays = [as_numbers(a, self._graph.precision) for a in arguments]
        batch = np.broadcast_shapes(*(batch_shape(p, a) for p, a in zip(ports, arrays, strict=True)))
        slots = [a[..., *index] for p, a in zip(ports, arrays, strict=True) for index in np.ndindex(p.shape)]
        results = iter(evaluate(self._graph, slots))
        values = [_gathered(port, results, batch, self._graph.precision) for port in self._graph.outputs]
        if out is not None:
            targets = out if isinstance(out, tuple) else (out,)
            for target, value in zip(targets, values, strict=True):
                np.copyto(target, value, casting="same_kind")
            values = targets
        return values[0] if len(values) == 1 else tuple(values)


def _gathered(port: Port, results: Any, batch: tuple[int, ...], precision: Precision) -> Any:
    """The next results, as one array or one float."""
    array = np.empty((*batch, *port.shape), precision.dtype)
    for index in np.ndindex(port.shape):
        array[..., *index] = next(results)
    return array if array.ndim else array[()]

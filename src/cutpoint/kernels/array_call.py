"""The general call of a kernel: arrays of any kind, by position or by name."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from cutpoint.kernels.arguments import as_numbers, explained, in_order
from cutpoint.kernels.backends import Function
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.precision import FLOAT64
from cutpoint.kernels.strided import Strided
from cutpoint.kernels.threads import Threaded, checked


class ArrayCall:
    """Puts arguments in order, runs the function, explains what does not fit."""

    def __init__(self, name: str, graph: Graph, function: Function, record: type[tuple[Any, ...]] | None) -> None:
        """record: the NamedTuple that holds the outputs, None for plain ones."""
        self._name, self._graph, self._function = name, graph, function
        self._strided = None if function.element is None else Strided(graph, name, function.call)
        self._make = record and record._make  # type: ignore[attr-defined]

    def __call__(self, *arguments: Any, out: Any = None, threads: int | None = None, **named: Any) -> Any:
        """See `Kernel.__call__`."""
        if named or len(arguments) != len(self._graph.inputs):
            arguments = tuple(in_order(self._name, self._graph.inputs, arguments, named))
        count = 1 if threads is None else checked(self._name, threads)
        try:
            if self._graph.precision is not FLOAT64:  # what NumPy itself refuses is rounded
                arguments = tuple(as_numbers(x, self._graph.precision) for x in arguments)
            result = self._run(arguments, out) if count == 1 else self._threaded(count, arguments, out)
        except (TypeError, ValueError) as error:
            raise explained(self._name, self._graph, arguments, out, error) from None
        if self._make is None:
            return result
        return self._make(result if len(self._graph.outputs) > 1 else (result,))

    def _run(self, arguments: Sequence[Any], out: Any) -> Any:
        call = self._function.call
        if self._strided is not None and self._strided.suits(arguments, out):
            call = self._strided.call
        return call(*arguments) if out is None else call(*arguments, out=out)

    @cached_property
    def _threaded(self) -> Threaded:
        def call(*arguments: Any, out: Any) -> Any:
            return self._run(arguments, out)

        graph = self._graph
        return Threaded(graph.inputs, graph.outputs, len(graph.nodes), call, graph.precision)

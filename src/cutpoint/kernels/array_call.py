"""The general call of a kernel: arrays of any kind, by position or by name."""

from typing import Any

from cutpoint.kernels.arguments import explained, in_order
from cutpoint.kernels.backends import Function
from cutpoint.kernels.graph import Graph


class ArrayCall:
    """Puts arguments in order, runs the function, explains what does not fit."""

    def __init__(self, name: str, graph: Graph, function: Function, record: type[tuple[Any, ...]] | None) -> None:
        """record: the NamedTuple that holds the outputs, None for plain ones."""
        self._name, self._graph, self._function = name, graph, function
        self._make = record and record._make  # type: ignore[attr-defined]

    def __call__(self, *arguments: Any, out: Any = None, **named: Any) -> Any:
        """See `Kernel.__call__`."""
        if named or len(arguments) != len(self._graph.inputs):
            arguments = tuple(in_order(self._name, self._graph.inputs, arguments, named))
        try:
            call = self._function.call
            result = call(*arguments) if out is None else call(*arguments, out=out)
        except (TypeError, ValueError) as error:
            raise explained(self._name, self._graph, arguments, out, error) from None
        if self._make is None:
            return result
        return self._make(result if len(self._graph.outputs) > 1 else (result,))

"""The general call of a kernel: arrays of any kind, by position or by name."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from cutpoint.kernels.arrays.arguments import as_numbers, as_plain, explained, in_order
from cutpoint.kernels.arrays.function import Function, Whole
from cutpoint.kernels.arrays.strided import Strided
from cutpoint.kernels.arrays.threads import Threaded, thread_count
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.precision import FLOAT64

_ARRAY = np.ndarray


class ArrayCall:
    """Puts arguments in order, runs the function, explains what does not fit."""

    def __init__(self, name: str, graph: Graph, function: Function, record: type[tuple[Any, ...]] | None) -> None:
        """record: the NamedTuple that holds the outputs, None for plain ones."""
        self._name, self._graph, self._function = name, graph, function
        self._strided = None if function.element is None else Strided(graph, name, function.call)
        self._make = record and record._make  # type: ignore[attr-defined]
        self._direct = function.call if graph.precision is FLOAT64 and record is None else None
        self._rank = len(graph.inputs[0].shape) + 1 if graph.inputs else 0  # of a batch
        self._count, self._longest = len(graph.inputs), max((p.size for p in graph.inputs), default=0)

    def __call__(self, *arguments: Any, out: Any = None, threads: int | None = None, **named: Any) -> Any:
        """See `Kernel.__call__`."""
        if self._direct and out is None and threads is None and not named and self._are_single(arguments):
            try:
                return self._direct(*arguments)
            except (TypeError, ValueError, OverflowError) as error:
                raise explained(self._name, self._graph, arguments, out, error) from None
        if self._make and isinstance(out, tuple):
            out = tuple(out)  # NumPy accepts no record, such as an earlier call's results
        if threads is None and not named and self._are_batch(arguments) and self._whole:
            found = self._whole(arguments, out)
            if found is not None:
                return found if self._make is None else self._made(found)
        if named or len(arguments) != len(self._graph.inputs):
            arguments = tuple(in_order(self._name, self._graph.inputs, arguments, named))
        arguments = tuple(as_plain(self._name, p, x) for p, x in zip(self._graph.inputs, arguments, strict=True))
        count = 1 if threads is None else thread_count(self._name, threads)
        try:
            if self._graph.precision is not FLOAT64:  # rounds what NumPy itself refuses
                arguments = tuple(as_numbers(x, self._graph.precision) for x in arguments)
            result = self._run(arguments, out) if count == 1 else self._threaded(count, arguments, out)
        except (TypeError, ValueError, OverflowError) as error:
            raise explained(self._name, self._graph, arguments, out, error) from None
        return result if self._make is None else self._made(result)

    @cached_property
    def _whole(self) -> Whole | None:
        """The function for whole batches, made at the first batch."""
        return self._function.whole()

    def _made(self, result: Any) -> Any:
        assert self._make is not None
        return self._make(result if len(self._graph.outputs) > 1 else (result,))

    def _are_single(self, arguments: tuple[Any, ...]) -> bool:
        """Whether there is nothing to speed up or fix: an array for each input, none longer than a single element."""
        if len(arguments) != self._count:
            return False
        for x in arguments:  # an explicit loop for speed: all calls but plain single ones come here
            if type(x) is _ARRAY and x.size <= self._longest:
                continue
            return False
        return True

    def _are_batch(self, arguments: tuple[Any, ...]) -> bool:
        """Whether the first argument has one axis of elements."""
        first = arguments[0] if arguments else None
        return type(first) is _ARRAY and first.ndim == self._rank

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

"""The general calls of a kernel: arrays of any kind, by position or by name."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
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


class Call(ABC):
    """Puts arguments in order, runs a graph, explains what does not fit."""

    def __init__(self, name: str, graph: Graph, record: type[tuple[Any, ...]] | None, operations: int) -> None:
        """record: the NamedTuple that holds the outputs, None for plain ones.  operations: of one element."""
        self._name, self._graph, self._operations = name, graph, operations
        self._make = record and record._make  # type: ignore[attr-defined]

    def _called(self, arguments: Sequence[Any], named: Mapping[str, Any], out: Any, threads: int | None) -> Any:
        """The outputs for arguments of any kind."""
        graph = self._graph
        given = self._plain(in_order(self._name, graph.inputs, arguments, named))
        count = 1 if threads is None else thread_count(self._name, threads)
        try:
            if graph.precision is not FLOAT64:  # rounds what NumPy itself refuses
                given = [as_numbers(x, graph.precision) for x in given]
            found = self._run(*given, out=out) if count == 1 else self._threaded(count, given, out)
        except (TypeError, ValueError, OverflowError) as error:
            raise explained(self._name, graph, given, out, error) from None
        return self._made(found)

    @abstractmethod
    def _run(self, *arguments: Any, out: Any) -> Any:
        """What a generalised ufunc gives for arrays."""

    def _plain(self, arguments: Sequence[Any]) -> list[Any]:
        """Arguments as `_run` takes them."""
        return [as_plain(self._name, p, x) for p, x in zip(self._graph.inputs, arguments, strict=True)]

    def _made(self, found: Any) -> Any:
        """The outputs in their record."""
        if self._make is None:
            return found
        return self._make(found if len(self._graph.outputs) > 1 else (found,))

    @cached_property
    def _threaded(self) -> Threaded:
        return Threaded(self._graph, self._operations, self._run)


class ArrayCall(Call):
    """A call with arrays of any shapes."""

    def __init__(self, name: str, graph: Graph, function: Function, record: type[tuple[Any, ...]] | None) -> None:
        super().__init__(name, graph, record, len(graph.nodes))
        self._function = function
        self._strided = None if function.element is None else Strided(graph, name, function.call)
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
        return self._called(arguments, named, out, threads)

    @cached_property
    def _whole(self) -> Whole | None:
        """The function for whole batches, made at the first batch."""
        return self._function.whole()

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

    def _run(self, *arguments: Any, out: Any) -> Any:
        call = self._function.call
        if self._strided is not None and self._strided.suits(arguments, out):
            call = self._strided.call
        return call(*arguments) if out is None else call(*arguments, out=out)

"""Long batches on several threads: NumPy's ufuncs release the GIL while they run."""

import operator
import os
from collections.abc import Callable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import as_numbers, batch_shape
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Shape

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

CHUNK = 2**23
"""Operations that a thread does before it looks for more: fewer do not outweigh waking it, which takes up to 0.1 ms."""

MOST_THREADS = 256
"""More processors than that share no batch."""

_CHUNKS_PER_THREAD = 4
_ALIGNED = 16  # parts end at pack boundaries


class Threaded:
    """Runs a function of arrays on parts of a batch."""

    def __init__(self, graph: Graph, operations: int, call: Callable[..., Any]) -> None:
        """call(*arrays, out): elements, of so many operations, are independent of each other and broadcast."""
        self._inputs, self._outputs, self._precision, self._call = graph.inputs, graph.outputs, graph.precision, call
        self._least = CHUNK // max(operations, 1)

    def __call__(self, threads: int, arguments: Sequence[Any], out: Any) -> Any:
        """The result of a single call, to the last bit."""
        try:
            arrays = [as_numbers(x, self._precision) for x in arguments]
            batches = [batch_shape(p, x) for p, x in zip(self._inputs, arrays, strict=True)]
            batch = np.broadcast_shapes(*batches)
        except (TypeError, ValueError, OverflowError):
            return self._call(*arguments, out=out)  # it explains what is wrong
        targets = self._targets(batch, out)
        ranges = _ranges(max(batch, default=1), threads, self._least)
        if len(ranges) < 2 or targets is None or _overlap(arrays, targets):
            return self._call(*arguments, out=out)
        axis = batch.index(max(batch))
        pairs = zip((*self._inputs, *self._outputs), (*arrays, *targets), strict=True)
        cuts = [_Cut(x, axis - (len(batch) + len(p.shape))) for p, x in pairs]
        inputs, outputs = cuts[: len(arrays)], cuts[len(arrays) :]

        def run(part: slice) -> None:
            self._call(*(cut(part) for cut in inputs), out=tuple(cut(part) for cut in outputs))

        _shared(run, ranges, threads)
        return targets[0] if len(targets) == 1 else tuple(targets)

    def _targets(self, batch: Shape, out: Any) -> list[Any] | None:
        """Arrays for the results; None if the given ones do not fit."""
        shapes = [(*batch, *p.shape) for p in self._outputs]
        if out is None:
            return [np.empty(shape, self._precision.dtype) for shape in shapes]
        targets = [*out] if isinstance(out, tuple) else [out]
        return targets if [getattr(x, "shape", None) for x in targets] == shapes else None


class _Cut:
    """An array, and how to slice it along an axis counted from the last; an axis that it lacks is broadcast."""

    def __init__(self, array: np.ndarray, axis: int) -> None:
        self._array, self._axis = array, axis
        self._is_shared = array.ndim < -axis or array.shape[axis] == 1

    def __call__(self, part: slice) -> np.ndarray:
        if self._is_shared:
            return self._array
        return self._array[(..., part, *[slice(None)] * (-self._axis - 1))]


def _shared(run: Callable[[slice], None], ranges: Sequence[slice], threads: int) -> None:
    """Runs every range once, here and on other threads; a thread that is done takes the next."""
    left, helpers = iter(ranges), list["Future[None]"]()

    def work() -> None:
        for part in left:
            run(part)

    try:
        for _ in range(min(threads, len(ranges), MOST_THREADS) - 1):
            helpers.append(_pool().submit(work))
        work()
    finally:  # no thread writes to the results after this returns
        unfinished = [x for x in helpers if not x.cancel()]
        for helper in unfinished:
            helper.exception()
    for helper in unfinished:
        helper.result()


def _ranges(length: int, threads: int, least: int) -> list[slice]:
    """Roughly equal parts of an axis, a few per thread, so that the others take over work from a delayed one."""
    size = max(least, _ALIGNED, -(-length // (threads * _CHUNKS_PER_THREAD)))
    size += -size % _ALIGNED
    return [slice(first, min(first + size, length)) for first in range(0, length, size)]


def _overlap(arrays: Sequence[np.ndarray], targets: Sequence[np.ndarray]) -> bool:
    """Whether a result might overwrite data that another part of the batch still has to read."""
    return any(np.may_share_memory(x, y) for x in arrays for y in targets)


def thread_count(name: str, threads: Any) -> int:
    """A number of threads.

    Raises:
        InputError: it is no whole number from 1.
    """
    try:
        count = operator.index(threads)
    except TypeError:
        count = 0
    if count < 1:
        raise InputError(f"{name}: threads={threads!r} must be a whole number from 1", threads=threads)
    return count


@cache
def _pool() -> "ThreadPoolExecutor":
    """The pool, of as many threads as were ever busy at once."""
    from concurrent.futures import ThreadPoolExecutor  # takes 4 ms, saved at startup

    return ThreadPoolExecutor(MOST_THREADS, thread_name_prefix="cutpoint")


if hasattr(os, "register_at_fork"):
    # a child process has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)

"""A stepping program interpreted: where LLVM is missing, and as a cross-check of it."""

from collections.abc import Callable, Iterable, Mapping
from math import prod
from typing import Any

import numpy as np

from cutpoint.kernels.arrays.numpy_backend import evaluate
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.stepping import LaneLoop, Loop, Stage, number_of


class NumpyProgram:
    """A plan run stage by stage."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    def bound(self, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> Callable[[], int]:
        """A run on checked arrays; each call returns the iterations of the outermost loop."""
        rows = {name: array.reshape(-1) for name, array in arrays.items() if name not in self._plan.streamed}
        return lambda: self._loop(self._plan.body, counts, arrays, rows)

    def _loop(
        self,
        loop: Loop,
        counts: Mapping[str, int],
        arrays: Mapping[str, np.ndarray],
        rows: Mapping[str, np.ndarray],
    ) -> int:
        count = number_of(loop.count, counts)
        for index in range(count):
            row = count - 1 - index if loop.backward else index
            streams = {name: self._row(loop, name, arrays, row) for name in loop.streams}
            views = {view.name: self._row(loop, view.of, arrays, arrays[view.index][row]) for view in loop.views}
            inside = {**rows, **streams, **views}
            groups = {name: self._group(loop, name, arrays, row, counts) for name in loop.streams if loop.within(name)}
            for item in loop.body:
                if isinstance(item, Loop):
                    self._loop(item, counts, {**arrays, **groups}, inside)
                else:
                    self._stage(item, inside)
            if loop.until is not None and inside[loop.until][0] != 0:
                return index + 1
        return count

    def _row(self, loop: Loop, name: str, arrays: Mapping[str, np.ndarray], row: int) -> np.ndarray:
        """A row of a region, or one lane of a row."""
        lanes = self._plan.regions[name].lanes if isinstance(loop, LaneLoop) else 1
        return arrays[name][row // lanes, row % lanes :: lanes]

    def _group(
        self, loop: Loop, name: str, arrays: Mapping[str, np.ndarray], row: int, counts: Mapping[str, int]
    ) -> np.ndarray:
        """The rows that inner loops step through."""
        size = prod(number_of(c, counts) for c in loop.within(name))
        return arrays[name][row * size : (row + 1) * size]

    def _stage(self, stage: Stage, rows: Mapping[str, np.ndarray]) -> None:
        graph = self._plan.graphs[stage]
        numbers = [x for port in graph.inputs for x in self._numbers(stage, port.name, rows[port.name])]
        # all is read before anything is written: what is passed through is still a view of a region
        results = iter([np.array(np.broadcast_to(x, stage.lanes)) for x in evaluate(graph, numbers)])
        for port in graph.outputs:
            numbers = np.ravel([next(results) for _ in range(port.size)])
            rows[port.name][self._places(port.name, numbers.size)] = numbers

    def _numbers(self, stage: Stage, name: str, row: np.ndarray) -> Iterable[Any]:
        """A stage's view of a region: arrays of one number per lane, or plain numbers."""
        if self._plan.is_laned(stage, name):
            return row.reshape(-1, stage.lanes)
        return row[self._places(name, self._plan.regions[self._plan.root(name)].size)]

    def _places(self, name: str, size: int) -> Any:
        """Positions of a region's slots in its row."""
        region = self._plan.regions[self._plan.root(name)]
        return [region.place(k) for k in range(region.size)] if region.triples else slice(size)

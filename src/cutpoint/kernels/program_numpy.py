"""A stepping program interpreted: where LLVM is missing, and as a second opinion on it."""

from collections.abc import Mapping

import numpy as np

from cutpoint.kernels.graph import Graph
from cutpoint.kernels.numpy_backend import evaluate
from cutpoint.kernels.program_plan import Plan
from cutpoint.kernels.stepping import Loop


class NumpyProgram:
    """A plan run stage by stage."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    def run(self, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> int:
        """The iterations of the outermost loop; arrays must have been checked."""
        rows = {name: array.reshape(-1) for name, array in arrays.items() if name not in self._plan.streamed}
        return self._loop(self._plan.body, counts, arrays, rows)

    def _loop(
        self, loop: Loop, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray], rows: Mapping[str, np.ndarray]
    ) -> int:
        count = counts[loop.count] if isinstance(loop.count, str) else loop.count
        for index in range(count):
            inside = {**rows, **{name: arrays[name][index] for name in loop.streams}}
            for item in loop.body:
                if isinstance(item, Loop):
                    self._loop(item, counts, arrays, inside)
                else:
                    _stage(self._plan.graphs[item], inside)
            if loop.until is not None and inside[loop.until][0] != 0:
                return index + 1
        return count


def _stage(graph: Graph, rows: Mapping[str, np.ndarray]) -> None:
    results = iter(evaluate(graph, [x for port in graph.inputs for x in rows[port.name]]))
    for port in graph.outputs:
        rows[port.name][:] = [next(results) for _ in range(port.size)]

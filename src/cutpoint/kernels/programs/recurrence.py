"""Arrival times of loop-carried numbers: the latency of a loop's recurrence."""

from collections.abc import Mapping

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.lowering.latencies import cycles

_ITERATIONS = 8
"""After so many it shows what falls behind: the slowest of several recurrences, and all that reads it."""


def arrivals(graph: Graph, fed: Mapping[int, int]) -> dict[int, int]:
    """Cycles after which they are ready, by input slot.

    graph: of an iteration, fused.  fed: by input slot, the result of the previous iteration that it reads.
    """
    come: dict[int, int] = {}
    for _ in range(_ITERATIONS):
        there: dict[int, int] = {}
        for x in graph.nodes:
            waits = [there[y.serial] for y in x.args if isinstance(y, Node)]
            waits += [come.get(x.args[0], 0)] if x.op == "input" else []
            there[x.serial] = max(waits, default=0) + cycles(x.op)
        results = [there[x.serial] if isinstance(x, Node) else 0 for x in graph.results]
        come = {slot: results[k] for slot, k in fed.items()}
    return come

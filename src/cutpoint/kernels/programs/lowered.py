"""A stage in primitives: the same for all emitters of a program, so that they agree to the last bit."""

from collections.abc import Mapping

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.lowering.fusion import fuse
from cutpoint.kernels.lowering.latencies import cycles
from cutpoint.kernels.lowering.lower import in_primitives
from cutpoint.kernels.lowering.scheduling import depth_first
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.stepping import Stage

_ITERATIONS = 8
"""After so many it shows what falls behind: the slowest of several recurrences, and all that reads it."""


def lowered(plan: Plan, stage: Stage) -> Graph:
    """Fuses products so that loop-carried numbers, which arrive late, are on the shortest path."""
    graph, fed, again = plan.graphs[stage], plan.fed(stage), stage.as_in_threes or plan.in_threes(stage)
    fused = fuse(graph, again=again)
    late = fuse(graph, _arrivals(fused, fed), again=again) if fed else fused
    return depth_first(in_primitives(late))


def _arrivals(graph: Graph, fed: Mapping[int, int]) -> dict[int, int]:
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

"""A stage in primitives: the same for all emitters of a program, so that they agree to the last bit."""

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.lowering.fusion import fuse
from cutpoint.kernels.lowering.lower import in_primitives
from cutpoint.kernels.lowering.scheduling import depth_first
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.recurrence import arrivals
from cutpoint.kernels.programs.stepping import Stage


def lowered(plan: Plan, stage: Stage) -> Graph:
    """Fuses products so that loop-carried numbers, which arrive late, are on the shortest path."""
    graph, fed, again = plan.graphs[stage], plan.fed(stage), stage.as_in_threes or plan.in_threes(stage)
    fused = fuse(graph, again=again)
    late = fuse(graph, arrivals(fused, fed), again=again) if fed else fused
    return depth_first(in_primitives(late))

"""Kernels: functions of scalars, traced once, compiled for arrays and for stepping loops.  Knows nothing of robots.

A function becomes a graph (`specialise`, `tracing`, `algebra`), which runs node by node in NumPy (`numpy_backend`), or
is lowered to PRIMITIVES (`nodes`, `lowering`) and emitted (`llvm`, `c99`, `cuda`).  A new emitter walks the nodes of
`lower(graph)`, which come operands first, writes one statement for each `op`, and hands out the lowered graph's
`results`: see docs/emitters.md.  Derivatives are taken of the graph before it is lowered (`derivatives`, `elimination`,
`slopes`), and are graphs again.
"""

from cutpoint.kernels.derivatives import jacobian_of
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.kernel import Kernel, compile
from cutpoint.kernels.program import Program, compile_program
from cutpoint.kernels.specialise import graph_of
from cutpoint.kernels.stepping import LaneLoop, Loop, Region, Stage, View
from cutpoint.kernels.tracing import Traced

__all__ = [
    "Graph", "Kernel", "LaneLoop", "Loop", "Program", "Region", "Stage", "Traced", "View", "compile",
    "compile_program", "graph_of", "jacobian_of",
]  # fmt: skip

"""Kernels: functions of scalars, traced once, compiled for arrays and for stepping loops.  Knows nothing of robots.

Its subpackages, each built on those before it:

graphs: a function becomes a graph of nodes; its derivatives are graphs too.
lowering: elementary functions become arithmetic, scheduled for a processor; every emitter takes the result.
machine: machine code by LLVM, for one element and for batches.
arrays: a graph called from Python on NumPy arrays: single calls, rows, blocks, threads.
programs: stages of traced functions in loops, which step through memory.
targets: export of a graph as C99, CUDA C, JAX functions or SymPy expressions; docs/emitters.md adds another.
"""

import cutpoint.kernels.machine.loading_time  # noqa: F401  first: it dates what follows
from cutpoint.kernels.graphs.derivatives import jacobian_of
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.specialise import graph_of
from cutpoint.kernels.graphs.tracing import Traced
from cutpoint.kernels.kernel import Kernel, compile
from cutpoint.kernels.programs.program import Program, compile_program
from cutpoint.kernels.programs.stepping import LaneLoop, Loop, Region, Stage, View

__all__ = [
    "Graph", "Kernel", "LaneLoop", "Loop", "Program", "Region", "Stage", "Traced", "View", "compile",
    "compile_program", "graph_of", "jacobian_of",
]  # fmt: skip

"""Kernels: functions of scalars, traced once, compiled for arrays and for stepping loops.  Knows nothing of robots."""

from cutpoint.kernels.graph import Graph
from cutpoint.kernels.kernel import Kernel, compile
from cutpoint.kernels.program import Program, compile_program
from cutpoint.kernels.specialise import graph_of
from cutpoint.kernels.stepping import Loop, Region, Stage
from cutpoint.kernels.tracing import Traced

__all__ = ["Graph", "Kernel", "Loop", "Program", "Region", "Stage", "Traced", "compile", "compile_program", "graph_of"]

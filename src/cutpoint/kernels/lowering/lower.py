"""Lowering: the graph in primitives only, as emitters take it."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph, rewrite
from cutpoint.kernels.graphs.nodes import ELEMENTARY, Node, Trace
from cutpoint.kernels.graphs.precision import FLOAT64
from cutpoint.kernels.lowering import elementary
from cutpoint.kernels.lowering.coefficients import TABLES
from cutpoint.kernels.lowering.fusion import fuse
from cutpoint.kernels.lowering.scheduling import scheduled

_FUNCTIONS = {op: getattr(elementary, op) for op in ELEMENTARY}


def lower(graph: Graph) -> Graph:
    """Products and sums fused, elementary functions replaced by their arithmetic, constants rounded, all scheduled."""
    return in_primitives(fuse(graph))


def in_primitives(graph: Graph) -> Graph:
    """A graph that is already fused, in primitives, rounded and scheduled."""
    return scheduled(with_rounded_constants(expand(graph)))


def expand(graph: Graph) -> Graph:
    """The graph with every elementary function written out."""
    table = TABLES[graph.precision]

    def rule(x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        return _FUNCTIONS[x.op](*operands, table) if x.op in _FUNCTIONS else trace.node(x.op, *operands)

    return rewrite(graph, rule)


def with_rounded_constants(graph: Graph) -> Graph:
    """The graph with every constant rounded to its precision."""
    if graph.precision is FLOAT64:
        return graph

    def rounded(x: Operand) -> Operand:
        return graph.precision.rounded(x) if isinstance(x, float) else x

    def rule(x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        return trace.node(x.op, *map(rounded, operands))

    found = rewrite(graph, rule)
    return replace(found, results=tuple(map(rounded, found.results)))

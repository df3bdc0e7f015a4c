"""Lowering: the graph with primitives only, as the emitters take it."""

from collections.abc import Callable
from typing import Any

from cutpoint.kernels import elementary
from cutpoint.kernels.algebra import Operand
from cutpoint.kernels.fusion import fuse
from cutpoint.kernels.graph import Graph, rewrite
from cutpoint.kernels.nodes import ELEMENTARY, Node, Trace

_FUNCTIONS = {op: getattr(elementary, op) for op in ELEMENTARY}


def lower(graph: Graph) -> Graph:
    """Elementary functions replaced by their arithmetic, then products and sums fused."""
    return fuse(expand(graph))


def expand(graph: Graph) -> Graph:
    """The graph with every elementary function written out."""

    def rule(x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        return _FUNCTIONS[x.op](*operands) if x.op in _FUNCTIONS else trace.node(x.op, *operands)

    return rewrite(graph, rule)

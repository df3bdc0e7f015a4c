"""Contraction, decided once in the graph: a product used once, in a sum, becomes a fused multiply-add everywhere."""

from collections import Counter
from collections.abc import Callable
from typing import Any

from cutpoint.kernels.algebra import Operand
from cutpoint.kernels.graph import Graph, rewrite
from cutpoint.kernels.nodes import Node, Trace


def fuse(graph: Graph) -> Graph:
    """The graph with a * b + c, a * b - c and c - a * b as one operation wherever a * b is needed nowhere else."""
    uses = Counter(y.serial for x in graph.nodes for y in x.args if isinstance(y, Node))
    uses.update(x.serial for x in graph.results if isinstance(x, Node))

    def product(x: Operand) -> bool:
        return isinstance(x, Node) and x.op == "mul" and uses[x.serial] == 1

    def rule(x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        if x.op in ("add", "sub"):
            first, second = x.args
            if product(second):
                return trace.node("fma" if x.op == "add" else "fnma", *map(new, second.args), operands[0])
            if product(first):
                return trace.node("fma" if x.op == "add" else "fms", *map(new, first.args), operands[1])
        return trace.node(x.op, *operands)

    return rewrite(graph, rule)

"""Signs moved outward, so that x - y and y - x are one operation: sums absorb them, and products pass them on.

Where x and y are equal, one of the two is -0.0.
"""

from collections.abc import Callable
from typing import Any

from cutpoint.kernels.graphs import algebra
from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph, rewrite
from cutpoint.kernels.graphs.nodes import Node, Trace, key_of


def with_signs_outside(graph: Graph) -> Graph:
    """The graph with a difference and its negative as one operation."""
    return _with_signs_inside(rewrite(graph, _Signs().rule))


def _with_signs_inside(graph: Graph) -> Graph:
    """The graph with y - x in place of -(x - y) where x - y has no other use; likewise for a constant factor."""

    def rule(x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        if x.op == "neg" and graph.uses[x.args[0].serial] == 1:
            inner = x.args[0]
            if inner.op == "sub":
                return trace.node("sub", *map(new, reversed(inner.args)))
            if inner.op == "mul" and isinstance(inner.args[1], float):
                return trace.node("mul", new(inner.args[0]), -inner.args[1])
        return trace.node(x.op, *operands)

    return rewrite(graph, rule)


class _Signs:
    """State for one graph.  differences: those made so far, by the serials of their operands."""

    def __init__(self) -> None:
        self._differences: dict[tuple[Any, ...], Operand] = {}

    def rule(self, x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        if x.op not in ("add", "sub", "mul", "neg"):
            return trace.node(x.op, *operands)
        first, a = _parted(operands[0])
        if x.op == "neg":
            return _signed(-first, a)
        second, b = _parted(operands[1])
        if x.op == "mul":
            return _signed(first * second, algebra.mul(a, b))
        return self._sum(first, second if x.op == "add" else -second, a, b, trace)

    def _sum(self, first: int, second: int, x: Operand, y: Operand, trace: Trace) -> Operand:
        """The sum of two numbers with these signs."""
        if first == second:
            return _signed(first, algebra.add(x, y))
        key, opposite = (key_of(x), key_of(y)), (key_of(y), key_of(x))
        if opposite in self._differences:
            return _signed(-first, self._differences[opposite])
        self._differences[key] = trace.node("sub", x, y)
        return _signed(first, self._differences[key])


def _parted(x: Operand) -> tuple[int, Operand]:
    """A number split into its sign and the rest."""
    return (-1, x.args[0]) if isinstance(x, Node) and x.op == "neg" else (1, x)


def _signed(sign: int, x: Operand) -> Operand:
    own, x = _parted(x)
    return x if own * sign > 0 else x.trace.node("neg", x)

"""Hoisting of loop-invariant code: what a stage computes from constant inputs alone, computed once before all loops."""

from collections.abc import Callable, Container
from dataclasses import replace
from typing import Any, NamedTuple

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph, rewrite
from cutpoint.kernels.graphs.nodes import CONDITIONS, Node, Trace
from cutpoint.kernels.graphs.ports import Port

HOISTED = "hoisted"


class Split(NamedTuple):
    """before: from the inputs to one output, HOISTED.  inside: the rest; its last input is HOISTED."""

    before: Graph
    inside: Graph


def hoist(graph: Graph, fixed: Container[int]) -> Split:
    """A graph split after its operations on fixed input slots alone."""
    moved = _frontier(graph, fixed)
    port, first = Port(HOISTED, (len(moved),)), sum(p.size for p in graph.inputs)
    place = {x.serial: first + k for k, x in enumerate(moved)}

    def rule(x: Node, operands: list[Operand], _: Callable[[Any], Operand], trace: Trace) -> Operand:
        return trace.node("input", place[x.serial]) if x.serial in place else trace.node(x.op, *operands)

    before = replace(graph, outputs=(port,), results=tuple(moved))
    return Split(before, replace(rewrite(graph, rule), inputs=(*graph.inputs, port)))


def _frontier(graph: Graph, fixed: Container[int]) -> list[Node]:
    """Operations on fixed inputs alone that other operations, or results, use."""
    still: dict[int, Node] = {}
    for x in graph.nodes:
        operands = [y for y in x.args if isinstance(y, Node)]
        if x.args[0] in fixed if x.op == "input" else all(y.serial in still for y in operands):
            still[x.serial] = x
    read = {x.serial for x in graph.results if isinstance(x, Node)}
    for x in reversed(graph.nodes):  # users before operands
        if x.serial in still and x.op in CONDITIONS and x.serial in read:
            del still[x.serial]  # memory holds only numbers: it is recomputed from these
        if x.serial not in still:
            read.update(y.serial for y in x.args if isinstance(y, Node))
    return [x for x in still.values() if x.serial in read and x.op != "input"]

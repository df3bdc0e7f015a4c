"""Elementary functions of one call, vectorised: the sines of all joints are computed in one vector.

Mutually independent ones form groups; the rest of the graph reads their values as inputs and gives their arguments as
results.  No bit changes: each lane computes as scalar code would.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph, rewrite
from cutpoint.kernels.graphs.nodes import ELEMENTARY, Node, Trace
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.tracing import tracing
from cutpoint.kernels.lowering.fusion import fuse
from cutpoint.kernels.lowering.lower import in_primitives

_TOGETHER = {"sin": ("sin", "cos"), "cos": ("sin", "cos")}
"""What shares most of its work."""

_FEWEST = 2
"""Arguments that are worth a vector."""


@dataclass(frozen=True)
class Group:
    """The same functions of several arguments.

    graph: the functions of one input, lowered.  arguments: results of the rest that are their arguments.
    values: inputs of the rest that take each function's values.
    """

    graph: Graph
    arguments: range
    values: tuple[range, ...]


@dataclass(frozen=True)
class SideBySide:
    """groups: no argument depends on a later group.  rest: the rest of the graph, lowered."""

    groups: tuple[Group, ...]
    rest: Graph


def side_by_side(graph: Graph, width: int) -> SideBySide:
    """Splits a graph, with its functions not yet lowered, for vectors of this width."""
    fused, groups = fuse(graph), []
    slot, slots = sum(p.size for p in graph.inputs), {}
    results = [*fused.results]
    for functions, arguments in _grouped(fused, width):
        count, values = len(arguments), []
        for function in functions:
            values.append(range(slot, slot + count))
            slots |= {(function, x.serial): slot + k for k, x in enumerate(arguments)}
            slot += count
        own = _function_graph(functions, graph)
        groups.append(Group(own, range(len(results), len(results) + count), tuple(values)))
        results += arguments
    return SideBySide(tuple(groups), in_primitives(_without(fused, slots, results)))


def _grouped(graph: Graph, width: int) -> Iterator[tuple[tuple[str, ...], list[Node]]]:
    """Functions and their arguments, at most a vector each; those that depend on others' values come after them."""
    depth: dict[int, int] = {}
    found: dict[tuple[int, tuple[str, ...]], dict[int, Node]] = {}
    for x in graph.nodes:
        before = max((depth[y.serial] for y in x.args if isinstance(y, Node)), default=0)
        depth[x.serial] = before + (x.op in ELEMENTARY)
        if x.op in ELEMENTARY:
            same = found.setdefault((before, _TOGETHER.get(x.op, (x.op,))), {})
            same[x.args[0].serial] = x.args[0]
    for (_, functions), arguments in sorted(found.items(), key=lambda item: item[0]):
        ordered = [*arguments.values()]
        vectors = [ordered[k : k + width] for k in range(0, len(ordered), width)]
        yield from ((functions, vector) for vector in vectors if len(vector) >= _FEWEST)


def _without(graph: Graph, slots: Mapping[tuple[str, int], int], results: list[Operand]) -> Graph:
    """The graph with these results, and inputs in place of functions: slots by function and serial of its argument."""
    values, arguments = Port("values", (len(slots),)), Port("arguments", (len(results) - len(graph.results),))
    inputs, outputs = (*graph.inputs, values), (*graph.outputs, arguments)

    def rule(x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        slot = slots.get((x.op, x.args[0].serial)) if x.op in ELEMENTARY else None
        return trace.node(x.op, *operands) if slot is None else trace.node("input", slot)

    return rewrite(replace(graph, inputs=inputs, outputs=outputs, results=tuple(results)), rule)


def _function_graph(functions: tuple[str, ...], graph: Graph) -> Graph:
    with tracing() as trace:
        x = trace.node("input", 0)
        values = tuple(trace.node(function, x) for function in functions)
    return in_primitives(Graph((Port("argument", ()),), (Port("values", (len(values),)),), values, graph.precision))

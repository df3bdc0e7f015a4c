"""Graph: what a traced function computes, as nodes in topological order."""

import hashlib
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Any

from cutpoint.errors import unknown_name
from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.nodes import COMMUTATIVE, Node, Trace
from cutpoint.kernels.graphs.ports import Port, places_of, slot_names
from cutpoint.kernels.graphs.precision import FLOAT64, Precision
from cutpoint.kernels.graphs.tracing import tracing

Rule = Callable[[Node, list[Operand], Callable[[Any], Operand], Trace], Operand]
"""See rewrite."""


@dataclass(frozen=True, eq=False)
class Graph:
    """Named inputs and outputs, and the operations between them.

    inputs: a node ("input", slot) reads slot `slot` of all inputs concatenated, arrays in C order.
    results: for each slot of all outputs concatenated, a node or a float.
    precision: that to which inputs, constants and every operation are rounded where the graph runs.
    """

    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    results: tuple[Operand, ...]
    precision: Precision = FLOAT64

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes that the results need: operands before users, depth first from the first result."""
        return tuple(reach(self.results))

    @cached_property
    def inputs_read(self) -> frozenset[str]:
        """Names of the inputs that any result depends on."""
        places = places_of(self.inputs)
        return frozenset(places[x.args[0]][0] for x in self.nodes if x.op == "input")

    @cached_property
    def operations(self) -> dict[str, int]:
        """Number of operations of each kind in the graph, the most frequent first."""
        return dict(Counter(x.op for x in self.nodes if x.op != "input").most_common())

    @cached_property
    def uses(self) -> Counter[int]:
        """Number of uses of each node, by its serial: as an operand and as a result."""
        needed = chain(self.results, *(x.args for x in self.nodes))
        return Counter(x.serial for x in needed if isinstance(x, Node))

    def output(self, name: str) -> tuple[Operand, ...]:
        """The results of one output.

        Raises:
            InputError: there is no such output.
        """
        start = 0
        for port in self.outputs:
            if port.name == name:
                return self.results[start : start + port.size]
            start += port.size
        raise unknown_name("output", name, [p.name for p in self.outputs])

    def fingerprint(self, *outputs: str) -> str:
        """A string that is equal for graphs that compute the same by the same operations on inputs of the same names.

        With names, of these outputs only: graphs that differ only in other outputs still agree.
        """
        chosen = [self.output(name) for name in outputs] if outputs else [self.results]
        return fingerprint([x for results in chosen for x in results], self.inputs)

    def digest(self) -> str:
        """A string shared only by graphs that compute the same by the same operations in the same order."""
        *content, precision = self.__reduce__()[1]
        return hashlib.blake2b(repr((content, precision.real)).encode(), digest_size=16).hexdigest()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles operations as a flat list: nested nodes would exceed pickle's recursion depth."""
        places = {x.serial: k for k, x in enumerate(self.nodes)}

        def reference(x: Any) -> Any:
            return (places[x.serial],) if isinstance(x, Node) else x

        operations = [(x.op, *map(reference, x.args)) for x in self.nodes]
        return _in_a_row, (self.inputs, self.outputs, operations, [*map(reference, self.results)], self.precision)


def _in_a_row(
    inputs: tuple[Port, ...], outputs: tuple[Port, ...], operations: list[Any], results: list[Any], precision: Precision
) -> Graph:
    """The graph of operations whose operands are numbers or, in tuples, the positions of earlier operations."""
    nodes: list[Node] = []

    def operand(x: Any) -> Operand:
        return nodes[x[0]] if isinstance(x, tuple) else x

    with tracing() as trace:
        for op, *args in operations:
            nodes.append(trace.node(op, *map(operand, args)))
    return Graph(inputs, outputs, tuple(map(operand, results)), precision)


def reach(results: Iterable[Operand]) -> list[Node]:
    """The nodes that the results need, operands before users, depth first."""
    seen: dict[int, Node] = {}
    for result in results:
        stack = [(result, False)]
        while stack:
            x, operands_done = stack.pop()
            if not isinstance(x, Node) or x.serial in seen:
                continue
            if operands_done:
                seen[x.serial] = x
            else:
                stack.append((x, True))
                stack.extend((y, False) for y in reversed(x.args))
    return [*seen.values()]


def rewrite(graph: Graph, rule: Rule) -> Graph:
    """The graph with each node replaced by rule(node, its operands, new, trace).

    The operands are already rewritten; new(x) is the replacement of any earlier operand x; trace takes new nodes.
    """
    with tracing() as trace:
        done: dict[int, Operand] = {}

        def new(x: Any) -> Operand:
            return done[x.serial] if isinstance(x, Node) else x

        for x in graph.nodes:
            done[x.serial] = rule(x, [new(y) for y in x.args], new, trace)
        return replace(graph, results=tuple(new(x) for x in graph.results))


def fingerprint(results: Iterable[Operand], inputs: tuple[Port, ...]) -> str:
    """A string that is equal for equal expressions, whatever their trace; see Graph.fingerprint."""
    results = [*results]
    names = slot_names(inputs)
    digests: dict[int, bytes] = {}

    def digest(x: Operand) -> bytes:
        return digests[x.serial] if isinstance(x, Node) else repr(x).encode()

    for x in reach(results):
        parts = [names[x.args[0]].encode()] if x.op == "input" else [digest(y) for y in x.args]
        parts = sorted(parts) if x.op in COMMUTATIVE else parts
        digests[x.serial] = hashlib.blake2b(b"\0".join([x.op.encode(), *parts]), digest_size=16).digest()
    return hashlib.blake2b(b"\0".join(map(digest, results)), digest_size=16).hexdigest()

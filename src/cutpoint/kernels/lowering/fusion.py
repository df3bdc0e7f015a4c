"""Contraction, decided once in the graph: sums absorb products as fused multiply-adds, alike in every target.

Signs are moved outward first.  Products with no other use join the sum that their own sum is a term of:
t + (a x + b y) takes two operations, not three.  Common factors are factored out: a x + a y is a (x + y).
The operand with the longest latency is added last.
Terms that are not products keep their places, so that (x + y) - y is unchanged; in loops, one that is carried late from
the previous iteration comes after the products.
"""

import math
from collections import Counter
from collections.abc import Callable, Hashable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph, rewrite
from cutpoint.kernels.graphs.nodes import Node, Trace, key_of
from cutpoint.kernels.lowering.latencies import cycles
from cutpoint.kernels.lowering.signs import with_signs_outside

_ABOUT_AT_ONCE = 12
"""Cycles.  Terms whose operands come closer to each other than that stay in the order in which they were written."""

_MOST_TERMS = 16
"""That join another sum at a time: in longer ones an operation less is little, and copies of them would be many."""

_TOO_MANY_IN_A_ROW = 5
"""Products that the next iteration would wait for, one after another."""

_BESIDE = 3
"""Sums side by side in place of one: as many as a vector has numbers, so that they go together."""

_AT_ONCE: Mapping[int, int] = MappingProxyType({})
"""Arrivals where all inputs are there from the beginning."""


class Term(NamedTuple):
    """A term that a sum adds (1) or subtracts (-1): a product of two factors, or one number.

    written: the product's serial in the graph.
    """

    sign: int
    factors: tuple[Operand, ...]
    written: int = 0

    @property
    def is_product(self) -> bool:
        return len(self.factors) == 2

    def times(self, sign: int) -> "Term":
        return self._replace(sign=sign * self.sign)

    def beside(self, factor: Hashable) -> Operand | None:
        """The cofactor of this one in the product."""
        if self.is_product:
            for x, y in (self.factors, self.factors[::-1]):
                if key_of(x) == factor:
                    return y
        return None


def fuse(graph: Graph, arrivals: Mapping[int, int] = _AT_ONCE, *, again: bool = False) -> Graph:
    """The graph with a * b + c, a * b - c and c - a * b as one operation wherever a * b has no other use.

    arrivals: cycles after which an input slot's number is ready, where that is later than others: see `lowered`.
    again: for code bound by latency rather than throughput: a product used by several sums, and by nothing else, is
    recomputed in each, and signs stay, so that like sums stay alike; no sum comes before a product that could take
    one; long sums are split into three parts.
    """
    signed = graph if again else with_signs_outside(graph)
    return rewrite(signed, _Fusion(signed, arrivals, again).rule)


class _Fusion:
    """State of one graph's fusion.

    uses: of its numbers, by serial.  shared: products that only sums use.  products: those of a sum that is used once.
    there: the cycle in which a new number is ready.
    """

    def __init__(self, graph: Graph, arrivals: Mapping[int, int], again: bool) -> None:
        self._arrivals, self._again = arrivals, again
        self._uses = graph.uses
        self._shared = _only_in_sums(graph) if again else set[int]()
        self._products: dict[int, list[Term]] = {}
        self._there: dict[int, int] = {}
        for x in graph.nodes:
            terms = self._terms(x) if x.op in ("add", "sub") and self._uses[x.serial] == 1 else []
            if 0 < len(terms) <= _MOST_TERMS and all(t.is_product for t in terms):
                self._products[x.serial] = terms

    def rule(self, x: Node, operands: list[Operand], new: Callable[[Any], Operand], trace: Trace) -> Operand:
        if x.op == "input":
            node = self._made(trace, x.op, *operands)
            self._there[node.serial] += self._arrivals.get(x.args[0], 0)
            return node
        if x.op not in ("add", "sub"):
            return self._made(trace, x.op, *operands)
        return self._sum([t._replace(factors=tuple(map(new, t.factors))) for t in self._terms(x)], trace)

    def _terms(self, x: Node) -> list[Term]:
        first, second = map(self._parts, x.args)
        return first + [t.times(1 if x.op == "add" else -1) for t in second]

    def _parts(self, x: Operand) -> list[Term]:
        if not isinstance(x, Node):
            return [Term(1, (x,))]
        if x.op == "mul" and (self._uses[x.serial] == 1 or x.serial in self._shared):
            return [Term(1, x.args, x.serial)]
        return self._products.get(x.serial) or [Term(1, (x,))]

    def _sum(self, terms: Sequence[Term], trace: Trace) -> Operand:
        """All terms, one after another; where allowed, many late products in parallel partial sums."""
        if not self._again:
            return self._one_after_another(self._in_order(self._factored(terms, trace)), trace)
        last = max((self._ready(t.factors) for t in terms if t.is_product), default=0)
        late = [t for t in terms if t.is_product and self._ready(t.factors) > last - _ABOUT_AT_ONCE]
        if len(late) < _TOO_MANY_IN_A_ROW:
            return self._one_after_another(self._in_order(terms), trace)
        late.sort(key=lambda t: t.written)
        sign = max(t.sign for t in late)
        sums = [self._one_after_another([t.times(sign) for t in late[k::_BESIDE]], trace) for k in range(_BESIDE)]
        total = self._made(trace, "add", self._made(trace, "add", *sums[:2]), sums[2])
        early = [t for t in terms if not any(t is x for x in late)]
        if not early:
            return total if sign > 0 else self._made(trace, "neg", total)
        rest = self._one_after_another(self._in_order(early), trace)
        return self._made(trace, "add" if sign > 0 else "sub", rest, total)

    def _one_after_another(self, terms: Sequence[Term], trace: Trace) -> Operand:
        """All terms accumulated onto the first that is added."""
        start = next((t for t in terms if t.sign > 0), None)
        if start is None:
            return self._made(trace, "neg", self._one_after_another([t.times(-1) for t in terms], trace))
        rest = [t for t in terms if t is not start]
        if not start.is_product:
            (total,) = start.factors
        elif rest and not rest[0].is_product and rest[0].sign < 0:
            total = self._made(trace, "fms", *start.factors, *rest.pop(0).factors)
        else:
            total = self._made(trace, "mul", *start.factors)
        for t in rest:
            if t.is_product:
                total = self._made(trace, "fma" if t.sign > 0 else "fnma", *t.factors, total)
            else:
                total = self._made(trace, "add" if t.sign > 0 else "sub", total, *t.factors)
        return total

    def _factored(self, terms: Sequence[Term], trace: Trace) -> Sequence[Term]:
        """Products with a common factor as one product with a sum; the most common factor goes first."""
        counts = Counter(key for t in terms if t.is_product for key in dict.fromkeys(map(key_of, t.factors)))
        common, count = next(iter(counts.most_common(1)), (None, 0))
        if count < 2:
            return terms
        sharing = [t for t in terms if t.beside(common) is not None]
        factor = next(x for x in sharing[0].factors if key_of(x) == common)
        sign = max(t.sign for t in sharing)
        others = self._sum([Term(sign * t.sign, (t.beside(common),)) for t in sharing], trace)
        rest = [t for t in terms if t.beside(common) is None]
        return self._factored([*rest, Term(sign, (factor, others))], trace)

    def _in_order(self, terms: Sequence[Term]) -> Sequence[Term]:
        """A term that is no product first: products fuse with it, unless a loop carries it later than they come."""
        products = [self._ready(t.factors) for t in terms if t.is_product]
        late = max(products) + _ABOUT_AT_ONCE if products and self._arrivals else math.inf

        def place(t: Term) -> tuple[int, int]:
            there = self._ready(t.factors)
            return 1 if t.is_product else 2 if there > late else 0, there // _ABOUT_AT_ONCE

        return sorted(terms, key=place)

    def _ready(self, operands: Sequence[Operand]) -> int:
        return max((self._there[x.serial] for x in operands if isinstance(x, Node)), default=0)

    def _made(self, trace: Trace, op: str, *operands: Operand) -> Node:
        node = trace.node(op, *operands)
        self._there[node.serial] = self._ready(operands) + cycles(op)
        return node


def _only_in_sums(graph: Graph) -> set[int]:
    others = {y.serial for x in graph.nodes if x.op not in ("add", "sub") for y in x.args if isinstance(y, Node)}
    others |= {x.serial for x in graph.results if isinstance(x, Node)}
    return {x.serial for x in graph.nodes} - others

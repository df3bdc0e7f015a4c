"""Superword-level parallelism: like operations on a vector's three numbers, packed into one vector operation.

Larsen and Amarasinghe (2000): packing starts at adjacent results; where they come from the same operation their
operands are packed too, down to adjacent inputs.  Each number is still computed by the graph's own operations, so its
bits are the same.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node, key_of

_ALIKE = frozenset({"add", "sub", "mul", "div", "neg", "fma", "fms", "fnma"})
_EXCHANGEABLE = frozenset({"add", "mul", "fma", "fms", "fnma"})
"""Whose first two operands may change places."""

_FORESIGHT = 2
"""Operations that are looked ahead to tell which operands go together."""

Triple = tuple[Operand, ...]


@dataclass(slots=True, eq=False)
class Word:
    """Three numbers in one register.

    op: one of _ALIKE, on `operands`; "read", of adjacent inputs, the first at `slot`; "spread", a broadcast number;
    "turn", a permutation of another word by `lanes`; "signed", another word by `signs`, unchanged (1), negated (-1) or
    zero; "join", numbers that are computed as scalars.
    """

    op: str
    numbers: Triple
    operands: Sequence["Word"] = ()
    slot: int = 0
    lanes: Sequence[int] = ()
    signs: Sequence[int] = ()


Unit = Word | Operand


class Superwords:
    """The packing of a graph into words.

    words: by the first slot of three results.  order: words and scalars that all results need, operands first.
    """

    def __init__(self, graph: Graph, read: Sequence[int], written: Sequence[int]) -> None:
        """read, written: the first slots of adjacent threes, of inputs and of results."""
        self._read = {first + lane: (first, lane) for first in read for lane in range(3)}
        self._found: dict[tuple[Any, ...], Word] = {}
        self._places: dict[int, tuple[Word, int]] = {}
        self._needs = _needs(graph)
        threes = {first: graph.results[first : first + 3] for first in written}
        # last, those whose numbers may be in others' words up to sign
        by_signs = sorted(threes, key=lambda first: any(_sign(x) != 1 for x in threes[first]))
        self.words = {first: self._together(threes[first]) for first in by_signs}
        for three in filter(None, map(_summed, graph.nodes)):
            if not any(map(self.place, three)):
                self._together(three)
        order = self._order(graph)
        if order is None:  # two words depend on each other: scalar code, then
            self.words, self._places = {first: Word("join", three) for first, three in threes.items()}, {}
            order = self._order(graph)
        self.order = order or []

    def place(self, x: Operand) -> tuple[Word, int] | None:
        """The word and lane that hold a number."""
        return self._places.get(x.serial) if isinstance(x, Node) else None

    def unit(self, x: Operand) -> Unit:
        """The word that holds a number, or the number itself."""
        place = self.place(x)
        return place[0] if place else x

    def _order(self, graph: Graph) -> list[Unit] | None:
        return _in_order([*self.words.values(), *map(self.unit, graph.results)], self._before)

    def _before(self, unit: Unit) -> list[Unit]:
        """The units that it is computed from."""
        if isinstance(unit, Word):
            is_of_numbers = unit.op in ("spread", "join") and not unit.operands
            return [*map(self.unit, unit.numbers)] if is_of_numbers else [*unit.operands]
        return [*map(self.unit, unit.args)] if isinstance(unit, Node) and unit.op != "input" else []

    def _together(self, numbers: Triple) -> Word:
        key = tuple(map(key_of, numbers))
        if key not in self._found:
            self._found[key] = self._word(numbers)
        return self._found[key]

    def _word(self, numbers: Triple) -> Word:
        if len({key_of(x) for x in numbers}) == 1:
            return Word("spread", numbers)
        if word := self._signed(numbers):
            return word
        nodes = [x for x in numbers if isinstance(x, Node)]
        if len(nodes) < 3:
            return Word("join", numbers)
        if all(x.op == "input" for x in nodes):
            return self._inputs(numbers, [self._read.get(x.args[0]) for x in nodes])
        places = [place for place in map(self.place, numbers) if place]
        if len(places) == 3 and len({id(word) for word, _ in places}) == 1:
            return Word("turn", numbers, [places[0][0]], lanes=[lane for _, lane in places])
        return self._operation(nodes) or Word("join", numbers)

    def _inputs(self, numbers: Triple, places: Sequence[tuple[int, int] | None]) -> Word:
        known = [place for place in places if place]
        if len(known) < 3:
            return Word("join", numbers)
        words, lanes = [self._read_word(first) for first, _ in known], [lane for _, lane in known]
        if len({first for first, _ in known}) > 1:
            return Word("join", numbers, words, lanes=lanes)
        return words[0] if lanes == [0, 1, 2] else Word("turn", numbers, words[:1], lanes=lanes)

    def _read_word(self, first: int) -> Word:
        return self._found.setdefault(("read", first), Word("read", (), slot=first))

    def _signed(self, numbers: Triple) -> Word | None:
        """A "signed" word, if they are already in one word up to zeros and signs."""
        signs = [_sign(x) for x in numbers]
        bare = [x.args[0] if sign < 0 else x for x, sign in zip(numbers, signs, strict=True) if sign]
        if len(bare) == 3 and signs in ([1, 1, 1], [-1, -1, -1]):
            return None
        rest = iter(bare)
        word = self._together(tuple(next(rest) if sign else bare[0] for sign in signs)) if bare else None
        return Word("signed", numbers, [word], signs=signs) if word and word.op in ("spread", "turn", "read") else None

    def _operation(self, nodes: Sequence[Node]) -> Word | None:
        """One vector operation for all three, unless all its operands would have to be joined from scalars."""
        op = nodes[0].op
        alike = op in _ALIKE and all(x.op == op for x in nodes)
        if not alike or len({x.serial for x in nodes}) < 3 or self._is_chain(nodes):
            return None
        word = Word(op, tuple(nodes))
        own = {x.serial: (word, lane) for lane, x in enumerate(nodes) if x.serial not in self._places}
        self._places |= own
        word.operands = [self._together(triple) for triple in self._operands(nodes)]
        if any(x.op != "join" for x in word.operands):
            return word
        for serial in own:
            del self._places[serial]
        return None

    def _is_chain(self, nodes: Sequence[Node]) -> bool:
        """Whether one of them depends on another."""
        own = [1 << self._needs[x.serial].bit_length() - 1 for x in nodes]
        return any(self._needs[x.serial] & sum(own) & ~bit for x, bit in zip(nodes, own, strict=True))

    def _operands(self, nodes: Sequence[Node]) -> list[Triple]:
        """Operands by position; those of commutative operations where they best match the first's."""
        first, *others = [[*x.args] for x in nodes]
        for args in others if nodes[0].op in _EXCHANGEABLE else ():
            as_they_are = self._likeness(first[0], args[0]) + self._likeness(first[1], args[1])
            if as_they_are < self._likeness(first[0], args[1]) + self._likeness(first[1], args[0]):
                args[:2] = args[1::-1]
        return [*zip(first, *others, strict=True)]

    def _likeness(self, x: Operand, y: Operand, foresight: int = _FORESIGHT) -> float:
        if key_of(x) == key_of(y):
            return 6
        if not isinstance(x, Node) or not isinstance(y, Node):
            return 3 * (type(x) is type(y))
        if x.op != y.op:
            return 0
        if x.op == "input":
            (a, _), (b, _) = (self._read.get(z.args[0], (None, 0)) for z in (x, y))
            return 4 if a is not None and a == b else 1
        placed = [place[0] for place in map(self.place, (x, y)) if place]
        if len(placed) == 2 and placed[0] is placed[1]:
            return 5
        below = [self._likeness(a, b, foresight - 1) for a, b in zip(x.args, y.args, strict=True)] if foresight else []
        return 1 + sum(below) / (3 * len(x.args))


def _summed(x: Node) -> tuple[Node, Node, Node] | None:
    """The terms of this number as a sum, if that is three operations of the same kind."""
    if x.op == "add" and isinstance(x.args[0], Node) and x.args[0].op == "add":
        three = (*x.args[0].args, x.args[1])
        if all(isinstance(y, Node) for y in three) and len({y.op for y in three}) == 1 and three[0].op in _ALIKE:
            return three
    return None


def _sign(x: Operand) -> int:
    """-1 for a negated number, 0 for zero, else 1."""
    if isinstance(x, Node):
        return -1 if x.op == "neg" else 1
    return int(repr(x) != "0.0")


def _needs(graph: Graph) -> dict[int, int]:
    """For each node the bit set of nodes that it depends on, itself the highest bit."""
    needs: dict[int, int] = {}
    for k, x in enumerate(graph.nodes):
        needs[x.serial] = 1 << k
        for y in x.args:
            if isinstance(y, Node):
                needs[x.serial] |= needs[y.serial]
    return needs


def _in_order(wanted: Sequence[Unit], before: Callable[[Unit], list[Unit]]) -> list[Unit] | None:
    """Units in topological order with all their dependencies; None if there is a cycle."""
    done: dict[int, Unit] = {}
    under_way = set[int]()
    stack = [(unit, False) for unit in reversed(wanted)]
    while stack:
        unit, is_ready = stack.pop()
        if id(unit) in done:
            continue
        if is_ready:
            done[id(unit)] = unit
            under_way.remove(id(unit))
            continue
        under_way.add(id(unit))
        operands = before(unit)
        if any(id(x) in under_way for x in operands):
            return None
        stack.append((unit, True))
        stack.extend((x, False) for x in reversed(operands))
    return [*done.values()]

"""LLVM IR of a graph whose isomorphic operations have been packed into words: see `superwords`."""

from collections.abc import Callable
from typing import Any

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.machine.llvm import Lanes, applied
from cutpoint.kernels.machine.llvm_code import Code
from cutpoint.kernels.programs.superwords import Superwords, Word

WIDE = Lanes(4)
"""Three numbers and one that nobody reads."""

ONE = Lanes(1)


class SuperwordLine:
    """A graph's operations, emitted as words where possible."""

    def __init__(
        self, code: Code, superwords: Superwords, load: Callable[[int], str], load_three: Callable[[int], str]
    ) -> None:
        """load(slot) names an input's value, load_three(first slot) that of three as a vector."""
        self._code, self._superwords, self._load, self._load_three = code, superwords, load, load_three
        self._names: dict[int, str] = {}
        self._words: dict[int, str] = {}
        for unit in superwords.order:
            if isinstance(unit, Word):
                self._words[id(unit)] = self._written(unit)
            elif isinstance(unit, Node):
                self._names[unit.serial] = self._computed(unit)

    def number(self, x: Any) -> str:
        """The name of one number."""
        place = self._superwords.place(x)
        if place and x.serial not in self._names:
            self._names[x.serial] = WIDE.one_of(self._code, self.word(place[0]), place[1])
        return self._names[x.serial] if isinstance(x, Node) else ONE.constant(x) if isinstance(x, float) else x

    def word(self, word: Word) -> str:
        """The name of a word's vector, of WIDE's type."""
        return self._words[id(word)]

    def _computed(self, x: Node) -> str:
        return self._load(x.args[0]) if x.op == "input" else applied(self._code, ONE, x.op, *map(self.number, x.args))

    def _written(self, word: Word) -> str:
        if word.op == "read":
            return self._load_three(word.slot)
        if word.op == "turn":
            return WIDE.turned(self._code, self.word(word.operands[0]), word.lanes)
        if word.op == "signed":
            return WIDE.signed(self._code, self.word(word.operands[0]), word.signs)
        if word.op == "join":
            return self._joined(word)
        if word.op == "spread":
            return self._spread(word.numbers[0])
        return applied(self._code, WIDE, word.op, *map(self.word, word.operands))

    def _joined(self, word: Word) -> str:
        """Shuffled from words if all three are in some, else built from scalars.  Lanes that nobody reads are zero."""
        if not word.operands:
            return WIDE.joined(self._code, [*map(self.number, word.numbers)])
        (a, b, c), (i, j, k) = map(self.word, word.operands), word.lanes
        return WIDE.beside(self._code, WIDE.beside(self._code, a, b, [i, 4 + j, None, 3]), c, [0, 1, 4 + k, 3])

    def _spread(self, x: Operand) -> str:
        place = self._superwords.place(x)
        if place:
            return WIDE.turned(self._code, self.word(place[0]), [place[1]] * 3)
        return WIDE.spread(self._code, self.number(x)) if isinstance(x, Node) else WIDE.constant(x)

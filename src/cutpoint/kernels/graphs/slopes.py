"""Slopes: partial derivatives of an operation by its operands, exact for every operation that can be traced.

Elementary functions are differentiated as such, before they are lowered to arithmetic.  A comparison has no slope:
where its sides are equal, the slope of `where` is that of the chosen branch.
"""

from collections.abc import Callable, Iterable
from functools import reduce
from typing import Any

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.tracing import Condition, Traced
from cutpoint.scalars import cos, sin

Guard = frozenset[Condition]
"""Conditions that hold together; none always does."""

_ALWAYS: Guard = frozenset()


class Slope:
    """A derivative that is `value` where its guard holds, and 0 elsewhere, even where `value` is not finite.

    `where` does not multiply by a mask, so a root of zero or a pole in the other branch does not spread.
    """

    __slots__ = ("guard", "value")

    def __init__(self, value: Operand, guard: Guard = _ALWAYS) -> None:
        self.value, self.guard = value, guard

    @property
    def vanishes(self) -> bool:
        """Whether it is known to be 0, by its value or by a contradictory guard."""
        if isinstance(self.value, float) and self.value == 0:
            return True
        return any(condition.op == "not" and condition.args[0] in self.guard for condition in self.guard)

    @property
    def operand(self) -> Operand:
        """The derivative as a number."""
        return self._beyond(_ALWAYS)

    def __mul__(self, inner: "Slope") -> "Slope":
        """The chain rule."""
        return Slope(self.value * inner.value, self.guard | inner.guard if inner.guard else self.guard)

    def __add__(self, other: "Slope") -> "Slope":
        """The sum over two paths from an operand to a result."""
        if self.guard == other.guard:
            return Slope(self.value + other.value, self.guard)
        common = self.guard & other.guard
        here, there = (_all(slope.guard - common) for slope in (self, other))
        if there is True:
            return other + self
        if here is True:
            return Slope(Traced.where(there, self.value + other.value, self.value), common)
        if here is ~there:
            return Slope(Traced.where(here, self.value, other.value), common)
        return Slope(self._beyond(common) + other._beyond(common), common | {here | there})

    def _beyond(self, guard: Guard) -> Operand:
        """The value, with 0 where conditions fail that are not in this guard."""
        return Traced.where(_all(self.guard - guard), self.value, 0.0)


def _all(conditions: Iterable[Condition]) -> Any:
    """Whether all conditions hold, in a deterministic order."""
    return reduce(lambda x, y: x & y, sorted(conditions, key=lambda c: c.serial), True)


def local_slopes(x: Node) -> list[Slope]:
    """The derivative of an operation with respect to each of its operands."""
    if x.op == "select":
        condition, _, _ = x.args
        return [Slope(0.0), Slope(1.0, frozenset({condition})), Slope(1.0, frozenset({~condition}))]
    return [Slope(value) for value in _RULES[x.op](x, *x.args)]


_RULES: dict[str, Callable[..., tuple[Any, ...]]] = {
    "add": lambda y, a, b: (1.0, 1.0),
    "sub": lambda y, a, b: (1.0, -1.0),
    "neg": lambda y, a: (-1.0,),
    "mul": lambda y, a, b: (b, a),
    "div": lambda y, a, b: (1 / b, -(y * (1 / b))),
    "sqrt": lambda y, a: (1 / (2 * y),),
    "sin": lambda y, a: (cos(a),),
    "cos": lambda y, a: (-sin(a),),
    "tan": lambda y, a: (1 + y * y,),
    "exp": lambda y, a: (y,),
    "log": lambda y, a: (1 / a,),
    "tanh": lambda y, a: (1 - y * y,),
    "atan": lambda y, a: (1 / (1 + a * a),),
}
"""Derivatives of y, the operation's result, with respect to its operands."""

"""Traced: a number that records how it was computed.

A Traced is never constant: an operation whose result is known gives a plain float, so Python itself folds constants.
x * 0, 0 / x and x - x are 0 and x / x is 1, whatever x is at run time, even 0, infinite or NaN: that removes a robot's
structural zeros, and robots' functions check on entry that numbers are finite.
"""

import gc
import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from numbers import Real
from typing import Any

import numpy as np

from cutpoint.kernels.graphs import algebra
from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.nodes import Node, Trace
from cutpoint.kernels.graphs.refusals import NO_NUMBER, Refusals, as_float, refuse, refuse_numpy, refuse_operand
from cutpoint.scalars import known_truth

_OPERATORS = {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "divide": operator.truediv,
    "negative": operator.neg, "positive": operator.pos, "power": operator.pow,
    "less": operator.lt, "less_equal": operator.le, "greater": operator.gt, "greater_equal": operator.ge,
}  # fmt: skip
"""NumPy's names of what a traced number does with arrays and NumPy's floats."""


def _operator(rule: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """A binary operator from its rule on a Traced and an operand; scalars of a higher level take over."""

    def apply(self: "Traced", other: Any) -> Any:
        if isinstance(other, Traced):
            return rule(self, other)
        if isinstance(other, (float, int, Real)):  # the first two only for speed
            return rule(self, as_float(other))
        return _yield_to(other)

    return apply


def _yield_to(other: Any) -> Any:
    """NotImplemented for types that can handle a Traced; a refusal for all others."""
    if getattr(other, "level", 0) > Traced.level or isinstance(other, np.ndarray):
        return NotImplemented
    if isinstance(other, Condition):
        refuse(NO_NUMBER)
    refuse_operand(other)


class Condition(Refusals, Node):
    """A comparison of traced numbers, decided only when the kernel runs.  Combined by `&`, `|` and `~`."""

    __slots__ = ()
    __array_ufunc__ = None
    level = 1

    def __and__(self, other: Any) -> "Condition | bool":
        known = known_truth(other)
        if known is not None:
            return self if known else False
        return self if other is self else self._join("and", other)

    def __or__(self, other: Any) -> "Condition | bool":
        known = known_truth(other)
        if known is not None:
            return True if known else self
        return self if other is self else self._join("or", other)

    __rand__, __ror__ = __and__, __or__

    def __invert__(self) -> "Condition":
        return self.args[0] if self.op == "not" else self.trace.node("not", self)

    def __add__(self, *other: object) -> Any:
        refuse(NO_NUMBER)

    __sub__ = __mul__ = __truediv__ = __radd__ = __rsub__ = __rmul__ = __rtruediv__ = __neg__ = __add__

    def _join(self, op: str, other: Any) -> "Condition":
        if not isinstance(other, Condition):
            refuse(f"& and | join conditions, not a condition and a {type(other).__name__}")
        return self.trace.node(op, *sorted((self, other), key=lambda x: x.serial))

    @staticmethod
    def where(condition: Any, yes: Operand, no: Operand) -> Operand:
        return Traced.where(condition, yes, no)


class Traced(Refusals, Node):
    """A real number of a trace, with + - * / **, comparisons and the elementary functions."""

    __slots__ = ()
    level = 1

    __add__ = _operator(algebra.add)
    __sub__ = _operator(algebra.sub)
    __mul__ = _operator(algebra.mul)
    __truediv__ = _operator(algebra.div)
    __radd__, __rmul__ = __add__, __mul__
    __rsub__ = _operator(lambda x, y: algebra.sub(y, x))
    __rtruediv__ = _operator(lambda x, y: algebra.div(y, x))

    __lt__ = _operator(lambda x, y: False if x is y else _compare("lt", x, y))
    __gt__ = _operator(lambda x, y: False if x is y else _compare("lt", y, x))
    __le__ = _operator(lambda x, y: _compare("le", x, y))
    __ge__ = _operator(lambda x, y: _compare("le", y, x))

    def __and__(self, other: object) -> Any:
        refuse("& and | join conditions, << and >> move bits of whole numbers: a traced number has neither")

    __or__ = __xor__ = __rand__ = __ror__ = __rxor__ = __lshift__ = __rshift__ = __and__

    def __neg__(self) -> Operand: return algebra.neg(self)
    def __pos__(self) -> "Traced": return self
    def __abs__(self) -> Operand: return Traced.where(self < 0, -self, self)

    def __pow__(self, exponent: Any) -> Operand:
        if not isinstance(exponent, Real):
            refuse("the exponent of ** must be a constant whole number or 0.5; for others use exp and log")
        return algebra.power(self, as_float(exponent))

    def __rpow__(self, base: Any) -> Operand:
        refuse("a constant to a traced power: write cutpoint.exp(x * log(base))")

    def sin(self) -> Operand: return self._odd("sin")
    def tan(self) -> Operand: return self._odd("tan")
    def tanh(self) -> Operand: return self._odd("tanh")
    def atan(self) -> Operand: return self._odd("atan")
    arctan = atan  # the names by which NumPy calls methods of array elements
    def cos(self) -> Operand: return self.trace.node("cos", self.args[0] if self.op == "neg" else self)
    def exp(self) -> Operand: return self.trace.node("exp", self)
    def log(self) -> Operand: return self.trace.node("log", self)
    def sqrt(self) -> Operand: return self.trace.node("sqrt", self)

    def _odd(self, op: str) -> Operand:
        return -self.trace.node(op, self.args[0]) if self.op == "neg" else self.trace.node(op, self)

    @staticmethod
    def where(condition: Any, yes: Operand, no: Operand) -> Operand:
        """`yes` where the condition holds, else `no`; both are evaluated."""
        known = known_truth(condition)
        if known is not None:
            return yes if known else no
        if not isinstance(condition, Condition):
            refuse(f"the condition of where must be a comparison, not a {type(condition).__name__}")
        if condition.op == "not":
            return Traced.where(condition.args[0], no, yes)
        yes, no = (x if isinstance(x, Traced) else _constant(x) for x in (yes, no))
        same = yes is no or (isinstance(yes, float) and isinstance(no, float) and repr(yes) == repr(no))
        return yes if same else condition.trace.node("select", condition, yes, no)

    def __array_ufunc__(self, ufunc: Any, method: str, *arguments: Any, **options: Any) -> Any:
        """Arithmetic with NumPy's floats, and elementwise with arrays; functions are refused."""
        options = {} if options == {"dtype": object} else options  # it is what is done anyway
        if ufunc.__name__ not in _OPERATORS or method != "__call__" or options:
            refuse_numpy(ufunc.__name__)
        if any(isinstance(x, np.ndarray) for x in arguments):
            # as objects, comparisons too: on numeric dtypes they would ask a condition for its truth value
            return ufunc(*[_boxed(x) if isinstance(x, Traced) else _as_objects(x) for x in arguments], dtype=object)
        return _OPERATORS[ufunc.__name__](*[x if isinstance(x, Traced) else _constant(x) for x in arguments])


def _compare(op: str, x: Operand, y: Operand) -> Condition:
    return (x if isinstance(x, Node) else y).trace.node(op, x, y)


def _constant(x: Any) -> float:
    return as_float(x) if isinstance(x, Real) else refuse_operand(x)


def _boxed(x: Traced) -> np.ndarray:
    box = np.empty((), object)
    box[()] = x
    return box


def _as_objects(x: Any) -> Any:
    """An array of NumPy's numbers as Python's own: NumPy's would call NumPy again."""
    real = isinstance(x, np.ndarray) and x.dtype.kind in "fiu"
    return x.astype(np.float64).astype(object) if real else x


@contextmanager
def tracing() -> Iterator[Trace]:
    """A new trace that ends with the block.  The garbage collector is off meanwhile: a trace only grows."""
    trace = Trace(Traced, Condition)
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield trace
    finally:
        trace.end()
        if was_enabled:
            gc.enable()

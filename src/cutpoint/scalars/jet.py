"""Time jets: a value with its time derivatives, as truncated Taylor series.

Griewank and Walther (2008), chapter 13.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any

from cutpoint.scalars import functions
from cutpoint.scalars.functions import Scalar


class Jet:
    """Jet(x, x', x'', ...): Taylor coefficients c[k] = (d/dt)^k x / k! of a scalar in time.

    Arithmetic between jets keeps the shorter order; a plain number is constant in time.
    """

    __slots__ = ("c",)
    level = 2  # a jet of traced values is a jet: it decides in `where`

    def __init__(self, *derivatives: Scalar) -> None:
        self.c: list[Any] = [d if k < 2 else d / math.factorial(k) for k, d in enumerate(derivatives)]

    @classmethod
    def of_taylor(cls, coefficients: Iterable[Scalar]) -> "Jet":
        jet = cls.__new__(cls)
        jet.c = [*coefficients]
        return jet

    def derivative(self, k: int) -> Scalar:
        """The k-th time derivative."""
        return self.c[k] if k < 2 else self.c[k] * math.factorial(k)

    def rate(self) -> "Jet":
        """The jet of the time derivative, one order shorter."""
        return Jet.of_taylor(k * c if k > 1 else c for k, c in enumerate(self.c) if k)

    def _lift(self, x: Any) -> "Jet":
        return x if isinstance(x, Jet) else Jet.of_taylor([x] + [0] * (len(self.c) - 1))

    def __add__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            return Jet.of_taylor(x + y for x, y in zip(self.c, other.c, strict=False))
        return Jet.of_taylor([self.c[0] + other, *self.c[1:]])

    __radd__ = __add__

    def __neg__(self) -> "Jet": return Jet.of_taylor(-x for x in self.c)
    def __sub__(self, other: Any) -> "Jet": return self + -other
    def __rsub__(self, other: Any) -> "Jet": return -self + other

    def __mul__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            order = min(len(self.c), len(other.c))
            return Jet.of_taylor(_convolution(self.c, other.c, k) for k in range(order))
        return Jet.of_taylor(x * other for x in self.c)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Jet":
        if not isinstance(other, Jet):
            return Jet.of_taylor(x / other for x in self.c)
        gain = 1 / other.c[0]  # one division for all orders
        quotient: list[Any] = []
        for k in range(min(len(self.c), len(other.c))):
            rest = self.c[k]
            for j in range(k):
                rest = rest - quotient[j] * other.c[k - j]
            quotient.append(rest * gain)
        return Jet.of_taylor(quotient)

    def __rtruediv__(self, other: Any) -> "Jet": return self._lift(other) / self

    def __lt__(self, other: Any) -> Any: return self.c[0] < _value(other)
    def __gt__(self, other: Any) -> Any: return self.c[0] > _value(other)
    def __le__(self, other: Any) -> Any: return self.c[0] <= _value(other)
    def __ge__(self, other: Any) -> Any: return self.c[0] >= _value(other)

    def _solve(self, start: Scalar, slope: Callable[["Jet"], "Jet | Scalar"]) -> "Jet":
        """f(x(t)) from f' = slope(f) x', order by order: each order of f needs only lower ones of the slope."""
        f, own = [start], self.rate()
        for k in range(1, len(self.c)):
            g = slope(Jet.of_taylor(f))
            f.append(_convolution(g.c, own.c, k - 1) / k if isinstance(g, Jet) else g * own.c[k - 1] / k)
        return Jet.of_taylor(f)

    def sin(self) -> "Jet": return self._sin_cos()[0]
    def cos(self) -> "Jet": return self._sin_cos()[1]

    def _sin_cos(self) -> "tuple[Jet, Jet]":
        s, c, own = [functions.sin(self.c[0])], [functions.cos(self.c[0])], self.rate()
        for k in range(1, len(self.c)):
            s_k, c_k = _convolution(c, own.c, k - 1) / k, -(_convolution(s, own.c, k - 1) / k)
            s.append(s_k)
            c.append(c_k)
        return Jet.of_taylor(s), Jet.of_taylor(c)

    def exp(self) -> "Jet": return self._solve(functions.exp(self.c[0]), lambda f: f)
    def tan(self) -> "Jet": return self._solve(functions.tan(self.c[0]), lambda f: 1 + f * f)
    def tanh(self) -> "Jet": return self._solve(functions.tanh(self.c[0]), lambda f: 1 - f * f)
    def sqrt(self) -> "Jet": return self._solve(functions.sqrt(self.c[0]), lambda f: 1 / (2 * f))
    def log(self) -> "Jet": return self._solve(functions.log(self.c[0]), lambda _: 1 / self)
    def atan(self) -> "Jet": return self._solve(functions.atan(self.c[0]), lambda _: 1 / (1 + self * self))

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> "Jet":
        """Chosen by value; the derivatives follow the side chosen."""
        some = yes if isinstance(yes, Jet) else no
        pairs = zip(some._lift(yes).c, some._lift(no).c, strict=True)
        return Jet.of_taylor(functions.where(condition, y, n) for y, n in pairs)


def _value(x: Any) -> Any:
    return x.c[0] if isinstance(x, Jet) else x


def _convolution(a: list[Any], b: list[Any], k: int) -> Any:
    """sum of a[j] b[k - j] over j = 0..k."""
    total = a[0] * b[k]
    for j in range(1, k + 1):
        total = total + a[j] * b[k - j]
    return total

"""Time jets: a value with its time derivatives.  Griewank and Walther (2008), chapter 13.

They hold derivatives, not the Taylor coefficients of the book: no product is spent on factorials.
"""

import math
from collections.abc import Callable, Sequence
from numbers import Real
from operator import is_
from typing import Any

from cutpoint.scalars import functions
from cutpoint.scalars.functions import Scalar


class Jet:
    """Jet(x, x', x'', ...): a scalar in time, with as many derivatives as are given.

    Arithmetic between jets keeps the shorter order; a plain number is constant in time.
    """

    __slots__ = ("derivatives",)
    __array_ufunc__ = None  # so that array * jet comes here
    level = 2  # a jet of traced values is a jet: it decides in `where`

    def __init__(self, *derivatives: Scalar) -> None:
        self.derivatives: tuple[Any, ...] = derivatives

    def derivative(self, k: int) -> Scalar:
        """The k-th time derivative; the value for 0."""
        return self.derivatives[k]

    def rate(self) -> "Jet":
        """The jet of the time derivative, one order shorter."""
        return Jet(*self.derivatives[1:])

    def _lift(self, x: Any) -> "Jet":
        return x if isinstance(x, Jet) else Jet(x, *[0] * (len(self.derivatives) - 1))

    def __add__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            return Jet(*(x + y for x, y in zip(self.derivatives, other.derivatives, strict=False)))
        return Jet(self.derivatives[0] + other, *self.derivatives[1:])

    __radd__ = __add__

    def __neg__(self) -> "Jet": return Jet(*(-x for x in self.derivatives))

    def __sub__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            return Jet(*(x - y for x, y in zip(self.derivatives, other.derivatives, strict=False)))
        return Jet(self.derivatives[0] - other, *self.derivatives[1:])

    def __rsub__(self, other: Any) -> "Jet": return -self + other

    def __mul__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            x, y = self.derivatives, other.derivatives
            orders = range(min(len(x), len(y)))
            if all(map(is_, x, y)):
                return Jet(*(_of_square(x, k) for k in orders))
            return Jet(*(_of_product(x, y, k) for k in orders))
        return Jet(*(x * other for x in self.derivatives))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Jet":
        if not isinstance(other, Jet):
            return Jet(*(x / other for x in self.derivatives))
        x, y, quotient = self.derivatives, other.derivatives, []
        gain = 1 / y[0]  # one division for all orders
        for k in range(min(len(x), len(y))):
            rest = x[k]
            for j in range(k):
                rest = rest - _times(math.comb(k, j), quotient[j]) * y[k - j]
            quotient.append(rest * gain)
        return Jet(*quotient)

    def __rtruediv__(self, other: Any) -> "Jet": return self._lift(other) / self

    def __pow__(self, exponent: Any) -> "Jet":
        """To a constant whole power, by repeated squaring, or the square root: as of traced numbers."""
        if not isinstance(exponent, Real):
            return NotImplemented
        if exponent == 0.5:
            return self.sqrt()
        if not float(exponent).is_integer():
            return NotImplemented
        square, result, n = self, self._lift(1.0), abs(int(float(exponent)))
        while n:
            result = square * result if n & 1 else result
            n >>= 1
            square = square * square if n else square
        return 1 / result if exponent < 0 else result

    def __abs__(self) -> "Jet": return Jet.where(self < 0, -self, self)

    def __lt__(self, other: Any) -> Any: return self.derivatives[0] < value_of(other)
    def __gt__(self, other: Any) -> Any: return self.derivatives[0] > value_of(other)
    def __le__(self, other: Any) -> Any: return self.derivatives[0] <= value_of(other)
    def __ge__(self, other: Any) -> Any: return self.derivatives[0] >= value_of(other)

    def _solve(self, start: Scalar, slope: Callable[["Jet"], "Jet | Scalar"]) -> "Jet":
        """f(x(t)) from f' = slope(f) x', order by order: each order of f needs only lower ones of the slope."""
        f, own = [start], self.derivatives[1:]
        for k in range(len(own)):
            g = slope(Jet(*f))
            f.append(_of_product(g.derivatives, own, k) if isinstance(g, Jet) else g * own[k])
        return Jet(*f)

    def sin(self) -> "Jet": return self._sin_cos()[0]
    def cos(self) -> "Jet": return self._sin_cos()[1]

    def _sin_cos(self) -> "tuple[Jet, Jet]":
        x, *own = self.derivatives
        s, c = [functions.sin(x)], [functions.cos(x)]
        for k in range(len(own)):
            s_k, c_k = _of_product(c, own, k), -_of_product(s, own, k)
            s.append(s_k)
            c.append(c_k)
        return Jet(*s), Jet(*c)

    def exp(self) -> "Jet": return self._solve(functions.exp(self.derivatives[0]), lambda f: f)
    def tan(self) -> "Jet": return self._solve(functions.tan(self.derivatives[0]), lambda f: 1 + f * f)
    def tanh(self) -> "Jet": return self._solve(functions.tanh(self.derivatives[0]), lambda f: 1 - f * f)
    def sqrt(self) -> "Jet": return self._solve(functions.sqrt(self.derivatives[0]), lambda f: 1 / (2 * f))
    def log(self) -> "Jet": return self._solve(functions.log(self.derivatives[0]), lambda _: 1 / self)
    def atan(self) -> "Jet": return self._solve(functions.atan(self.derivatives[0]), lambda _: 1 / (1 + self * self))

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> "Jet":
        """Selects by value; the derivatives are those of the chosen branch."""
        some = yes if isinstance(yes, Jet) else no
        pairs = zip(some._lift(yes).derivatives, some._lift(no).derivatives, strict=True)
        return Jet(*(functions.where(condition, y, n) for y, n in pairs))


def value_of(x: Scalar) -> Scalar:
    """The value of a jet; of any other scalar, itself."""
    return x.derivatives[0] if isinstance(x, Jet) else x


def rate_of(x: Scalar) -> Scalar:
    """The time derivative of a jet; 0 of any other scalar, which is constant in time."""
    return x.rate() if isinstance(x, Jet) else 0


def _of_product(x: Sequence[Any], y: Sequence[Any], k: int) -> Any:
    """The k-th derivative of a product: Leibniz' rule."""
    total = x[0] * y[k]
    for j in range(1, k + 1):
        total = total + _times(math.comb(k, j), x[j]) * y[k - j]
    return total


def _of_square(x: Sequence[Any], k: int) -> Any:
    """The same for a square, whose terms come in pairs."""
    terms = [2 * math.comb(k, j) * x[j] * x[k - j] for j in range((k + 1) // 2)]
    if k % 2 == 0:
        terms.append(_times(math.comb(k, k // 2), x[k // 2]) * x[k // 2])
    return sum(terms[1:], terms[0])


def _times(count: int, x: Any) -> Any:
    return x if count == 1 else count * x

"""A scalar that carries a bound on its own rounding error, so that tolerances are derived and not fitted."""

import math
from typing import Any

EPS = 2.0**-52
ULPS = 4  # what any backend's elementary functions may be off by


class Choice:
    """A comparison of bounded numbers."""

    level = 3

    def __init__(self, holds: bool) -> None: self.holds = holds
    def __and__(self, other: "Choice") -> "Choice": return Choice(self.holds and other.holds)
    def __or__(self, other: "Choice") -> "Choice": return Choice(self.holds or other.holds)
    def __invert__(self) -> "Choice": return Choice(not self.holds)

    @staticmethod
    def where(condition: "Choice", yes: Any, no: Any) -> "Bounded":
        """Of two numbers that another evaluation may choose differently only where they agree within their errors."""
        kind = next((type(x) for x in (yes, no) if isinstance(x, Bounded)), Bounded)
        y, n = (x if isinstance(x, Bounded) else kind(float(x)) for x in (yes, no))
        return kind((y if condition.holds else n).value, y.error + n.error)


class Bounded:
    """A float and how far another evaluation of the same expression may be from it.  Wilkinson's running error."""

    level = 3
    eps, least = EPS, 5e-324

    def __init__(self, value: float, error: float = 0.0) -> None:
        self.value, self.error = value, error

    def _other(self, x: Any) -> "Bounded": return x if isinstance(x, Bounded) else type(self)(float(x))

    def __add__(self, other: Any) -> "Bounded":
        y = self._other(other)
        return self._rounded(self.value + y.value, self.error + y.error)

    def __mul__(self, other: Any) -> "Bounded":
        y = self._other(other)
        error = self.error * abs(y.value) + y.error * abs(self.value) + self.error * y.error
        return self._rounded(self.value * y.value, error)

    def __truediv__(self, other: Any) -> "Bounded":
        y = self._other(other)
        quotient = self.value / y.value
        return self._rounded(quotient, (self.error + abs(quotient) * y.error) / (abs(y.value) - y.error))

    __radd__, __rmul__ = __add__, __mul__
    def __rtruediv__(self, other: Any) -> "Bounded": return self._other(other) / self
    def __neg__(self) -> "Bounded": return type(self)(-self.value, self.error)
    def __sub__(self, other: Any) -> "Bounded": return self + -self._other(other)
    def __rsub__(self, other: Any) -> "Bounded": return -self + other
    def __lt__(self, other: Any) -> Choice: return Choice(self.value < self._other(other).value)
    def __gt__(self, other: Any) -> Choice: return Choice(self.value > self._other(other).value)
    def __le__(self, other: Any) -> Choice: return Choice(self.value <= self._other(other).value)
    def __ge__(self, other: Any) -> Choice: return Choice(self.value >= self._other(other).value)

    def _smooth(self, value: float, slope: float) -> "Bounded": return self._rounded(value, slope * self.error)
    def sin(self) -> "Bounded": return self._smooth(math.sin(self.value), 1)
    def cos(self) -> "Bounded": return self._smooth(math.cos(self.value), 1)
    def atan(self) -> "Bounded": return self._smooth(math.atan(self.value), 1)
    def tanh(self) -> "Bounded": return self._smooth(math.tanh(self.value), 1)
    def exp(self) -> "Bounded": return self._smooth(math.exp(self.value), math.exp(self.value + self.error))
    def log(self) -> "Bounded": return self._smooth(math.log(self.value), 1 / (self.value - self.error))
    def sqrt(self) -> "Bounded": return self._smooth(math.sqrt(self.value), 0.5 / math.sqrt(self.value - self.error))

    def tan(self) -> "Bounded":
        worst = abs(self.value) + self.error
        return self._smooth(math.tan(self.value), 1 / math.cos(worst) ** 2)

    def _rounded(self, value: float, error: float) -> "Bounded":
        return type(self)(value, error + ULPS * self.eps * abs(value) + self.least)


class Single(Bounded):
    """The same for evaluation in float32, of a constant too."""

    eps, least = 2.0**-23, 2.0**-149

    @classmethod
    def constant(cls, x: float) -> "Single": return cls(x, cls.eps / 2 * abs(x))

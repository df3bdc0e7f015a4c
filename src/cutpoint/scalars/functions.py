"""Functions that the equations apply to a scalar of any kind.

A scalar is a float, a NumPy array (a batch), a time jet, a SymPy expression or a traced value; it brings + - * /.
Write whole numbers as integers (2 * x, x / 2): they stay exact for SymPy and fold when traced.
"""

import math
import sys
from typing import Any

import numpy as np

from cutpoint.errors import InputError

Scalar = Any
"""A number of any kind that offers + - * /; no protocol can say more without naming every kind."""


def is_plain_zero(x: Scalar) -> bool:
    """Whether it is a whole number 0: known to be 0 when traced."""
    return isinstance(x, int) and x == 0


def _apply(name: str, x: Scalar) -> Scalar:
    if isinstance(x, (int, float)):
        try:
            return getattr(math, name)(x)
        except (ValueError, OverflowError):  # Python raises where IEEE 754 gives infinity or NaN
            with np.errstate(all="ignore"):
                return float(getattr(np, name)(x))
    if isinstance(x, (np.ndarray, np.generic)):
        return getattr(np, "arctan" if name == "atan" else name)(x)
    if type(x).__module__.partition(".")[0] == "sympy":
        return getattr(sys.modules["sympy"], name)(x)
    own = getattr(x, name, None)  # a jet or a traced value knows its own
    if own is None:
        raise InputError(f"{name} takes a number of any kind or an array of them, not a {type(x).__name__}")
    return own()


def sin(x: Scalar) -> Scalar:
    """Sine of an angle, rad."""
    return _apply("sin", x)


def cos(x: Scalar) -> Scalar:
    """Cosine of an angle, rad."""
    return _apply("cos", x)


def tan(x: Scalar) -> Scalar:
    """Tangent of an angle, rad."""
    return _apply("tan", x)


def atan(x: Scalar) -> Scalar:
    """Angle, rad, whose tangent is x."""
    return _apply("atan", x)


def atan2(y: Scalar, x: Scalar) -> Scalar:
    """Angle, rad, of the point (x, y) from the x axis, above -pi and up to pi; 0 at the origin."""
    if any(type(n).__module__.partition(".")[0] == "sympy" for n in (y, x)):
        return sys.modules["sympy"].atan2(y, x)
    if _holds_objects(y) or _holds_objects(x):
        return np.frompyfunc(atan2, 2, 1)(y, x)
    is_steep = absolute(x) < absolute(y)
    along, across = where(is_steep, y, x), where(is_steep, x, y)
    angle = atan(across / where(absolute(along) <= 0, 1, along))
    flat = where(x < 0, angle + where(y < 0, -math.pi, math.pi), angle)
    return where(is_steep, where(y < 0, -math.pi / 2, math.pi / 2) - angle, flat)


def asin(x: Scalar) -> Scalar:
    """Angle, rad, whose sine is x."""
    return atan2(x, sqrt((1 - x) * (1 + x)))


def acos(x: Scalar) -> Scalar:
    """Angle, rad, whose cosine is x."""
    return atan2(sqrt((1 - x) * (1 + x)), x)


def exp(x: Scalar) -> Scalar:
    """e to the power x."""
    return _apply("exp", x)


def log(x: Scalar) -> Scalar:
    """Natural logarithm."""
    return _apply("log", x)


def tanh(x: Scalar) -> Scalar:
    """Hyperbolic tangent."""
    return _apply("tanh", x)


def sqrt(x: Scalar) -> Scalar:
    """Square root."""
    return _apply("sqrt", x)


def known_truth(condition: Any) -> bool | None:
    """The truth of a condition that is already known; None for others.

    Python's ~, & and | turn bools into integers, with the truth in the last bit: ~True is -2.
    """
    if isinstance(condition, (bool, np.bool_)):
        return bool(condition)
    return bool(condition & 1) if isinstance(condition, int) and -2 <= condition <= 1 else None


def where(condition: Any, yes: Scalar, no: Scalar) -> Scalar:
    """`yes` where the condition holds, else `no`.  Both sides are evaluated: guard the argument, not the result."""
    known = known_truth(condition)
    if known is not None:
        return yes if known else no
    if any(map(_holds_objects, (condition, yes, no))):
        return _where_each(condition, yes, no)
    outermost = max((condition, yes, no), key=lambda x: getattr(x, "level", 0))
    if getattr(outermost, "level", 0):  # a jet of traced values is a jet
        return outermost.where(condition, yes, no)
    if type(condition).__module__.partition(".")[0] == "sympy":
        return sys.modules["sympy"].Piecewise((yes, condition), (no, True))
    return np.where(condition, yes, no)


_where_each = np.frompyfunc(where, 3, 1)


def _holds_objects(x: Scalar) -> bool:
    """Whether x is an array of scalars of other kinds than NumPy's."""
    return isinstance(x, np.ndarray) and x.dtype == object


def _is_less(x: Scalar, y: Scalar) -> Any:
    """x < y; of arrays of any scalars an array of conditions."""
    return np.less(x, y, dtype=object) if _holds_objects(x) or _holds_objects(y) else x < y


def absolute(x: Scalar) -> Scalar:
    """The absolute value of x; -0.0 stays -0.0."""
    return where(_is_less(x, 0), -x, x)


def minimum(x: Scalar, y: Scalar) -> Scalar:
    """The lesser of the two; NaN where x is NaN, x where y is."""
    return where(_is_less(y, x), y, x)


def maximum(x: Scalar, y: Scalar) -> Scalar:
    """The greater of the two; NaN where x is NaN, x where y is."""
    return where(_is_less(x, y), y, x)


def clip(x: Scalar, low: Scalar, high: Scalar) -> Scalar:
    """x, or the bound that it exceeds; NaN where x is NaN."""
    return minimum(maximum(x, low), high)

"""What a traced number cannot do, reported at the user's line with what to write instead."""

import sys
import threading
from numbers import Real
from typing import Any, NoReturn

from cutpoint.callers import user_place
from cutpoint.errors import TraceError

_OURS = {
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "tanh", "sqrt", "absolute", "maximum",
    "minimum", "clip", "where",
}  # fmt: skip
_RENAMED = {
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "fabs": "absolute", "fmax": "maximum",
    "fmin": "minimum",
}  # fmt: skip

_FINITE = "write cutpoint.absolute(x) < 1e30, which is false of NaN and infinity"
_INSTEAD = {
    "isfinite": _FINITE, "isnan": _FINITE, "isinf": _FINITE,
    "sign": "write cutpoint.where(x > 0, 1.0, -1.0)",
    **dict.fromkeys(("floor", "ceil", "trunc", "rint"), "use it outside the kernel"),
}  # fmt: skip

NO_NUMBER = "a condition is no number: write cutpoint.where(condition, 1.0, 0.0)"


class _Told(threading.local):
    """Number of refusals in this thread, including caught ones."""

    count = 0


_told = _Told()


def refusals() -> int:
    """Number of refusals in this thread so far: if it grew during a call that raised none, one was caught within."""
    return _told.count


def refuse(message: str) -> NoReturn:
    """Raises a TraceError that points at the user's line."""
    _told.count += 1
    raise TraceError(message, place=user_place())


class Refusals:
    """Python's requests for a truth value, a float or an identity, which a traced number does not have."""

    __slots__ = ()

    def __bool__(self) -> NoReturn:
        refuse(
            "a traced number has no truth value yet, so `if`, `while`, `and`, `or`, `not`, `min`, `max` and NumPy's "
            "clip, maximum, where and sign cannot be compiled; write cutpoint.where(x > 0, yes, no), cutpoint.clip, "
            "maximum, minimum or absolute, `&`, `|`, `~` between conditions, and a constant number of passes for a "
            "loop; all take arrays, which are compared by np.less(x, y, dtype=object)"
        )

    def __float__(self) -> NoReturn:
        refuse(
            "a traced number has no value yet: use cutpoint.sin, cutpoint.sqrt, ... instead of float() and math's, and "
            "fill arrays made with dtype=object"
        )

    __int__ = __index__ = __complex__ = __float__

    def __eq__(self, other: object) -> NoReturn:
        refuse("a traced number has no value yet, so == and != have no meaning; compare with < or <=, or use `is`")

    __ne__ = __eq__
    __hash__ = object.__hash__  # by identity, so that dictionaries and sets can still hold traced numbers

    def __mod__(self, other: object) -> NoReturn:
        refuse(
            "// and % of a traced number cannot be compiled; "
            "wrap an angle x with 2 * cutpoint.atan(cutpoint.tan(x / 2)), or outside the kernel"
        )

    def __round__(self, *digits: object) -> NoReturn:
        refuse("round, floor, ceil and trunc of a traced number cannot be compiled; use them outside the kernel")

    __floor__ = __ceil__ = __trunc__ = __round__

    __rmod__ = __floordiv__ = __rfloordiv__ = __divmod__ = __mod__


def refuse_numpy(name: str) -> NoReturn:
    """Raises TraceError for a NumPy function applied to a traced number."""
    refuse(f"np.{name} cannot be applied to a traced number; {instead_of(name)}")


def instead_of(name: str) -> str:
    """What to write for a function of NumPy."""
    ours = _RENAMED.get(name, name)
    return f"use cutpoint.{ours}" if ours in _OURS else _INSTEAD.get(name, "write it out with cutpoint's functions")


def as_float(x: float | Real) -> float:
    """The number as a float.  Raises TraceError if it is too large."""
    try:
        return float(x)
    except OverflowError:
        told = f"a constant of a kernel is a float, at most {sys.float_info.max:.2g}"
        refuse(f"{told}; this {type(x).__name__} is larger")


def refuse_operand(other: Any) -> NoReturn:
    """Raises TraceError: the operand is not a number."""
    refuse(
        f"a traced number cannot be combined with a {type(other).__name__}, only with ints, floats and traced numbers"
    )

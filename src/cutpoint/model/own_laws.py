"""Trials of spring and friction laws that users wrote: what their equations would otherwise only show as wrong numbers.

Laws are open, so a few plain numbers stand for all: small torques and speeds, which any law must bear.
"""

from collections.abc import Iterator
from numbers import Real
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.scalars import Jet

SMALL = 1e-6
"""A deflection, rad (m), at which the torque shows the spring's stiffness at rest."""

DEFLECTIONS = (1.1e-5, 1.1e-4, 1.1e-3)
"""What the torques of the trial would wind up at that stiffness, rad (m): not round, as corners of a law may be."""

SPEEDS = (0.0, 0.011, -0.011, 1.1, -1.1)
"""rad/s (m/s)"""

EXACT, STEP, SLOPE = 1e-6, 1e-4, 1e-3
"""Relative errors that an inverse and a slope may have; relative step of the difference quotients for slopes."""


def is_own(law: Any) -> bool:
    """Whether a law is not one of the package, which the package's tests try."""
    return type(law).__module__.partition(".")[0] != "cutpoint"


def wrong_in_spring(spring: Any) -> Iterator[str]:
    """What a spring law of the user's own breaks: an odd, increasing torque, its inverse, slope and integral."""
    with np.errstate(all="ignore"):
        try:
            yield from _wrong_in_spring(spring)
            for method in ("torque", "deflection", "tangent", "energy"):
                _check_takes_scalars(spring, method, np.array([SMALL, -SMALL]))
        except _UnfitError as unfit:
            yield str(unfit)


def wrong_in_friction(law: Any) -> Iterator[str]:
    """What a friction law of the user's own breaks: a torque that is a number, and is linear in its `coefficients`."""
    with np.errstate(all="ignore"):
        try:
            for speed in SPEEDS:
                torque = _finite(law, "torque", speed)
                _number(law, "share_of_load", speed)
                for method in ("torque", "resistance"):
                    _number(law, method, speed, 0.0)
                if getattr(law, "coefficients", ()):
                    yield from _not_linear(law, speed, torque)
            speeds, unloaded = np.array(SPEEDS), np.zeros(len(SPEEDS))
            _check_takes_scalars(law, "share_of_load", speeds)
            for method in ("torque", "resistance"):
                _check_takes_scalars(law, method, speeds, unloaded)
        except _UnfitError as unfit:
            yield str(unfit)


class _UnfitError(Exception):
    """A law gives no number; its text says so."""


def _wrong_in_spring(spring: Any) -> Iterator[str]:
    stiffness = _finite(spring, "torque", SMALL) / SMALL
    if stiffness <= 0.0:
        yield f"torque({SMALL:g}) is {stiffness * SMALL:g}, but must be positive: it pulls a motor that leads back"
        return
    for size in DEFLECTIONS:
        torque = stiffness * size
        x, opposite = (_number(spring, "deflection", sign * torque) for sign in (1, -1))
        if size > DEFLECTIONS[0] and not np.isfinite(x):
            return  # a law may have a largest torque
        told = f"deflection({torque:.10g}) is {x:.10g}"
        if not _alike(back := _number(spring, "torque", x), torque, EXACT):
            yield f"{told}, but torque({x:.10g}) is {back:.10g}: deflection must be the exact inverse of torque"
        if not _alike(opposite, -x, EXACT):
            yield f"{told}, but deflection({-torque:.10g}) is {opposite:.10g}: a spring's law must be odd"
        for integral, slope in (("torque", "tangent"), ("energy", "torque")):
            stated, found = _number(spring, slope, x), _slope(spring, integral, x)
            if not _alike(stated, found, SLOPE):
                rises = f"but {integral} rises there by {found:.6g} per unit: they must agree"
                yield f"{slope}({x:.6g}) is {stated:.6g}, {rises}"


def _not_linear(law: Any, speed: float, torque: float) -> Iterator[str]:
    try:
        parts = [x * getattr(law, name) for name, x in zip(law.coefficients, law.columns(speed), strict=True)]
    except Exception as problem:
        raise _UnfitError(f"its torque fails with a coefficient of 0: {_said(problem)}") from problem
    if not _alike(sum(parts), torque, EXACT):
        rule = "its torque must be linear in its `coefficients`, and zero where they are (or state () for none)"
        yield f"{rule}: torque({speed:g}) is {torque:.10g}, but their parts of it are {sum(parts):.10g} in all"


def _alike(x: float, y: float, error: float) -> bool:
    return bool(np.isclose(x, y, rtol=error, atol=0.0))


def _slope(law: Any, method: str, x: float) -> float:
    above, below = (_number(law, method, x * (1 + step)) for step in (STEP, -STEP))
    return (above - below) / (2 * STEP * x)


def _finite(law: Any, method: str, x: float) -> float:
    if not np.isfinite(y := _number(law, method, x)):
        raise _UnfitError(f"{method}({x:g}) is {y}, which is not a finite number")
    return y


def _number(law: Any, method: str, *numbers: float) -> float:
    """Raises _UnfitError for what is none; it may be nan."""
    called = f"{method}({', '.join(f'{x:g}' for x in numbers)})"
    try:
        y = getattr(law, method)(*numbers)
    except Exception as problem:
        raise _UnfitError(f"{called} fails: {_said(problem)}") from problem
    if not isinstance(y, Real) and not (isinstance(y, np.ndarray) and y.ndim == 0):
        raise _UnfitError(f"{called} gives {y!r}: it must give a number")
    return float(y)


def _check_takes_scalars(law: Any, method: str, *arrays: Array) -> None:
    """Raises _UnfitError for an equation that fails with arrays, or with numbers and their rates: it has an `if`, or
    functions of `math` or NumPy, and cannot be compiled either."""
    for of, given in (("several numbers at once", arrays), ("numbers with rates", [Jet(x, x) for x in arrays])):
        try:
            getattr(law, method)(*given)
        except Exception as problem:
            remedy = "use cutpoint's functions, and cutpoint.where(condition, yes, no) for an `if`"
            told = f"{method} of {of} fails, {_said(problem)}"
            raise _UnfitError(f"{told}, so it cannot be compiled: {remedy}") from problem


def _said(problem: Exception) -> str:
    return f"{type(problem).__name__}: {problem}"

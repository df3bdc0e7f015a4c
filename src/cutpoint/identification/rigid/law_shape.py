"""Shape parameters of friction laws, besides their sizes, and steps from one shape to another."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.friction import Sliding

ONE_SIDED = 0.999
"""Largest asymmetry: of one, which leaves no friction at all backwards, a law would not be one."""

SLOW = 0.2
"""Widest smoothing of friction that does not change sign in a log, in the log's slowest speeds: up to rounding, such
friction is constant."""


def shape_of(law: Sliding) -> tuple[str, ...]:
    """Names of a law's shape parameters."""
    speeds = tuple(name for name in ("smoothing", "stribeck_velocity") if hasattr(law, name))
    return speeds if law.asymmetry is None else (*speeds, "asymmetry")


def moved(law: Any, steps: Mapping[str, float]) -> Sliding:
    """A law after steps: of speeds in their logarithms, of an asymmetry in its inverse hyperbolic tangent."""
    new = {name: _moved(name, float(getattr(law, name)), step) for name, step in steps.items()}
    return replace(law, **new)


def _moved(name: str, value: float, step: float) -> float:
    if name == "asymmetry":
        return float(np.clip(np.tanh(np.arctanh(value) + step), -ONE_SIDED, ONE_SIDED))
    return float(value * np.exp(step))


def is_sharp(law: Any, widest: float) -> bool:
    """Whether friction's sign change is complete below the Stribeck speed: otherwise a peak of any height has no effect
    on means over reversals.  And no wider than a log shows, see `widest_smoothing`."""
    return law.smoothing < getattr(law, "stribeck_velocity", np.inf) and law.smoothing <= widest


def widest_smoothing(speed: Array) -> float:
    """Bound of the smoothing of friction at speeds (N,): of a joint that moves one way only a log does not show how
    friction changes sign.  Wider, dry friction would pass for viscous, and an offset for dry friction."""
    slowest, fastest = float(np.nanmin(speed)), float(np.nanmax(speed))
    return SLOW * min(abs(slowest), abs(fastest)) if slowest * fastest > 0.0 else np.inf

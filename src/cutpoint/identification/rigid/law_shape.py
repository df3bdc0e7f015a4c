"""What shapes a law of friction beside its size, and steps from one shape to another."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cutpoint.mechanics.friction import Sliding


def shape_of(law: Sliding) -> tuple[str, ...]:
    """Names of what shapes a law."""
    speeds = tuple(name for name in ("smoothing", "stribeck_velocity") if hasattr(law, name))
    return speeds if law.asymmetry is None else (*speeds, "asymmetry")


def moved(law: Any, steps: Mapping[str, float]) -> Sliding:
    """Speeds by steps in their logarithms, an asymmetry by one in its inverse hyperbolic tangent."""
    new = {name: _moved(name, float(getattr(law, name)), step) for name, step in steps.items()}
    return replace(law, **new)


def _moved(name: str, value: float, step: float) -> float:
    return float(np.tanh(np.arctanh(value) + step) if name == "asymmetry" else value * np.exp(step))


def is_sharp(law: Any) -> bool:
    """Whether friction has changed its sign by Stribeck's speed: else a peak of any height between is as good as none,
    for means over the moments in which a joint turns back."""
    return law.smoothing < getattr(law, "stribeck_velocity", np.inf)

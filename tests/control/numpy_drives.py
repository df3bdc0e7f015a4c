"""Springs and friction of drives, written down once more in NumPy."""

from typing import Any

import numpy as np

from cutpoint import Coulomb, LinearSpring, Stribeck
from robot_library import Array


def friction(law: Any, wanted: float, actual: float) -> float:
    """Xia (2019) eqs. (54)-(55), sgn smoothed to tanh, viscous friction at its reference temperature.

    The Stribeck bump is that of the actual speed.
    """
    if law is None:
        return 0.0
    return float(np.dot(coefficients(law), columns(law, wanted, actual)))


def columns(law: Any, wanted: float, actual: float) -> list[float]:
    """What friction is for each of its coefficients at one."""
    if law is None:
        return []
    sign = np.tanh(wanted / law.smoothing)
    if isinstance(law, Coulomb):
        return [sign, wanted]
    bump = np.exp(-((actual / law.stribeck_velocity) ** 2))
    return [(1 - bump) * sign, bump * sign, wanted]


def coefficients(law: Any) -> list[float]:
    names = {Coulomb: ["coulomb", "viscous"], Stribeck: ["coulomb", "static", "viscous"], type(None): []}[type(law)]
    return [getattr(law, name) for name in names]


def spring(law: Any, wound: float) -> tuple[float, float]:
    """tau_f of a deflection, Xia (2019) eq. (2) short of its guard, or of a linear spring; and its slope."""
    if isinstance(law, LinearSpring):
        return law.stiffness * wound, law.stiffness
    x = np.tan(wound * law.hardening * law.stiffness)
    return x / law.hardening, law.stiffness * (1 + x * x)


def winding(law: Any, tau: float, rate: float, rate_2: float) -> Array:
    """The deflection that a torque makes, and its two time derivatives."""
    if isinstance(law, LinearSpring):
        return np.array([tau, rate, rate_2]) / law.stiffness
    y, K = law.hardening * tau, law.stiffness * (1 + (law.hardening * tau) ** 2)
    bend = rate_2 - 2 * law.hardening * y / (1 + y * y) * rate**2
    return np.array([np.arctan(y) / (law.hardening * law.stiffness), rate / K, bend / K])

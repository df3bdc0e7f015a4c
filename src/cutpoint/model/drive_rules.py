"""Kinds of a drive's parts, and rules for their single numbers: one table per part.

Parts within a part, such as the spring behind a backlash, share its table.  Laws are open: a field of a user's own law
with a name from its part's table has the same meaning.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any

import numpy as np

from cutpoint.model.drive import Compliance, Friction, Hysteresis, KinematicError, Motor, Ratings, Rotor
from cutpoint.model.mechanism import Limits


@dataclass(frozen=True)
class Rule:
    """words: the message after a value that breaks the rule.  each: applies to every number of a tuple."""

    words: str
    holds: Callable[[Any], bool]
    number: bool = True
    infinite: bool = False
    each: bool = False

    def complaint(self, field: str, value: Any) -> str | None:
        """What is wrong with the value of a field, if anything."""
        if self.each and not (isinstance(value, tuple) and value):
            return f"{field} must be a tuple of numbers, one for each element, got {value!r}"
        numbers: tuple[Any, ...] = value if self.each else (value,)
        for x in numbers:
            if self.number and not is_number(x):
                return f"{field} must be a number, got {x!r}"
            if self.number and not (self.infinite or math.isfinite(x)):
                return f"its drive has {x} as {field}; every number must be finite"
            if not self.holds(x):
                return f"{field} {x if self.number else repr(x)} {self.words}"
        return None


def is_number(value: Any) -> bool:
    """Whether it is a real number; a bool is not."""
    return isinstance(value, Real) and not isinstance(value, bool)


NUMBER = Rule("", lambda x: True)
POSITIVE = Rule("must be positive", lambda x: x > 0)
HARDENING = Rule("must be positive, and at least 1e-100 1/(N m)", lambda x: x >= 1e-100)
NOT_NEGATIVE = Rule("must not be negative", lambda x: x >= 0)
WHOLE = Rule("must be a whole number above 0", lambda x: x >= 1 and x == int(x))
SHARE = Rule("must be at least 0 and below 1", lambda x: 0 <= x < 1)
LEANING = Rule("must be between -1 and 1", lambda x: -1 < x < 1)
RATIO = Rule("must be between 1e-12 and 1e12 in magnitude, as in any machine", lambda x: 1e-12 <= abs(x) <= 1e12)
INERTIA = Rule("must not be negative, and at most 1e12 kg m2, as in any machine", lambda x: 0 <= x <= 1e12)
CELSIUS = Rule("must be above -273.15 and at most 200 deg C, not in kelvin", lambda x: -273.15 < x <= 200)
THINNING = Rule("must not be negative, and at most 0.3 1/K", lambda x: 0 <= x <= 0.3)
BOUND, POSITIVE_BOUND = (replace(rule, infinite=True) for rule in (NUMBER, POSITIVE))
TRUTH = Rule("must be True or False", lambda x: isinstance(x, (bool, np.bool_)), number=False)
COUPLING = Rule("must be 'reduced' or 'full'", lambda x: x in ("reduced", "full"), number=False)


def _all(rule: Rule, names: str) -> dict[str, Rule]:
    return dict.fromkeys(names.split(), rule)


_FRICTION = (
    _all(POSITIVE, "stribeck_velocity smoothing distance")
    | _all(NOT_NEGATIVE, "coulomb static viscous damping per_load")
    | {"temperature": CELSIUS, "thinning": THINNING, "asymmetry": LEANING, "elastic": SHARE}
)

RULES: dict[str, dict[str, Rule]] = {
    "drive": {"ratio": RATIO, "damping": NOT_NEGATIVE},
    "rotor": {"position": NUMBER, "in_link_inertia": TRUTH, "coupling": COUPLING, "mass": NOT_NEGATIVE}
    | _all(INERTIA, "inertia transverse"),
    "compliance": _all(POSITIVE, "stiffness ratio blend k1 k2 k3 t1 t2 gap") | {"hardening": HARDENING},
    "link_friction": _FRICTION,
    "motor_friction": _FRICTION,
    "hysteresis": _all(replace(POSITIVE, each=True), "stiffness reach"),
    "wave": {"order": WHOLE, "amplitude": NOT_NEGATIVE, "phase": NUMBER},
    "motor": {"delay": NOT_NEGATIVE}
    | _all(POSITIVE, "torque_constant resistance bandwidth current_limit voltage_limit"),
    "limits": _all(BOUND, "lower upper") | _all(POSITIVE_BOUND, "velocity effort"),
    "ratings": _all(POSITIVE, "rated_torque average_torque repeated_peak_torque momentary_peak_torque life")
    | _all(POSITIVE, "rated_speed average_speed maximum_speed continuous_current"),
}  # fmt: skip

KINDS: dict[str, type] = {
    "rotor": Rotor, "compliance": Compliance, "link_friction": Friction, "motor_friction": Friction, "limits": Limits,
    "kinematic_error": KinematicError, "hysteresis": Hysteresis, "motor": Motor, "ratings": Ratings,
}  # fmt: skip
"""Of a drive's parts."""

OFFERED = {
    Compliance: ", such as LinearSpring or Flexspline",
    Friction: ", such as Coulomb or Stribeck",
}
"""Kinds that are no class to make one of."""

WITHIN = {
    "spring": ("torque", "deflection", "tangent", "energy"), "flexspline": ("torque", "deflection", "tangent"),
    "wave_generator": ("deflection", "compliance"), "sliding": ("plateau", "torque"),
    "grease": ("temperature", "thinning"),
}  # fmt: skip
"""Parts of laws, and what the laws ask of them."""

WAVES = ("harmonics", "ripple", "cogging")

RISING = (("lower", "upper"), ("t1", "t2"))
"""Numbers of one part, of which the second must be above the first."""

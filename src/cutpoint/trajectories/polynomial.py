"""Polynomial motions from one position to another: the quintic and the septic.

The profile of degree 2 m + 1 whose first m derivatives vanish at both ends, e.g. Biagiotti and Melchiorri (2008),
Trajectory Planning for Automatic Machines and Robots, section 2.1.
"""

from typing import ClassVar

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.trajectories.point_to_point import PointToPoint


class Polynomial(PointToPoint):
    """s(u) is the polynomial with these coefficients, lowest power first."""

    coefficients: ClassVar[tuple[float, ...]]

    def _profile(self, u: Array, k: int) -> Array:
        return np.asarray(polynomial.polyval(u, polynomial.polyder(self.coefficients, k)), dtype=np.float64)


class Quintic(Polynomial):
    """s(u) = 10 u^3 - 15 u^4 + 6 u^5."""

    coefficients = (0.0, 0.0, 0.0, 10.0, -15.0, 6.0)


class Septic(Polynomial):
    """s(u) = 35 u^4 - 84 u^5 + 70 u^6 - 20 u^7."""

    coefficients = (0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0)


def quintic(end: ArrayLike, duration: float, start: ArrayLike | None = None) -> Quintic:
    """Motion to `end` (n,), rad (m), in `duration` s, from `start` (n,) or zero.

    Velocity and acceleration are zero at both ends.  The jerk is not: an elastic joint's motor reference starts with
    a jump in velocity, which `septic` avoids.  Derivatives of any order are exact; those above the fifth are zero.

    Raises:
        InputError: a duration that is not positive, or positions that are not finite or do not match.
    """
    return Quintic.between(start, end, duration)


def septic(end: ArrayLike, duration: float, start: ArrayLike | None = None) -> Septic:
    """Motion to `end` (n,), rad (m), in `duration` s, from `start` (n,) or zero.

    Velocity, acceleration and jerk are zero at both ends; the snap is not.  Derivatives of any order are exact; those
    above the seventh are zero.

    Raises:
        InputError: a duration that is not positive, or positions that are not finite or do not match.
    """
    return Septic.between(start, end, duration)

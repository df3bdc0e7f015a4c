"""The cycloidal motion from one position to another."""

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.trajectories.point_to_point import PointToPoint

TURN = np.float64(2.0 * np.pi)


class Cycloid(PointToPoint):
    """s(u) = u - sin(2 pi u) / (2 pi).  Xia (2019) eq. (57)."""

    def _profile(self, u: Array, k: int) -> Array:
        # derivatives of sin alternate with cos, and change sign every second time
        sign = 1.0 if k % 4 < 2 else -1.0
        wave = np.cos(TURN * u) if k % 2 else np.sin(TURN * u)
        line = u if k == 0 else float(k == 1)
        return line - sign * TURN ** (k - 1) * wave


def cycloid(end: ArrayLike, duration: float, start: ArrayLike | None = None) -> Cycloid:
    """Cycloidal motion to `end` (n,), rad (m), in `duration` s, from `start` (n,) or zero.  Xia (2019) eq. (57).

    Velocity and acceleration are zero at both ends.  The jerk there is 4 pi^2 (end - start) / duration^3: an elastic
    joint's motor reference starts with a jump in velocity.  Derivatives of any order are exact.

    Raises:
        InputError: a duration that is not positive, or positions that are not finite or do not match.
    """
    return Cycloid.between(start, end, duration)

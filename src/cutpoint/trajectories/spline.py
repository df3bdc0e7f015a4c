"""Trajectories that are splines."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from cutpoint.trajectories.arrays import Array
from cutpoint.trajectories.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Spline(Trajectory):
    """A start (n,) plus a spline in the time t / unit, its coefficients (m, n); derivatives above its degree are zero.

    The unit, s, keeps the numbers of the spline near one, whatever the times are; the start apart keeps a joint that
    does not move at exactly zero velocity.
    """

    start: Array
    spline: BSpline
    unit: float

    @property
    def size(self) -> int:
        return self.spline.c.shape[1]

    def _inside(self, t: Array, order: int) -> Array:
        found = np.zeros((order + 1, *t.shape, self.size))
        unit = np.float64(self.unit)  # whose powers may be infinite
        for k in range(min(order, self.spline.k) + 1):
            found[k] = self.spline(t / unit, nu=k) / unit**k
        found[0] += self.start
        return found

"""Trajectories that are splines."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.trajectories.arrays import joint_name
from cutpoint.trajectories.trajectory import Trajectory

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

LOOKS = 16
"""Places in each interval where the swing is looked at."""


@dataclass(frozen=True, eq=False)
class Spline(Trajectory):
    """A start (n,) plus a spline in the time t / unit, its coefficients (m, n); derivatives above its degree are zero.

    The unit, s, keeps the spline's numbers near one for any times; the separate start keeps a joint that does not move
    at exactly zero velocity.
    """

    start: Array
    spline: "BSpline"
    unit: float

    @property
    def size(self) -> int:
        return self.spline.c.shape[1]

    def _inside(self, t: Array, order: int) -> Array:
        found = np.zeros((order + 1, *t.shape, self.size))
        unit = np.float64(self.unit)  # its powers may be infinite
        for k in range(min(order, self.spline.k) + 1):
            found[k] = self.spline(t / unit, nu=k) / unit**k
        found[0] += self.start
        return found


def check_swing(spline: "BSpline", u: Array, q: Array, remedy: str, joints: Sequence[str] | None = None) -> None:
    """Raises InputError if the curve q[0] + spline leaves its points q (N, n), at u (N,), by more than their range."""
    between = u[:-1, None] + np.diff(u)[:, None] * np.linspace(0.0, 1.0, LOOKS, endpoint=False)
    reached = q[0] + spline(between.ravel())
    low, high = q.min(axis=0), q.max(axis=0)
    past = np.maximum((reached - high).max(axis=0), (low - reached).max(axis=0))
    calm = past <= (high - low) + 1e-9 * np.abs(q).max()
    if not calm.all():
        joint = int(np.argmin(calm))
        raise InputError(
            f"{joint_name(joints, joint)}: the curve would swing {past[joint]:.3g} rad (m) past its points, which lie "
            f"between {low[joint]:.3g} and {high[joint]:.3g}; {remedy}",
            joint=joint,
            past=float(past[joint]),
        )

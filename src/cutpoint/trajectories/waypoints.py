"""A motion through given points at given times."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, make_interp_spline

from cutpoint.errors import InputError
from cutpoint.trajectories.arrays import Array, timed_positions
from cutpoint.trajectories.spline import Spline

DEGREE = 5
"""The lowest with four continuous derivatives; a higher one swings further past uneven points."""

LOOKS = 16
"""Places in each interval where the swing is looked at."""


def waypoints(times: ArrayLike, points: ArrayLike) -> Spline:
    """A quintic spline through `points` (N, n), rad (m), at `times` (N,), s, at rest at its first and last point.

    Between its points it is the classical interpolating spline, e.g. Biagiotti and Melchiorri (2008), Trajectory
    Planning for Automatic Machines and Robots, chapter 4.  Velocity, acceleration, jerk and snap are continuous
    everywhere, and zero at both ends, where it joins the standstill.  Times count from the first point's.

    Raises:
        InputError: fewer than 2 points, times that do not increase, numbers that are not finite, shapes that do not
            match, or times so uneven that a joint would swing past its points by more than their own range.
    """
    t, q = timed_positions(times, points, least=2)
    unit = float(t[-1] / (t.size - 1))
    u = t / unit
    at_rest = [(k, np.zeros(q.shape[1])) for k in range(1, 5)]
    spline = make_interp_spline(u, q - q[0], k=DEGREE, t=_knots(u), bc_type=(at_rest, at_rest))
    _check_swing(spline, u, q)
    return Spline(float(t[-1]), q[0], spline, unit)


def _knots(u: Array) -> Array:
    """A knot at each point, and two more at each end, which its rest up to the snap needs."""
    if u.size == 2:
        inner = u[0] + (u[1] - u[0]) * np.arange(1, 5) / 5.0
    else:
        third = np.array([1.0, 2.0]) / 3.0
        inner = np.concatenate([u[0] + (u[1] - u[0]) * third, u[1:-1], u[-2] + (u[-1] - u[-2]) * third])
    return np.concatenate([np.repeat(u[0], DEGREE + 1), inner, np.repeat(u[-1], DEGREE + 1)])


def _check_swing(spline: BSpline, u: Array, q: Array) -> None:
    between = u[:-1, None] + np.diff(u)[:, None] * np.linspace(0.0, 1.0, LOOKS, endpoint=False)
    reached = q[0] + spline(between.ravel())
    low, high = q.min(axis=0), q.max(axis=0)
    past = np.maximum((reached - high).max(axis=0), (low - reached).max(axis=0))
    calm = past <= (high - low) + 1e-9 * np.abs(q).max()
    if not calm.all():
        joint = int(np.argmin(calm))
        raise InputError(
            f"joint {joint}: the curve would swing {past[joint]:.3g} rad (m) past its points, which lie between "
            f"{low[joint]:.3g} and {high[joint]:.3g}; give far points more time, near ones less, or add points between",
            joint=joint,
            past=float(past[joint]),
        )

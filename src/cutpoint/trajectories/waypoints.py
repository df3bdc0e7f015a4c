"""A motion through given points at given times."""

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.trajectories.arrays import timed_positions
from cutpoint.trajectories.spline import Spline, check_swing

DEGREE = 5
"""The lowest with four continuous derivatives; a higher one swings further past uneven points."""


def waypoints(times: ArrayLike, points: ArrayLike) -> Spline:
    """A quintic spline through `points` (N, n), rad (m), at `times` (N,), s, at rest at its first and last point.

    Between its points it is the classical interpolating spline, e.g. Biagiotti and Melchiorri (2008), Trajectory
    Planning for Automatic Machines and Robots, chapter 4.  Velocity, acceleration, jerk and snap are continuous
    everywhere, and zero at both ends, where it joins the standstill.  Times count from the first point's.

    Raises:
        InputError: fewer than 2 points, times that do not increase, numbers that are not finite, shapes that do not
            match, or times so uneven that a joint would swing past its points by more than their own range.
    """
    from scipy.interpolate import make_interp_spline  # slow to import

    t, q = timed_positions(times, points, least=2)
    unit = float(t[-1] / (t.size - 1))
    u = t / unit
    at_rest = [(k, np.zeros(q.shape[1])) for k in range(1, 5)]
    try:
        spline = make_interp_spline(u, q - q[0], k=DEGREE, t=_knots(u), bc_type=(at_rest, at_rest))
    except (ValueError, np.linalg.LinAlgError) as error:
        found = f"{np.diff(t).min():.3g} s between two times of {t[-1]:.3g} s in all are too uneven for a curve"
        raise InputError(f"waypoints: {found}; leave out points, or give them more time") from error
    check_swing(spline, u, q, "give far points more time, near ones less, or add points between")
    return Spline(float(t[-1]), q[0], spline, unit)


def _knots(u: Array) -> Array:
    """A knot at each point, and two more at each end for rest up to the snap."""
    if u.size == 2:
        inner = u[0] + (u[1] - u[0]) * np.arange(1, 5) / 5.0
    else:
        third = np.array([1.0, 2.0]) / 3.0
        inner = np.concatenate([u[0] + (u[1] - u[0]) * third, u[1:-1], u[-2] + (u[-1] - u[-2]) * third])
    return np.concatenate([np.repeat(u[0], DEGREE + 1), inner, np.repeat(u[-1], DEGREE + 1)])

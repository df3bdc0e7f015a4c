"""From uneven times to a uniform grid, never across a gap."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from cutpoint.errors import InputError

Array = NDArray[np.float64]

GAP = 2.5
"""Periods: a step longer than that is a gap, in which nothing is known.  One lost sample is bridged."""

MOST_SAMPLES = 50_000_000
"""Samples of a grid: half a day at 1 kHz."""


def longest_step(times: Array) -> float:
    """The longest step, s, that is no gap."""
    return GAP * float(np.median(np.diff(times)))


def uniform_times(times: Array, period: float) -> Array:
    """Times (M,), s, a period apart, from the first to the last of others.

    Raises InputError: a period that is not positive, leaves less than two samples, or makes too many.
    """
    span = float(times[-1] - times[0])
    if not (np.isfinite(period) and span / MOST_SAMPLES < period <= span):
        raise InputError(f"period {period} s must be positive, and at most the {span:g} s that the times span")
    # times at which a step ends are kept although their sum rounds
    return times[0] + period * np.arange(int(span / period + 1e-6) + 1)


def on_grid(times: Array, values: Array, grid: Array) -> Array:
    """Values (N, ...) at other times (M,): cubic splines between gaps, NaN in gaps and beyond the ends.

    A column is unknown between two of its numbers that lie more than `GAP` of its periods apart, for lost samples and
    NaN alike.  What is faster than half of the grid's rate folds: low-pass first where the grid is coarser.
    """
    slack = 1e-6 * float(np.median(np.diff(times)))
    columns = values.reshape(len(values), -1)
    found = np.full((grid.size, columns.shape[1]), np.nan)
    for column, result in zip(columns.T, found.T, strict=True):
        known = np.isfinite(column)
        t, x = times[known], column[known]
        for part in _connected(t):
            inside = (grid >= t[part[0]] - slack) & (grid <= t[part[-1]] + slack)
            result[inside] = _interpolated(t[part], x[part], grid[inside])
    return found.reshape(grid.size, *values.shape[1:])


def _connected(times: Array) -> list[NDArray[np.intp]]:
    """The samples of each stretch between gaps."""
    if times.size < 2:
        return [np.arange(times.size)] if times.size else []
    return np.split(np.arange(times.size), np.flatnonzero(np.diff(times) > longest_step(times)) + 1)


def _interpolated(times: Array, values: Array, at: Array) -> Array:
    """A cubic spline through the values, a line through less than four of them."""
    if times.size < 4:
        return np.interp(at, times, values)
    return CubicSpline(times, values)(at)

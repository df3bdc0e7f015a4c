"""From uneven times to a uniform grid, never across a gap."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from cutpoint.arrays import Array
from cutpoint.errors import InputError

GAP = 2.5
"""Periods: a longer step is a gap, in which nothing is known.  A single lost sample is bridged."""

CLOSE = 0.25
"""Periods: samples closer than this are averaged.  A spline through both would follow their noise: at a period of 8 ms
with 2 ms of jitter the noise grows 3.4 times, and 190 times at the worst; averaged, 1.06 times."""

MOST_SAMPLES = 50_000_000
"""Largest number of samples of a grid: half a day at 1 kHz."""


def longest_step(times: Array) -> float:
    """The longest step, s, that is not a gap."""
    return GAP * float(np.median(np.diff(times)))


def uniform_times(times: Array, period: float) -> Array:
    """Times (M,), s, a period apart, from the first to the last of given ones.

    Raises InputError: a period that is not positive, or gives fewer than two samples or too many.
    """
    span = float(times[-1] - times[0])
    if not (np.isfinite(period) and span / MOST_SAMPLES < period <= span):
        raise InputError(f"period {period} s must be positive, and at most the {span:g} s that the times span")
    # a last time at the end of a step is kept despite rounding
    return times[0] + period * np.arange(int(span / period + 1e-6) + 1)


def on_grid(times: Array, values: Array, grid: Array, bridge: float = 0.0) -> Array:
    """Values (N, ...) at other times (M,): cubic splines between gaps, NaN in gaps and beyond the ends.

    A column is unknown between two of its numbers more than `GAP` of its periods apart, and more than the bridge, s:
    for lost samples and NaN alike.  Samples closer than `CLOSE` of them are averaged first.  Frequencies above half of
    the grid's rate alias: low-pass first if the grid is coarser.
    """
    slack = 1e-6 * float(np.median(np.diff(times)))
    columns = values.reshape(len(values), -1)
    found = np.full((grid.size, columns.shape[1]), np.nan)
    for column, result in zip(columns.T, found.T, strict=True):
        known = np.isfinite(column)
        t, x = _merged(times[known], column[known])
        for part in _connected(t, bridge):
            inside = (grid >= t[part[0]] - slack) & (grid <= t[part[-1]] + slack)
            result[inside] = _interpolated(t[part], x[part], grid[inside])
    return found.reshape(grid.size, *values.shape[1:])


def close(times: Array) -> NDArray[np.bool_]:
    """Which times (N,) are too close to the one before to count separately."""
    steps = np.diff(times)
    return np.append(False, steps < CLOSE * np.median(steps)) if steps.size else np.zeros(times.size, bool)


def _merged(times: Array, values: Array) -> tuple[Array, Array]:
    """Times and values (N,), with samples too close to the one before averaged with it."""
    own = np.cumsum(~close(times)) - 1
    count = np.bincount(own)
    return np.bincount(own, times) / count, np.bincount(own, values) / count


def _connected(times: Array, bridge: float) -> list[NDArray[np.intp]]:
    """The samples of each stretch between gaps."""
    if times.size < 2:
        return [np.arange(times.size)] if times.size else []
    longest = max(longest_step(times), bridge)
    return np.split(np.arange(times.size), np.flatnonzero(np.diff(times) > longest) + 1)


def _interpolated(times: Array, values: Array, at: Array) -> Array:
    """A cubic spline through the values, or a line through fewer than four."""
    if times.size < 4:
        return np.interp(at, times, values)
    return CubicSpline(times, values)(at)

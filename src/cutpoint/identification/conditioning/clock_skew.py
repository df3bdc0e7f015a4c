"""Delay between two channels that show the same motion."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import binary_dilation
from scipy.optimize import minimize_scalar

from cutpoint.arrays import Array
from cutpoint.door import checked_numbers, positive
from cutpoint.errors import InputError

Law = Callable[[Array, Array, Array], Array]
"""Functions that may make up x, (N, functions), given y (N, n) and its first two time derivatives."""

SLOWER = 10.0
"""Slow functions are at least this many times slower than the motion: drift, wind-up, warming."""

LARGEST_SKEW = 0.05
"""s: the largest delay that is searched."""

GRID = 21
"""Delays on the coarse grid, before the minimum is refined near the best: 5 ms apart by default."""

BLOCKS = 10
"""Blocks whose scatter gives the uncertainty."""

LEAST_SAMPLES = 100


@dataclass(frozen=True)
class Skew:
    """delay: s, by which x is later than y.  uncertainty: s, one standard deviation.  residual: RMS, in x's unit.

    The uncertainty covers errors that vary within a tenth of the recording.  An effect that follows speed throughout
    and is not in the law, such as dry friction behind a spring, biases the delay unnoticed.
    """

    delay: float
    uncertainty: float
    residual: float


def same_motion(y: Array, rate: Array, acceleration: Array) -> Array:
    """Both channels show one motion, as a motor's and a link's encoder do."""
    return y


def clock_skew(
    x: ArrayLike,
    y: ArrayLike,
    period: float,
    law: Law = same_motion,
) -> Skew:
    """The delay tau that makes x(t) = g y(t - tau) + a slow function fit best, between samples too.

    x: (N,), and y: (N,) or (N, n), on one uniform time; NaN where not known.  A positive delay: x is later than y.
    period: s between samples.
    law: other functions of y than y itself, with weights to be fitted: `single_joint_torque`, `arm_torque(robot,
    joint)`, or any of y (N, n) and its first two derivatives that returns (N, functions).

    Raises:
        InputError: channels too short, a y that does not move, or a best delay beyond LARGEST_SKEW.
    """
    period = positive("clock_skew", "period", period, "s")
    first, second = _arrays(x, y)
    largest = min(LARGEST_SKEW, period * len(first))
    used = _usable(first, second, int(np.ceil(largest / period)))
    if used.sum() < LEAST_SAMPLES:
        raise InputError(
            f"{used.sum()} common samples are too few to find a delay: at least {LEAST_SAMPLES} are needed"
        )
    if not (np.ptp(second[used], axis=0).any() and np.ptp(first[used])):
        raise InputError("a channel never changes: it shows no delay")
    functions = _delayed(second, period, law, used)
    tau = _best(lambda delay: float(np.sum(_fit(functions(delay), first[used])[1] ** 2)), largest, period)
    return _with_uncertainty(tau, first[used], functions, period)


def _delayed(y: Array, period: float, law: Law, used: NDArray[np.bool_]) -> Callable[[float], Array]:
    """The law's functions of y at a given delay, and the slow functions, (used samples, functions)."""
    time = period * np.arange(len(y), dtype=np.float64)
    known = np.isfinite(y).all(axis=1)
    spline = CubicSpline(time[known], y[known])
    slow = _slow_functions(time, spline(time, 1), period)

    def functions(tau: float) -> Array:
        then = np.clip(time - tau, *time[known][[0, -1]])
        return np.column_stack([law(*(spline(then, order) for order in range(3))), slow])[used]

    return functions


def _fit(functions: Array, x: Array) -> tuple[Array, Array]:
    """Least-squares weights of the functions that fit x, and the residual."""
    weights = np.linalg.lstsq(functions, x, rcond=None)[0].astype(np.float64)
    return weights, x - functions @ weights


def _arrays(x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
    """x (N,) and y (N, n)."""
    first, second = checked_numbers("clock_skew", "x", x), checked_numbers("clock_skew", "y", y)
    if first.ndim != 1 or second.ndim not in (1, 2) or len(second) != first.size:
        raise InputError(f"channels of shapes {first.shape} and {second.shape} must be (N,) and (N,) or (N, joints)")
    return first, second.reshape(first.size, -1)


def _usable(x: Array, y: Array, reach: int) -> NDArray[np.bool_]:
    """Samples at which x is known, and y within the largest delay around them."""
    missing = np.array(binary_dilation(~np.isfinite(y).all(axis=1), iterations=reach), dtype=np.bool_)
    missing[:reach] = missing[-reach:] = True
    return np.isfinite(x) & ~missing


def _slow_functions(time: Array, speed: Array, period: float) -> Array:
    """Cosines over the recording, up to a tenth of the motion's mean frequency; the first is constant."""
    power = np.sum(np.abs(np.fft.rfft(speed, axis=0)) ** 2, axis=1)
    mean = np.sum(power * np.fft.rfftfreq(len(speed), period)) / np.sum(power)
    count = 1 + int(2.0 * time[-1] * mean / SLOWER)
    return np.cos(np.pi * np.outer((time + 0.5 * period) / (time[-1] + period), np.arange(count)))


def _best(error: Callable[[float], float], largest: float, period: float) -> float:
    """The delay with the least error: the best on a coarse grid, then the minimum near it."""
    grid = np.linspace(-largest, largest, GRID)
    errors = [error(tau) for tau in grid]
    best = int(np.argmin(errors))
    if best in (0, grid.size - 1):
        raise InputError(f"no delay up to {largest:g} s fits best: are both channels of the same motion?")
    bounds = (float(grid[best - 1]), float(grid[best + 1]))
    found: Any = minimize_scalar(error, bounds=bounds, method="bounded", options={"xatol": 1e-6 * period})
    return float(found.x)


def _with_uncertainty(tau: float, x: Array, functions: Callable[[float], Array], period: float) -> Skew:
    """The delay, its uncertainty from the scatter of its score over blocks: errors within a block may be correlated."""
    weights, residual = _fit(functions(tau), x)
    step = 0.01 * period
    change = (functions(tau + step) - functions(tau - step)) @ weights / (2.0 * step)
    # what the weights could compensate is no evidence
    change = _fit(functions(tau), change)[1]
    scores = [part.sum() for part in np.array_split(residual * change, BLOCKS)]
    scatter = np.sqrt(np.sum(np.square(scores)) * BLOCKS / (BLOCKS - 1))
    return Skew(tau, float(scatter / np.sum(change**2)), float(np.sqrt(np.mean(residual**2))))

"""Detects delays of torques relative to the motion: residuals are then proportional to the torques' rate."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import binary_dilation

from cutpoint.arrays import Array
from cutpoint.errors import counted
from cutpoint.identification.conditioning.decimation import Decimation
from cutpoint.identification.conditioning.motion import Motion
from cutpoint.identification.logs.recording import EFFORTS
from cutpoint.identification.rigid.least_squares import with_further
from cutpoint.identification.rigid.regression import Regression

GAP = 1.5
"""Times the usual step: rows farther apart give no rate."""

SPREAD = 1.0
"""Periods of the positions' cut-off, before and after a reversal, over which their filter spreads the jump of friction:
it would pass for a delay, of 2.3 ms at 12 Hz in a trial."""

TOUCHED = 0.1
"""Share of a mean's weight on such samples, above which it is left out."""

CERTAIN = 4.0
"""Standard deviations above which a delay is reported."""

UNLIKE = 0.5
"""Share of most joints' delay by which another's must differ: friction fitted too smooth hides part of a delay."""

WORTH, WORTH_BENT = 1.5e-3, 2.5e-3
"""s: least delay that is reported, without and with elastic drives: unmodelled springs, dampers and dry friction make
torques early or late by less."""

UNMODELLED_BENT = 1e-3
"""s: standard deviation of that effect with elastic drives, in trials; it adds to the uncertainty due to noise."""

LESS = 0.8
"""Share of the residual with delays: if another cause leaves less, it is not a delay.  In trials it was 0.9 to 1.1 with
late torques, and 0.1 to 0.6 with friction on both sides, except for one joint of six: hence the mean."""


def lateness_notes(
    found: Regression,
    values: Array,
    beside: Array,
    steady: NDArray[np.bool_],
    joints: Sequence[str],
    bend: bool,
) -> list[str]:
    """A sentence if torques of all joints are significantly late or early by the same delay, and one for each joint
    whose torques are too, but by another.

    values: the parameters (c,).  beside: columns (M, n, k) of other possible torques, earlier or later than the
    identified ones, such as friction on the drives' other sides.  steady: (M,), see `without_reversals`.
    bend: whether drives are elastic.
    """
    delays, covariance = lateness(found, values, beside, steady)
    worth, unmodelled = (WORTH_BENT, UNMODELLED_BENT) if bend else (WORTH, 0.0)
    sure = np.maximum(worth, CERTAIN * np.sqrt(np.diag(covariance)))
    told = np.isfinite(sure)
    usual = float(np.median(delays[told])) if told.any() else 0.0
    apart = told & (np.abs(delays - usual) > np.maximum(sure, UNLIKE * abs(usual)))
    late = np.abs(delays) > sure
    notes: list[str] = []
    for j in np.flatnonzero(apart & late).tolist():
        words = _late(f"torques of {joints[j]}", delays[j], covariance[j, j] + unmodelled**2)
        remedy = f"aligned(recording, {{{joints[j]!r}: {delays[j]:.2g}}}, {EFFORTS}) moves only these"
        notes.append(f"{words}, unlike those of other joints: check how they are stamped; {remedy}")
    rest = told & ~apart
    if rest.any():
        weights = np.linalg.solve(covariance[np.ix_(rest, rest)], np.ones(rest.sum()))
        delay, variance = float(weights @ delays[rest] / weights.sum()), float(1.0 / weights.sum())
        if abs(delay) > max(worth, CERTAIN * np.sqrt(variance)):
            on_time = [joints[j] for j in np.flatnonzero(apart & ~late).tolist()]
            whose = f"torques of all joints but {', '.join(on_time)}" if on_time else "torques"
            remedy = f"add {-delay:.2g} to torque_delay, --delay (0 if not given)"
            if on_time:
                remedy = f"move only these by aligned(recording, {{JOINT: {delay:.2g}, ...}}, {EFFORTS})"
            notes.append(f"{_late(whose, delay, variance + unmodelled**2)}: check the clocks, or {remedy}")
    if bend and notes:
        notes[-1] += "; of several delays, take the one with the least error on the part held out"
        if not beside.shape[2]:
            notes[-1] += "; dry friction on the drives' side without an encoder looks the same"
    return notes


def _late(torques: str, delay: float, variance: float) -> str:
    by, when = f"{1e3 * abs(delay):.2g} +- {1e3 * np.sqrt(variance):.1g} ms", "later" if delay > 0.0 else "earlier"
    return f"{torques} come {by} {when} than the motion they belong to"


def without_reversals(speeds: Array, motion: Motion, means: Decimation) -> NDArray[np.bool_]:
    """Which means (M,) are away from every joint's reversals.  speeds: (N, n), on which friction depends."""
    turns = np.diff(np.signbit(speeds), axis=0, prepend=np.signbit(speeds[:1])).any(axis=1)
    reach = int(np.ceil(SPREAD / (motion.cutoff * motion.period)))
    near = binary_dilation(turns, np.ones(2 * reach + 1))
    return np.abs(means(near.astype(np.float64))) <= TOUCHED


def lateness(found: Regression, values: Array, beside: Array, steady: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Delay of each joint's torques, s, (n,), and its covariance (n, n), s2, estimated with all else, to first order,
    from the steady means; NaN for joints whose torques, or those of most joints, `beside` explains better, and for all
    joints if these means are too few."""
    late = _by_delay(found, values)
    n = late.shape[2]
    if _lacking(found, steady) > 1.0:
        return np.full(n, np.nan), np.full((n, n), np.nan)
    estimate = with_further(found.part(steady), late[steady])
    delays, covariance = estimate.values[-n:].copy(), estimate.spread.covariance[-n:, -n:].copy()
    if beside.shape[2]:
        share = _left(found, beside) / _left(found, late)
        explained = (share < LESS) | (np.exp(np.mean(np.log(share))) < LESS)
        delays[explained] = covariance[explained, explained] = np.nan
    return delays, covariance


def not_judged(found: Regression, steady: NDArray[np.bool_]) -> list[str]:
    """A sentence if the steady means are too few to judge delays."""
    lacking = _lacking(found, steady)
    if lacking <= 1.0:
        return []
    few = f"of {counted(steady.size, 'mean')} only {steady.sum()} are away from every joint's reversals"
    remedy = f"a log {lacking:.2g} times as long would do" if np.isfinite(lacking) else "record longer, slower motion"
    return [f"whether torques come late is not judged, as {few}: {remedy}"]


def _lacking(found: Regression, steady: NDArray[np.bool_]) -> float:
    """How many times as many steady means would be enough: twice as many torques as unknowns; 1 or less if they are."""
    n = found.columns.shape[1]
    have = n * int(steady.sum())
    return 2.0 * (len(found.names) + n) / have if have else np.inf


def _by_delay(found: Regression, values: Array) -> Array:
    """(M, n, n): derivatives of the torques by each joint's delay, N m/s; zero beside gaps."""
    times = found.times
    rate = np.asarray(CubicSpline(times, found.columns @ values).derivative()(times))
    far = np.diff(times) > GAP * float(np.median(np.diff(times)))
    rate[np.append(far, False) | np.append(False, far)] = 0.0
    return -rate[..., None] * np.eye(rate.shape[1])


def _left(found: Regression, columns: Array) -> Array:
    """Each joint's mean absolute residual (n,) of a fit with further columns (M, n, k)."""
    return np.abs(with_further(found, columns).residuals).mean(axis=0)

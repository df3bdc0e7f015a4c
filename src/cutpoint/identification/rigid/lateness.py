"""Detects delays of torques relative to the motion: residuals are then proportional to the torques' rate."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from cutpoint.identification.logs.recording import EFFORTS
from cutpoint.identification.rigid.least_squares import Estimate, least_squares
from cutpoint.identification.rigid.regression import Regression

Array = NDArray[np.float64]

GAP = 1.5
"""Times the usual step: rows farther apart tell no rate."""

CERTAIN = 4.0
"""Standard deviations from which on a delay is said."""

UNLIKE = 0.5
"""Of the delay of most joints: friction that seems to change more slowly than it does hides some of one's own."""

WORTH, WORTH_BENT = 1.5e-3, 2.5e-3
"""s, from which on it is said, and where drives bend: springs, dampers and dry friction that were not modelled make
torques early or late by less."""

UNMODELLED_BENT = 1e-3
"""s by which they do where drives bend, a standard deviation in trials; it is told beside what noise leaves open."""

LESS = 0.8
"""Of what delays leave over: where something else leaves less than that, it is no delay.  In trials it was 0.9 to 1.1
where torques were late, and 0.1 to 0.6 where friction was on both sides, but for one joint of six: hence their mean."""


def lateness_notes(found: Regression, values: Array, beside: Array, joints: Sequence[str], bend: bool) -> list[str]:
    """A sentence if torques are clearly late or early against the motion, all alike, and one for each joint whose
    torques are so too, but unlike the others.

    values: the parameters (c,).  beside: columns (M, n, k) of what else may be in the torques, earlier or later than
    what was sought, such as friction on the drives' other sides.  bend: whether drives do.
    """
    delays, covariance = lateness(found, values, beside)
    worth, unmodelled = (WORTH_BENT, UNMODELLED_BENT) if bend else (WORTH, 0.0)
    sure = np.maximum(worth, CERTAIN * np.sqrt(np.diag(covariance)))
    told = np.isfinite(sure)
    usual = float(np.median(delays[told])) if told.any() else 0.0
    apart = told & (np.abs(delays - usual) > np.maximum(sure, UNLIKE * abs(usual)))
    late = np.abs(delays) > sure
    notes: list[str] = []
    for j in np.flatnonzero(apart & late).tolist():
        words = _late(f"torques of {joints[j]}", delays[j], covariance[j, j] + unmodelled**2)
        remedy = f"aligned(recording, {{{joints[j]!r}: {delays[j]:.2g}}}, {EFFORTS}) moves these alone"
        notes.append(f"{words}, unlike those of other joints: check how they are stamped; {remedy}")
    rest = told & ~apart
    if rest.any():
        weights = np.linalg.solve(covariance[np.ix_(rest, rest)], np.ones(rest.sum()))
        delay, variance = float(weights @ delays[rest] / weights.sum()), float(1.0 / weights.sum())
        if abs(delay) > max(worth, CERTAIN * np.sqrt(variance)):
            on_time = [joints[j] for j in np.flatnonzero(apart & ~late).tolist()]
            whose = f"torques of all joints but {', '.join(on_time)}" if on_time else "torques"
            remedy = f"add {-delay:.2g} to torque_delay, --delay (0 where it is not given)"
            if on_time:
                remedy = f"move these alone by aligned(recording, {{JOINT: {delay:.2g}, ...}}, {EFFORTS})"
            notes.append(f"{_late(whose, delay, variance + unmodelled**2)}: check the clocks, or {remedy}")
    if bend and notes:
        notes[-1] += "; of several delays, take the one whose model misses least of the part held out"
        if not beside.shape[2]:
            notes[-1] += "; dry friction on the side of the drives that has no encoder looks like that, too"
    return notes


def _late(torques: str, delay: float, variance: float) -> str:
    by, when = f"{1e3 * abs(delay):.2g} +- {1e3 * np.sqrt(variance):.1g} ms", "later" if delay > 0.0 else "earlier"
    return f"{torques} come {by} {when} than the motion that they belong to"


def lateness(found: Regression, values: Array, beside: Array) -> tuple[Array, Array]:
    """s by which each joint's torques are late, (n,), and their covariance (n, n), s2: sought beside all else, to first
    order; NaN of joints whose torques, or those of most joints, `beside` explains better."""
    times, told = found.times, found.columns @ values
    rate = np.asarray(CubicSpline(times, told).derivative()(times))
    far = np.diff(times) > GAP * float(np.median(np.diff(times)))
    rate[np.append(far, False) | np.append(False, far)] = 0.0
    n = rate.shape[1]
    late, left = _with(found, -rate[..., None] * np.eye(n))
    delays, covariance = late.values[-n:].copy(), late.spread.covariance[-n:, -n:].copy()
    if beside.shape[2]:
        share = _with(found, beside)[1] / left
        explained = (share < LESS) | (np.exp(np.mean(np.log(share))) < LESS)
        delays[explained] = covariance[explained, explained] = np.nan
    return delays, covariance


def _with(found: Regression, columns: Array) -> tuple[Estimate, Array]:
    """A fit with further columns (M, n, k), and what it leaves over of each joint's torques, (n,), in the mean."""
    names = (*found.names, *(f"further.{k}" for k in range(columns.shape[2])))
    more = replace(found, names=names, columns=np.concatenate([found.columns, columns], axis=2))
    estimate = least_squares(more, "huber")
    return estimate, np.abs(more.residuals(estimate.values)).mean(axis=0)

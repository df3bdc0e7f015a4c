"""Removal of single false samples, such as flipped bits or lost frames."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter

from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.resampling import GAP

Array = NDArray[np.float64]

NEIGHBOURS = 5
"""Samples whose median is what the middle one should be near."""

EVEN = 1.0 + 34.0 / 36.0
"""Variance of a sample's distance from the cubic through its neighbours, of noise of 1 at even times."""

ROUNDS = 3
"""Over a channel: of two spikes side by side one is found after the other."""

MOST_ARE = 0.95
"""Share of the samples that are as near as noise and motion have them."""

FAR = 10.0
"""Times as far as most samples are."""

SELDOM = 0.02
"""Share of the samples: what happens more often is no accident."""


def without_spikes(recording: Recording) -> Recording:
    """Samples of any channel that stand alone, far from their neighbours, replaced by these; notes say how many."""
    channels = {name: np.array(values) for name, values in recording.channels.items()}
    notes: list[str] = []
    for name, values in channels.items():
        for joint, column in zip(recording.joints, values.T, strict=True):
            if count := _mended(recording.time, column):
                rule = f"{count} samples stand out of their neighbours more than {FAR:g} times as far as others do"
                notes.append(f"{name} of {joint}: {rule}; replaced by these")
    return replace(recording, **channels).with_notes(notes) if notes else recording


def _mended(time: Array, column: Array) -> int:
    """Spikes of a channel (N,), which is changed; 0 where there are none, or more than spikes are."""
    known = np.flatnonzero(np.isfinite(column))
    if known.size < NEIGHBOURS:
        return 0
    x, mended, weights, noise = column[known], np.zeros(known.size, bool), *_cubics(time[known])
    for _ in range(ROUNDS):
        curve = (weights * x[_neighbours(x.size)]).sum(axis=1)
        spikes = _spikes(x, np.abs(x - curve) / noise)
        x[spikes] = curve[spikes]
        mended |= spikes
    if mended.sum() > SELDOM * x.size:
        return 0
    column[known] = x
    return int(mended.sum())


def _neighbours(count: int) -> NDArray[np.intp]:
    """Of each of so many samples the nearest four, (count, 4), two on each side but at the ends."""
    own = np.arange(count)[:, None]
    five = np.clip(own - 2, 0, count - NEIGHBOURS) + np.arange(NEIGHBOURS)
    return five[five != own].reshape(count, NEIGHBOURS - 1)


def _cubics(time: Array) -> tuple[Array, Array]:
    """Of the neighbours, (N, 4): weights in what a cubic through them has at each time (N,); and how much noisier the
    distance to it is than at even times, (N,): without bound beside a gap, where it says nothing."""
    apart = time[_neighbours(time.size)] - time[:, None]
    others = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]
    weights = [(-apart[:, o] / (apart[:, [k]] - apart[:, o])).prod(axis=1) for k, o in enumerate(others)]
    noise = np.sqrt((1.0 + np.square(weights).sum(axis=0)) / EVEN)
    far = np.ptp(apart, axis=1) > GAP * NEIGHBOURS * np.median(np.diff(time))
    return np.column_stack(weights), np.where(far, np.inf, noise)


def _spikes(x: Array, off_curve: Array) -> NDArray[np.bool_]:
    """Which samples are farthest of those nearby, and as far from the median: a step is near that, a turn near both."""
    away = np.abs(x - median_filter(x, NEIGHBOURS, mode="nearest"))
    usual = max(float(np.quantile(off_curve, MOST_ARE)), _finest_step(x))
    farthest = off_curve == maximum_filter1d(off_curve, NEIGHBOURS, mode="nearest")
    return farthest & (off_curve > FAR * usual) & (away > 0.5 * off_curve)


def _finest_step(x: Array) -> float:
    steps = np.abs(np.diff(x))
    return float(np.min(steps, where=steps > 0.0, initial=np.inf))

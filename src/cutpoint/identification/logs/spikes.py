"""Removal of single false samples, such as flipped bits or lost frames."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter

from cutpoint.arrays import Array
from cutpoint.errors import counted
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.resampling import GAP

NEIGHBOURS = 5
"""Samples in the median that the middle one should be near."""

EVEN = 1.0 + 34.0 / 36.0
"""Variance of a sample's distance from the cubic through its neighbours, for unit noise at even times."""

PASSES = 3
"""Passes over a channel: of two adjacent spikes, one is found after the other."""

MOST_ARE = 0.95
"""Share of the samples whose distance is taken as due to noise and motion."""

SPIKE = 10.0
"""A spike is this many times as far off as most samples."""

ALIKE = 0.3
"""Share of a spike's distance that may be left at its neighbours without it: of what only bends, more is left."""

SELDOM = 0.02
"""Share of the samples: what is more frequent is not a spike."""


def without_spikes(recording: Recording) -> Recording:
    """Isolated samples of any channel, far from their neighbours, replaced by interpolation; notes say how many."""
    channels = {name: np.array(values) for name, values in recording.channels.items()}
    notes: list[str] = []
    for name, values in channels.items():
        for joint, column in zip(recording.joints, values.T, strict=True):
            if count := _mended(recording.time, column):
                rule = f"{counted(count, 'spike')}, over {SPIKE:g} times as far from the neighbours as most samples"
                notes.append(f"{name} of {joint}: {rule}; interpolated")
    return replace(recording, **channels).with_notes(notes) if notes else recording


def _mended(time: Array, column: Array) -> int:
    """Number of spikes removed from a channel (N,), in place; 0 if there are none, or too many to be spikes."""
    known = np.flatnonzero(np.isfinite(column))
    if known.size < NEIGHBOURS:
        return 0
    x, mended, cubics = column[known], np.zeros(known.size, bool), _cubics(time[known])
    for _ in range(PASSES):
        curve, off = cubics.beside(x)
        spikes = _spikes(time[known], x, off)
        if not spikes.any():
            break
        _, left = cubics.beside(np.where(spikes, curve, x))
        spikes[1:-1] &= np.maximum(left[:-2], left[2:]) < ALIKE * off[1:-1]
        x[spikes] = curve[spikes]
        mended |= spikes
    if mended.sum() > SELDOM * x.size:
        return 0
    column[known] = x
    return int(mended.sum())


def _neighbours(count: int) -> NDArray[np.intp]:
    """The four nearest neighbours of each sample, (count, 4), two on each side except at the ends."""
    own = np.arange(count)[:, None]
    five = np.clip(own - 2, 0, count - NEIGHBOURS) + np.arange(NEIGHBOURS)
    return five[five != own].reshape(count, NEIGHBOURS - 1)


class _Cubics(NamedTuple):
    """Those through each sample's neighbours: which these are, and their weights, (N, 4); and how much noisier the
    distance to it is than at even times, (N,): infinite beside a gap, where it is meaningless."""

    neighbours: NDArray[np.intp]
    weights: Array
    noise: Array

    def beside(self, x: Array) -> tuple[Array, Array]:
        """The cubics at the samples (N,), and the distances of these from them."""
        curve = (self.weights * x[self.neighbours]).sum(axis=1)
        return curve, np.abs(x - curve) / self.noise


def _cubics(time: Array) -> _Cubics:
    near = _neighbours(time.size)
    apart = time[near] - time[:, None]
    others = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]
    weights = [(-apart[:, o] / (apart[:, [k]] - apart[:, o])).prod(axis=1) for k, o in enumerate(others)]
    noise = np.sqrt((1.0 + np.square(weights).sum(axis=0)) / EVEN)
    far = np.ptp(apart, axis=1) > GAP * NEIGHBOURS * np.median(np.diff(time))
    return _Cubics(near, np.column_stack(weights), np.where(far, np.inf, noise))


def _spikes(time: Array, x: Array, off_curve: Array) -> NDArray[np.bool_]:
    """Samples farthest off of those nearby, and as far from the median and from the lines through the two before and
    the two after: a step is near that or a line, a reversal near both, a corner near a line."""
    away = np.minimum.reduce([np.abs(x - median_filter(x, NEIGHBOURS, mode="nearest")), *_off_lines(time, x)])
    usual = max(float(np.quantile(off_curve, MOST_ARE)), _finest_step(x))
    farthest = off_curve == maximum_filter1d(off_curve, NEIGHBOURS, mode="nearest")
    return farthest & (off_curve > SPIKE * usual) & (away > 0.5 * off_curve)


def _off_lines(time: Array, x: Array) -> tuple[Array, Array]:
    """Distances of each sample from the lines through the two before, and the two after, (N,) each; infinite where
    there are not as many."""
    before, after = np.full((2, x.size), np.inf)
    slopes = np.diff(x) / np.diff(time)
    before[2:] = np.abs(x[2:] - x[1:-1] - slopes[:-1] * np.diff(time)[1:])
    after[:-2] = np.abs(x[:-2] - x[1:-1] + slopes[1:] * np.diff(time)[:-1])
    return before, after


def _finest_step(x: Array) -> float:
    steps = np.abs(np.diff(x))
    return float(np.min(steps, where=steps > 0.0, initial=np.inf))

"""Stamps that scatter about the times at which a machine samples evenly: the motion tells which of the two hold."""

from dataclasses import replace

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.logs.recording import UNEVEN, Recording

SCATTER = 0.25
"""Periods: stamps farther from even times are not theirs."""

SMOOTHER = 0.9
"""Share of a position's changes of speed that is left at even times, where stamps are to blame for the rest."""

QUANTILE = 0.9
"""Changes of speed are judged by this quantile of theirs, which neither spikes nor a long rest determine."""


def evenly_stamped(recording: Recording) -> Recording:
    """The recording at even times, with a note, if its positions are smoother there than at its stamps.

    A computer that stamps a machine's even samples late by 20 us puts positions at 1 rad/s off by 2e-5 rad, more than
    an encoder's step.  Lost samples stay lost.  Stamps of uneven samples are kept: along these positions are smoother.
    """
    time, even = recording.time, _even(recording.time)
    positions = [recording[name] for name in ("q", "theta") if name in recording.channels]
    if even is None or not positions or np.abs(np.diff(time - even)).max() <= UNEVEN * np.median(np.diff(even)):
        return recording
    x = np.column_stack(positions)
    stamped, evened = _roughness(time, x), _roughness(even, x)
    if (evened > stamped / SMOOTHER).any() or not (evened < SMOOTHER * stamped).any():
        return recording
    scatter, period = float(np.std(time - even)), float(np.median(np.diff(even)))
    found = f"stamps scatter by {1e6 * scatter:.3g} us about steps of {period:.6g} s, at which positions are smoother"
    return replace(recording, time=even - even[0]).with_notes([f"time: {found}: the samples are taken as even"])


def _even(time: Array) -> Array | None:
    """Multiples of a period nearest to times (N,), or None if some are far from all."""
    steps = np.diff(time)
    single = np.abs(steps / np.median(steps) - 1.0) < 2.0 * SCATTER
    if not single.any():
        return None
    count = np.concatenate([[0.0], np.cumsum(np.round(steps / steps[single].mean()))])
    slope, start = np.polyfit(count, time, 1)
    found = start + slope * count
    is_near = np.abs(time - found).max() < SCATTER * slope and (np.diff(count) > 0.0).all()
    return found if is_near else None


def _roughness(time: Array, x: Array) -> Array:
    """How much speeds of positions (N, n) change from sample to sample, (n,); 0 for a column without numbers."""
    change = np.abs(np.diff(np.diff(x, axis=0) / np.diff(time)[:, None], axis=0))
    known = [column[np.isfinite(column)] for column in change.T]
    return np.array([np.quantile(column, QUANTILE) if column.size else 0.0 for column in known])

"""Positions that jump and stay, as of a counter that was set anew, lost counts or lost samples."""

from collections.abc import Callable

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import counted
from cutpoint.identification.logs.doubts import Cause
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.resampling import longest_step

BESIDE = np.array([1, 2, 3])
"""Steps before and after one, that say what is expected of it: what returns within three is a spike, not a jump."""

MOST_ARE = 0.995
"""Share of the steps that differ, whose difference is taken as due to noise, motion and the encoder's resolution."""

JUMP = 10.0
"""A jump differs this many times as much as most steps, and as those beside it among themselves: in six logs of real
machines steps differ by up to 4.9 times."""

FEWEST = 20
"""Samples of a position, of fewer of which nothing is said."""

MOST_DEFLECTION = 0.02
"""rad: no drive's spring deflects this far at rest."""


def jump_notes(recording: Recording) -> list[Cause]:
    """A sentence on positions that jump, or, of two encoders, on those whose difference does across a gap; or none."""
    both = {name: recording[name] for name in ("q", "theta") if name in recording.channels}
    found = [words for name, x in both.items() for words in _told(recording, name, x, _jumps)]
    if len(both) == 2:
        found += _told(recording, "theta less q", both["theta"] - both["q"], _across_gaps)
    if not found:
        return []
    remedy = "use the log before or after that, by 'time: {start: ..., end: ...}' in a mapping"
    what = "positions jump and stay there, as if a counter was set anew, or samples were lost"
    return [Cause(f"{what}: {'; '.join(found)}: {remedy}")]


def _told(recording: Recording, name: str, x: Array, jumps: Callable[[Array, Array], tuple[Array, Array]]) -> list[str]:
    """Words on the largest jump of each joint's column (N, n), and how many there are."""
    words: list[str] = []
    for joint, column in zip(recording.joints, x.T, strict=True):
        known = np.flatnonzero(np.isfinite(column))
        if known.size < FEWEST:
            continue
        at, by = jumps(recording.time[known], column[known])
        if at.size:
            k = int(np.argmax(np.abs(by)))
            others = f" ({counted(at.size - 1, 'other jump')})" if at.size > 1 else ""
            words.append(f"{name} of {joint} by {by[k]:.2g} rad (m) at {at[k]:.4g} s{others}")
    return words


def _jumps(time: Array, x: Array) -> tuple[Array, Array]:
    """Times, s, and sizes of the jumps of a position (N,), both (k,)."""
    steps, passed = np.diff(x), np.diff(time)
    at = np.arange(BESIDE[-1], steps.size - BESIDE[-1])
    step, beside = steps[at], (steps / passed)[at[:, None, None] + np.stack([-BESIDE, BESIDE])] * passed[at, None, None]
    # while it accelerates steadily, the mean of a step before and of one after is the one between
    pairs = beside.mean(axis=1)
    by = step - np.median(pairs, axis=1)
    off = np.abs(by)
    usual = np.quantile(off[off > 0.0], MOST_ARE) if off.any() else 0.0
    is_off = off > JUMP * np.maximum(usual, np.ptp(pairs, axis=1))
    # where only its speed changes, a step is one between those beside it
    away = np.abs(step - np.clip(step, beside[..., 0].min(axis=1), beside[..., 0].max(axis=1)))
    found = is_off & (away > 0.5 * off) & (passed[at] <= longest_step(time))
    return time[at[found] + 1], by[found]


def _across_gaps(time: Array, lead: Array) -> tuple[Array, Array]:
    """Times, s, and sizes of changes of a motor's lead over its link (N,) across gaps that no spring explains."""
    ends = np.flatnonzero(np.diff(time) > longest_step(time))
    parts = np.split(lead, ends + 1)
    by = np.diff([np.median(part) for part in parts])
    is_more = np.abs(by) > max(MOST_DEFLECTION, *(np.ptp(part) for part in parts))
    return time[ends + 1][is_more], by[is_more]

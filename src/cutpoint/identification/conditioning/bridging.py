"""Short gaps of a log, in which an arm does nothing that the samples beside them do not show."""

import numpy as np

from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.resampling import on_grid

LOST = 5
"""Samples, one after the other, that are bridged at most."""

LONGEST = 0.05
"""s that a bridge spans at most: it misses waves of 2 Hz by 0.05 % of their size, such of 5 Hz by 1.7 %."""


def bridged(recording: Recording) -> Recording:
    """Cubic splines over short gaps in channels of uniform times; a note says over how many samples.

    One sample that a filter does not know costs it all of its memory before and after.
    """
    time, span = recording.time, min(LONGEST, (LOST + 1.5) * recording.period)
    filled = recording.with_channels(lambda x: np.where(np.isfinite(x), x, on_grid(time, x, time, span)))
    made = filled.complete() & ~recording.complete()
    if not made.any():
        return recording
    gaps = int((np.diff(made.astype(int), prepend=0) == 1).sum())
    rule = f"{gaps} gaps of at most {LOST} samples and {LONGEST:g} s were bridged by splines"
    return filled.with_notes([f"{rule}: {made.sum()} of {time.size} samples, and the intervals take them for measured"])

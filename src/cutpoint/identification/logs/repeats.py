"""Frames that a logger repeated while time went on, as if the robot had stood still."""

import numpy as np
from numpy.typing import NDArray

from cutpoint.errors import counted
from cutpoint.identification.logs.recording import Recording

MOST_IN_A_ROW = 5
"""Samples, as many as are bridged: longer repetitions are a robot at rest."""

MOST_ARE = 0.5
"""Share of the new samples that are repeated: more of them, and a log is faster than what it records."""


def only_new_rows(recording: Recording) -> Recording:
    """Without repetitions, if the log is faster than what it records; a note says how many."""
    same = _same_as_before(recording)
    if (~same[:-1] & same[1:]).sum() <= MOST_ARE * (~same).sum():
        return recording
    rule = "the log is faster than what it records, and only rows that are new are used"
    new = recording.with_channels(lambda values: values[~same], time=recording.time[~same])
    return new.with_notes([f"{_told(same)}: {rule}"])


def without_repeats(recording: Recording) -> Recording:
    """Samples that repeat the one before in every channel, few in a row, are unknown; a note says how many."""
    repeats = _short_runs(_same_as_before(recording))
    if not repeats.any():
        return recording
    left = recording.with_channels(lambda values: np.where(repeats[:, None], np.nan, values))
    return left.with_notes([f"{_told(repeats)}, and are not used"])


def _told(repeats: NDArray[np.bool_]) -> str:
    return f"{counted(int(repeats.sum()), 'sample')} of {repeats.size} repeat the one before in every channel"


def _same_as_before(recording: Recording) -> NDArray[np.bool_]:
    table = np.column_stack([*recording.channels.values()])
    return np.append(False, (table[1:] == table[:-1]).all(axis=1))


def _short_runs(same: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Those of (N,) in runs of at most MOST_IN_A_ROW."""
    ends = np.flatnonzero(np.diff(same.astype(np.int8), prepend=0, append=0)).reshape(-1, 2)
    kept = np.zeros(same.size, bool)
    for start, end in ends[np.diff(ends, axis=1)[:, 0] <= MOST_IN_A_ROW]:
        kept[start:end] = True
    return kept

"""Time stamps as loggers write them: put in order, reported, or refused."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import InputError, counted
from cutpoint.identification.logs.resampling import longest_step
from cutpoint.model.stated_units import TIMES

FEWEST = 4
"""Least number of samples of a log."""

BAD = 0.05
"""Share of the samples that may be left out due to their time stamps."""

CLOSE = 0.1
"""Periods: of two samples closer than this, the later is left out.  A spline through both would follow their noise."""

SET_BACK = 10.0
"""Periods: if few steps go back, a larger one means that a clock was set back, or that the log has two runs."""

FAST = 2e-5
"""s between samples: shorter periods suggest another unit."""

SLOW = 0.5
"""s: no moving machine is logged at a longer period, so another unit is suspected."""

LONGEST_GAP = 10.0
"""s, or `LONGEST_GAP_STEPS` steps if those are longer: longer gaps are shortened to this.  Otherwise a clock that jumps
by an hour would fill the log with unknown samples."""

LONGEST_GAP_STEPS = 100.0


class Ordered(NamedTuple):
    """times (M,), s, increasing from 0; start: the first stamp, s; rows (M,): their indices in the log."""

    times: Array
    start: float
    rows: NDArray[np.intp]
    notes: list[str]


def ordered(stamps: Array, values: Array, name: str) -> Ordered:
    """Stamps (N,), s, in order, without repetitions, with a note on each repair.

    values: (N, columns) at these stamps; a repeated row is left out, with a note too.  name: the log, for messages.

    Raises InputError: too few samples, a clock that was set back, or more than `BAD` of them unusable.
    """
    notes: list[str] = []
    rows = _finite(stamps, name, notes)
    rows = _sorted(stamps, rows, name, notes)
    rows = _distinct(stamps, values, rows, name, notes)
    times = stamps[rows] - stamps[rows[0]]
    _notes_on_gaps(times, name, notes)
    return Ordered(times, float(stamps[rows[0]]), rows, notes)


def without_long_gaps(times: Array, notes: list[str]) -> Array:
    """Times (N,), s, with those after a long gap shifted to earlier ones, and a note."""
    steps = np.diff(times)
    kept = max(LONGEST_GAP, LONGEST_GAP_STEPS * float(np.median(steps)))
    far = steps > kept
    if not far.any():
        return times
    first = int(np.argmax(far))
    found = f"{counted(far.sum(), 'gap')} above {kept:.3g} s, the first of {steps[first]:.6g} s at {times[first]:.6g} s"
    notes.append(f"time: {found}; each was cut to {kept:.3g} s, and later samples were moved earlier")
    return times - np.concatenate([[0.0], np.cumsum(np.where(far, steps - kept, 0.0))])


def _finite(stamps: Array, name: str, notes: list[str]) -> NDArray[np.intp]:
    rows = np.flatnonzero(np.isfinite(stamps))
    _leave_out(stamps.size - rows.size, stamps.size, f"{name}: samples without a time", notes)
    return _enough(rows, name)


def _enough(rows: NDArray[np.intp], name: str) -> NDArray[np.intp]:
    """The rows.  Raises InputError if they are too few."""
    if rows.size < FEWEST:
        raise InputError(f"{name}: only {counted(rows.size, 'sample')}: at least {FEWEST} are needed")
    return rows


def _sorted(stamps: Array, rows: NDArray[np.intp], name: str, notes: list[str]) -> NDArray[np.intp]:
    steps = np.diff(stamps[rows])
    back = np.flatnonzero(steps < 0.0)
    if not back.size:
        return rows
    period = float(np.median(np.abs(steps)))
    worst = int(np.argmin(steps))
    if back.size < BAD * rows.size and -steps[worst] > SET_BACK * period:
        raise InputError(
            f"{name}: time goes back by {-steps[worst]:.6g} s at sample {rows[worst + 1]}: a clock was set back, "
            "or one run follows another; split the log there, and give the parts as several logs",
            sample=int(rows[worst + 1]),
        )
    notes.append(f"{name}: {back.size} of {rows.size} time steps go back; samples were sorted by time")
    return rows[np.argsort(stamps[rows], kind="stable")]


def _distinct(stamps: Array, values: Array, rows: NDArray[np.intp], name: str, notes: list[str]) -> NDArray[np.intp]:
    again = np.flatnonzero(np.diff(stamps[rows]) == 0.0) + 1
    same = [k for k in again if np.array_equal(values[rows[k]], values[rows[k - 1]], equal_nan=True)]
    if same:
        notes.append(f"{name}: written twice and counted once: {counted(len(same), 'sample')}")
        rows = np.delete(rows, same)
    steps = np.diff(stamps[rows])
    if not (steps > 0.0).any():
        raise InputError(f"{name}: time does not advance: every stamp is {stamps[rows[0]]:g} s")
    close = np.flatnonzero(steps < CLOSE * np.median(steps[steps > 0.0])) + 1
    rule = f"{name}: samples at the same time as another, or right after it"
    _leave_out(close.size, rows.size, rule, notes)
    return _enough(np.delete(rows, close), name)


def _leave_out(count: int, among: int, what: str, notes: list[str]) -> None:
    """Notes that a few samples are left out.  Raises InputError if there are too many."""
    if count > BAD * among:
        raise InputError(
            f"{what}: {count} of {among}, more than {BAD:.0%}: take another time channel, "
            "or state `time: {period: ...}` in the mapping if samples are evenly spaced",
            count=count,
        )
    if count:
        notes.append(f"{what}: {count} of {among} were left out")


def _notes_on_gaps(times: Array, name: str, notes: list[str]) -> None:
    """Notes on gaps, and on a period that suggests another unit.  Raises InputError, as `check_period`."""
    steps, longest = np.diff(times), longest_step(times)
    period = float(np.median(steps))
    gaps = np.flatnonzero(steps > longest)
    if gaps.size:
        worst = int(np.argmax(steps))
        notes.append(
            f"{name}: {counted(gaps.size, 'gap')} above {longest:.3g} s; "
            f"the longest, {steps[worst]:.3g} s, is at {times[worst]:.6g} s"
        )
    if period < FAST:
        words = f"a period of {period:g} s is too short for a log of a moving machine"
        notes.append(
            f"{name}: {words}: are the times in a longer unit?  If so, state it in a mapping, 'time: {{unit: ...}}'"
        )
    check_period(times, name)


def check_period(times: Array, name: str) -> None:
    """Raises InputError for times (N,), s, with a period that suggests another unit.  name: the log, for messages."""
    period = float(np.median(np.diff(times)))
    if period > SLOW:
        unit = next((unit for unit, factor in TIMES.items() if factor * period <= SLOW), "ns")
        remedy = f"state 'time: {{channel: ..., unit: {unit}}}' in a mapping"
        words = f"a period of {period:g} s is too long for a log of a moving machine: are the times in {unit}?"
        raise InputError(f"{name}: {words}  If so, {remedy}", period=period)

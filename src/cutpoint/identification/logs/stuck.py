"""Columns that were not measured: copies of another joint's, and values that stand still while the joint moves."""

from collections.abc import Collection
from itertools import combinations

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.logs.doubts import Cause
from cutpoint.identification.logs.jumps import MOST_DEFLECTION
from cutpoint.identification.logs.recording import EFFORTS, Recording, travel

TRAVEL = 0.1
"""Share of a joint's travel, during which its torque cannot stay exactly the same."""

LONGER = 20.0
"""Times as long as values are held in the mean: where these have coarse steps, they stay the same for a while."""


def copy_notes(recording: Recording) -> list[Cause]:
    """A sentence on pairs of joints that have the same column, or none."""
    found: list[str] = []
    for name in _used(recording):
        x = recording[name]
        for a, b in combinations(range(len(recording.joints)), 2):
            known = np.isfinite(x[:, [a, b]]).all(axis=1)
            if (x[known, a] == x[known, b]).all() and known.any() and np.ptp(x[known, a]) > 0.0:
                found.append(f"{name} of {recording.joints[a]} and {recording.joints[b]}")
    words = f"columns are equal, as if one was logged twice: {'; '.join(found)}: map each joint's own, or lock one"
    return [Cause(words)] if found else []


def side_notes(recording: Recording, joints: Collection[str]) -> list[Cause]:
    """A sentence on joints, of those given, whose encoders on both sides read exactly the same, or none."""
    if not {"q", "theta"} <= recording.channels.keys():
        return []
    found: list[str] = []
    for joint, q, theta in zip(recording.joints, recording["q"].T, recording["theta"].T, strict=True):
        known = np.isfinite(q) & np.isfinite(theta)
        if joint in joints and known.any() and (q[known] == theta[known]).all() and np.ptp(q[known]) > 0.0:
            found.append(joint)
    remedy = "map what each encoder measured, or only one side"
    words = f"columns are equal, as if one was copied, or both are references: q and theta of {', '.join(found)}"
    return [Cause(f"{words}, whose drives bend: {remedy}")] if found else []


def stuck_notes(recording: Recording) -> list[Cause]:
    """A sentence on columns that stay exactly the same for a while in which the joint moves, or none."""
    sides = [name for name in _used(recording) if name not in EFFORTS]
    found: list[str] = []
    for name in _used(recording):
        others = [recording[side] for side in sides if side != name]
        for j, (joint, x) in enumerate(zip(recording.joints, recording[name].T, strict=True)):
            start, end = _longest_hold(x)
            least = [MOST_DEFLECTION if name in sides else TRAVEL * travel(other[:, j]) for other in others]
            if any(travel(y[start:end, j]) > by for y, by in zip(others, least, strict=True)):
                found.append(f"{name} of {joint} from {recording.time[start]:.4g} to {recording.time[end - 1]:.4g} s")
    remedy = "leave these cells empty, or that part out"
    what = "values stand still while the joint moves, as if they were no longer measured"
    return [Cause(f"{what}: {'; '.join(found)}: {remedy}")] if found else []


def _used(recording: Recording) -> list[str]:
    return [name for name in ("q", "theta", *EFFORTS) if name in recording.channels]


def _longest_hold(x: Array) -> tuple[int, int]:
    """First sample and that after the last, of the longest time in which a column (N,) stays the same between its
    extremes, or all if it never changes; none if that is no longer than values usually last."""
    if np.ptp(x) == 0.0:
        return 0, x.size
    bounds = np.concatenate([[0], np.flatnonzero(np.diff(x) != 0.0) + 1, [x.size]])
    inside = (x[bounds[:-1]] > np.nanmin(x, initial=np.inf)) & (x[bounds[:-1]] < np.nanmax(x, initial=-np.inf))
    held = np.where(inside, np.diff(bounds), 0)
    k = int(np.argmax(held))
    return (int(bounds[k]), int(bounds[k + 1])) if held[k] > LONGER * x.size / held.size else (0, 0)

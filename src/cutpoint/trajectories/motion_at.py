"""A motion at sample times, checked: it may be of a user's own trajectory."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.errors import listed
from cutpoint.trajectories.trajectory import Moves, Trajectory, derivatives_of

NAMES = ("position", "velocity", "acceleration", "jerk", "snap")
"""Of a motion's parts, each the rate of the one before."""

MOVES = 0.1
"""Share of the largest rate: where it is smaller, it is not judged."""

ROUNDING = 1e-12
"""Share of the largest number: what changes by less does not change."""

AGREES = 0.2
"""Tolerance of a factor that should be 1: sampling has a smaller effect on waves of more than five samples."""


def motion_at(function: str, trajectory: Moves, times: Array, joints: Sequence[str]) -> Array:
    """Position to snap, (5, N, joints), at increasing times (N,), s.

    Warns of derivatives that are not those of the positions.
    Raises InputError for numbers of another shape, or that are not finite.
    """
    motion = derivatives_of(function, trajectory, times, 4)
    if not isinstance(trajectory, Trajectory) and (said := [*_contradictions(motion, times, joints)]):
        warn(f"{function}: the trajectory contradicts itself: {'; '.join(said)}")
    return motion


def _contradictions(motion: Array, times: Array, joints: Sequence[str]) -> Iterator[str]:
    """What is a multiple of the rate that it is said to be; steps between samples do not count."""
    for (of, rate), (x, v) in zip(pairwise(NAMES), pairwise(motion), strict=True):
        moved, said = np.diff(x, axis=0), 0.5 * (v[1:] + v[:-1]) * np.diff(times)[:, None]
        moved[np.abs(moved) < ROUNDING * np.abs(x).max(axis=0, initial=0.0)] = 0.0
        found = {name: _multiple(*both) for name, *both in zip(joints, said.T, moved.T, strict=True)}
        wrong = {name: f"{factor:.3g}" for name, factor in found.items() if abs(factor - 1.0) > AGREES}
        if wrong:
            yield f"the {rate} of {listed(wrong)} is {', '.join(sorted({*wrong.values()}))} times the rate of the {of}"


def _multiple(said: Array, moved: Array) -> float:
    """Typical ratio of steps said to steps moved, (N,), over those where most is said to move; 1 where nothing is."""
    if not said.any():  # steps from one set point to the next are rare
        return 0.0 if np.count_nonzero(moved) > 0.5 * moved.size else 1.0
    judged = (np.abs(said) > MOVES * np.abs(said).max(initial=0.0)) & (moved != 0.0)
    return float(np.median(said[judged] / moved[judged])) if judged.any() else 1.0

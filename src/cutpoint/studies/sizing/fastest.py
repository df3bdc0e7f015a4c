"""How fast drives can do a motion: the shortest duration in which every limit holds."""

import itertools
import math
from collections.abc import Callable

from cutpoint.errors import InputError
from cutpoint.reporting.bar import Bar
from cutpoint.robot import Robot
from cutpoint.studies.sizing.sizing import Sizing, as_driven, sizing
from cutpoint.trajectories.retimed import retimed
from cutpoint.trajectories.trajectory import Moves

DOUBLINGS, HALVINGS = 7, 10
"""Of the duration, until it is given up; and of the interval that is left then, to 2^(1 / 2^10), 0.07 %."""


def fastest(
    robot: Robot, trajectory: Moves, *, dwell: float = 0.0, period: float = 1e-3, life: float | None = None
) -> Sizing:
    """`sizing` of a motion in the shortest time in which every stated limit holds, to 0.1 %: see its `duration`.

    The whole motion becomes uniformly faster or slower; dwell stays.  A limit that a slower motion breaks and an even
    slower one does not, as by Stribeck friction, may be passed over.  Arguments are those of `sizing`; the period
    counts in the motion as it is given, and is stretched with it.

    Raises:
        InputError: what `sizing` refuses, a limit that even a 128 times slower motion breaks, such as on a load that
            must be held at any speed, or none that a 128 times faster one breaks.
    """
    given = sizing(robot, trajectory, dwell=dwell, period=period, life=life)
    with Bar("shortest time", DOUBLINGS + HALVINGS + 1) as bar:
        tries = itertools.count(1)

        def at(slower: float) -> Sizing:
            bar.show(next(tries))
            motion = retimed(trajectory, trajectory.duration * slower)
            return as_driven(robot, motion, dwell, period * slower, life)

        fails, holds = _bracket(given, at)
        for _ in range(HALVINGS):
            middle = math.sqrt(fails * holds)
            fails, holds = (fails, middle) if at(middle).holds else (middle, holds)
        return at(holds)


def _bracket(given: Sizing, at: Callable[[float], Sizing]) -> tuple[float, float]:
    """Factors of the duration, one twice the other: with the shorter a limit is broken, with the longer none is."""
    step = 0.5 if given.holds else 2.0
    for k in range(1, DOUBLINGS + 1):
        found = at(step**k)
        if found.holds != given.holds:
            return min(step**k, step ** (k - 1)), max(step**k, step ** (k - 1))
        given = found
    raise _none(given)


def _none(found: Sizing) -> InputError:
    """found: the fastest that still holds, or the slowest that still does not."""
    if found.tightest is None:
        return InputError("fastest: no limit is stated: give drives ratings, limits or motors in the drive file")
    joint, margin = found.tightest
    asked = f"{joint!r} needs {margin.demanded:.3g} {margin.unit} of {margin.allowed:.3g} {margin.unit}, {margin.limit}"
    if found.holds:
        told = f"every stated limit holds; the tightest: {asked}; state what limits the drives' speed and torque"
    else:
        told = f"{asked}; a slower motion does not help: the load or the path must change"
    return InputError(f"fastest: even in {found.duration:.3g} s {told}", joint=joint)

"""Detects two joints whose columns are swapped, of torques, of positions, or of both, by the torques of the robot's
files."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.conditioning.motion import Motion, motion_of
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.torque_errors import TorqueErrors, stated_torque
from cutpoint.robot import Robot

UNLIKE = 0.9
"""Correlation of a joint's torque with the files' below which swaps are tried: files with wrong masses reach 0.97."""

LIKE = 0.8
"""Least such correlation of both joints with the swap undone."""

CLOSER = 0.5
"""Largest share that undoing the swap leaves of what they lack to a correlation of one."""


def swap_notes(robot: Robot, recording: Recording, errors: TorqueErrors, cutoff: float) -> list[str]:
    """A sentence if torques are clearly more like those that the files predict with two joints' columns exchanged.

    robot: as its files state it.  cutoff: Hz, of the positions.
    """
    lacking = 1.0 - np.diag(errors.likeness())
    pairs = [pair for pair in combinations(range(len(lacking)), 2) if lacking[[*pair]].max() > 1.0 - UNLIKE]
    if not pairs:
        return []
    motion, best, said = motion_of(robot, recording, cutoff), float(lacking.mean()), list[str]()
    for pair in pairs:
        for what, undone in _undone(robot, motion, errors, pair):
            left = 1.0 - np.diag(undone.likeness())
            own = left[[*pair]]
            is_like = own.max() < 1.0 - LIKE and own.sum() < CLOSER * lacking[[*pair]].sum()
            if is_like and left.mean() < best:
                best, said = float(left.mean()), [_words(what, *(robot.joints[j] for j in pair))]
    return said


def _words(what: str, first: str, second: str) -> str:
    reason = "exchanged, they fit what the files predict"
    return f"columns of {what} of {first} and {second} look swapped: {reason}"


def _undone(
    robot: Robot, motion: Motion, errors: TorqueErrors, pair: tuple[int, int]
) -> Iterator[tuple[str, TorqueErrors]]:
    """Errors with a pair's columns exchanged: of torques, of positions, of both."""
    order = np.arange(len(robot.joints))
    order[[*pair]] = pair[::-1]
    files = low_pass(stated_torque(robot, _ordered(motion, order)), motion.period, errors.bandwidth)
    torques = replace(errors, measured=errors.measured[:, order])
    yield "torques", torques
    yield "positions", replace(errors, before=files)
    yield "positions and torques", replace(torques, before=files)


def _ordered(motion: Motion, order: NDArray[np.intp]) -> Motion:
    """With the joints' columns in another order."""
    return motion._replace(**{name: getattr(motion, name)[:, order] for name in ("q", "v", "a", "theta", "w", "w_dot")})

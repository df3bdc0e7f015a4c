"""Detects two joints whose columns are swapped, and joints whose signs are reversed, of torques, of positions, or of
both, by the torques of the robot's files."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.conditioning.motion import Motion, motion_of
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.torque_errors import TorqueErrors, stated_torque
from cutpoint.robot import Robot

UNLIKE = 0.9
"""Correlation of a joint's torque with the files' below which changes are tried: files with wrong masses reach 0.97."""

LIKE = 0.8
"""Least such correlation of the changed joints, and its opposite for torques that look reversed."""

CLOSER = 0.5
"""Largest share that a change leaves of what these joints lack to a correlation of one."""

AS_WELL = 1.2
"""Times the least that all joints lack: what leaves no more fits as well."""


class _Change(NamedTuple):
    """left: what joints lack to a correlation of one, in the mean, after a change of these.  turns: of their signs."""

    left: float
    what: str
    joints: list[int]
    turns: bool


def swap_notes(robot: Robot, recording: Recording, errors: TorqueErrors, cutoff: float) -> list[str]:
    """A sentence if torques are clearly more like those that the files predict with two joints' columns exchanged, or
    with other signs.

    robot: as its files state it.  cutoff: Hz, of the positions.
    """
    likeness = np.diag(errors.likeness())
    changes = _changes(likeness)
    if not changes:
        return []
    motion, lacking = motion_of(robot, recording, cutoff), 1.0 - likeness
    found: list[_Change] = []
    for joints, order, signs in changes:
        for what, undone in _undone(robot, motion, errors, order, signs):
            left = 1.0 - np.diag(undone.likeness())
            own, mean = left[joints], float(left.mean())
            if own.max() < 1.0 - LIKE and own.sum() < CLOSER * lacking[joints].sum() and mean < lacking.mean():
                found.append(_Change(mean, what, joints, bool((signs < 0.0).any())))
    if not found:
        return []
    best = min(found)
    what = best.what
    if best.turns:  # a joint that no other feels fits as well with its torque turned round as with its position
        alike = [each for each in sorted(found) if each.turns and each.joints == best.joints]
        what = " or of ".join(each.what for each in alike if each.left <= AS_WELL * best.left)
    return [_words(what, [robot.joints[j] for j in best.joints], best.turns)]


def _changes(likeness: Array) -> list[tuple[list[int], NDArray[np.intp], Array]]:
    """Joints, and the order and signs (n,) of columns to try: pairs exchanged, and single joints, pairs, and all that
    look reversed turned round."""
    own, odd = np.arange(likeness.size), likeness < UNLIKE
    pairs = [[*pair] for pair in combinations(range(likeness.size), 2) if odd[[*pair]].any()]
    singles, turned = np.flatnonzero(odd)[:, None].tolist(), np.flatnonzero(likeness < -LIKE).tolist()
    turns = [*singles, *pairs, *([turned] if len(turned) > 2 else [])]
    found = [(pair, _with(own, pair, own[pair[::-1]]), np.ones(own.size)) for pair in pairs]
    return found + [(joints, own, _with(np.ones(own.size), joints, -1.0)) for joints in turns]


def _with(values: NDArray[Any], at: list[int], others: Any) -> NDArray[Any]:
    changed = values.copy()
    changed[at] = others
    return changed


def _words(what: str, joints: list[str], turns: bool) -> str:
    if turns:
        return f"signs of {what} of {', '.join(joints)} look reversed: turned round, they fit what the files predict"
    reason = "exchanged, they fit what the files predict"
    return f"columns of {what} of {' and '.join(joints)} look swapped: {reason}"


def _undone(
    robot: Robot, motion: Motion, errors: TorqueErrors, order: NDArray[np.intp], signs: Array
) -> Iterator[tuple[str, TorqueErrors]]:
    """Errors with columns in another order and of other signs: of torques, of positions, of both."""
    files = low_pass(stated_torque(robot, _changed(motion, order, signs)), motion.period, errors.bandwidth)
    torques = replace(errors, measured=errors.measured[:, order] * signs)
    yield "torques", torques
    yield "positions", replace(errors, before=files)
    yield "positions and torques", replace(torques, before=files)


def _changed(motion: Motion, order: NDArray[np.intp], signs: Array) -> Motion:
    """With the joints' columns in another order, and of other signs."""
    names = ("q", "v", "a", "theta", "w", "w_dot")
    return motion._replace(**{name: getattr(motion, name)[:, order] * signs for name in names})

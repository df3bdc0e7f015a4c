"""Units at the side of a joint that turns, and of one that slides."""

import re
from collections.abc import Iterable

from cutpoint.model.units import SLIDING
from cutpoint.robot import Robot

_TURNING = re.compile(rf"(?<![\w/])({'|'.join(map(re.escape, sorted(SLIDING, key=len, reverse=True)))})(?![\w/])")


def at_joints(robot: Robot, unit: str) -> dict[str, str]:
    """Of each driven joint, what a unit of one that turns is there."""
    sliding = robot.mechanism.sliding
    return {joint: SLIDING[unit] if joint in sliding else unit for joint in robot.joints}


def words_at(robot: Robot, joint: str, words: str) -> str:
    """A sentence in units of a joint that turns, in those of this one."""
    return _TURNING.sub(lambda unit: at_joints(robot, unit[0])[joint], words)


def either(units: Iterable[str]) -> str:
    """All that there are, as "N m or N"."""
    return " or ".join(dict.fromkeys(units))

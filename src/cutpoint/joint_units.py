"""Units of revolute and of prismatic joints."""

import re
from collections.abc import Iterable

from cutpoint.model.units import SLIDING, joint_unit
from cutpoint.robot import Robot

_TURNING = re.compile(rf"(?<![\w/])({'|'.join(map(re.escape, sorted(SLIDING, key=len, reverse=True)))})(?![\w/])")


def are_prismatic(robot: Robot) -> list[bool]:
    """For each drive, whether its joint slides."""
    sliding = robot.mechanism.sliding
    return [joint in sliding for joint in robot.joints]


def at_joints(robot: Robot, unit: str) -> dict[str, str]:
    """For each driven joint, the unit that corresponds to one of a revolute joint."""
    slides = zip(robot.joints, are_prismatic(robot), strict=True)
    return {joint: joint_unit(unit, prismatic) for joint, prismatic in slides}


def words_at(robot: Robot, joint: str, words: str) -> str:
    """A sentence in units of a revolute joint, in those of this one."""
    return _TURNING.sub(lambda unit: at_joints(robot, unit[0])[joint], words)


def either(units: Iterable[str]) -> str:
    """All units that occur, as "N m or N"."""
    return " or ".join(dict.fromkeys(units))

"""Limits that a guard enforces: those of the robot's file and drives, or others that a user gives."""

from typing import Any

import numpy as np

from cutpoint.control.interface import is_traced
from cutpoint.errors import InputError
from cutpoint.model.limits import efforts_in_force
from cutpoint.robot import Robot

LIMITS = ("torque_limit", "speed_limit", "lower", "upper")


def limits_of(robot: Robot, given: dict[str, Any]) -> dict[str, Any]:
    """Limits (n,) by name, the robot's where none are given; traced ones pass unchecked.

    Raises InputError for a torque or speed limit that is not positive, an upper limit below the lower one, NaN, or a
    wrong size.
    """
    stated = _stated(robot)
    found = {name: _each(robot, name, stated[name] if x is None else x) for name, x in given.items()}
    if not any(limit.dtype == object for limit in found.values()):
        _check(robot, found)
    return found


def _stated(robot: Robot) -> dict[str, list[float]]:
    limits = robot.limits.values()
    return {
        "torque_limit": [*efforts_in_force(robot.mechanism, robot.drives)],
        "speed_limit": [each.velocity for each in limits],
        "lower": [each.lower for each in limits],
        "upper": [each.upper for each in limits],
    }


def _each(robot: Robot, name: str, value: Any) -> Any:
    array, n = np.asarray(value), len(robot.drives)
    if is_traced(array):
        return array
    if array.dtype.kind not in "biuf" or array.shape not in ((), (n,)) or np.isnan(array).any():
        raise InputError(f"Guard: {name} {value} must be numbers, one or one for each of {n} drives", limit=name)
    return np.broadcast_to(array, n).astype(float)


def _check(robot: Robot, found: dict[str, Any]) -> None:
    names = [*robot.drives]
    for name in ("torque_limit", "speed_limit"):
        for joint, limit in zip(names, found[name], strict=True):
            if limit <= 0:
                raise InputError(f"Guard: {name} {limit} of {joint!r} must be positive", joint=joint)
    for joint, lower, upper in zip(names, found["lower"], found["upper"], strict=True):
        if lower > upper:
            raise InputError(f"Guard: lower {lower} of {joint!r} must not exceed upper, {upper}", joint=joint)

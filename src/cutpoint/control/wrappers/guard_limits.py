"""Limits that a guard enforces: those of the robot's file and drives, or others that a user gives."""

from typing import Any

import numpy as np

from cutpoint.control.gains import numbers_or_traced
from cutpoint.control.interface import is_traced
from cutpoint.errors import InputError
from cutpoint.model.limits import look_like_degrees
from cutpoint.model.mechanism import Limits
from cutpoint.robot import Robot

LIMITS = ("torque_limit", "speed_limit", "lower", "upper")


def limits_of(robot: Robot, given: dict[str, Any]) -> dict[str, Any]:
    """Limits (n,) by name, the robot's where none are given; traced ones pass unchecked.

    Raises InputError for a torque or speed limit that is not positive, an upper limit below the lower one, NaN, a
    wrong size, or position limits that look like degrees where the robot states limits of its own.
    """
    stated = _stated(robot)
    found = {name: _each(robot, name, stated[name] if x is None else x) for name, x in given.items()}
    if not any(limit.dtype == object for limit in found.values()):
        _check(robot, found)
        _check_angles(robot, stated, found)
    return found


def _stated(robot: Robot) -> dict[str, list[float]]:
    limits = robot.limits.values()
    return {
        "torque_limit": [*robot.effort_limits],
        "speed_limit": [each.velocity for each in limits],
        "lower": [each.lower for each in limits],
        "upper": [each.upper for each in limits],
    }


def _each(robot: Robot, name: str, value: Any) -> Any:
    n = len(robot.drives)
    rule = f"numbers, one or one for each of {n} drives"
    array = numbers_or_traced("Guard", name, value, rule)
    if is_traced(array):
        return array
    if array.shape not in ((), (n,)) or np.isnan(array).any():
        raise InputError(f"Guard: {name} {value} must be {rule}", limit=name)
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


def _check_angles(robot: Robot, stated: dict[str, list[float]], found: dict[str, Any]) -> None:
    """Raises InputError for limits beyond the robot's own that look like degrees: they would never be passed."""
    pairs = (zip(limits["lower"], limits["upper"], strict=True) for limits in (stated, found))
    for joint, own, (lower, upper) in zip(robot.drives, *pairs, strict=True):
        is_beyond = np.isfinite(own).all() and (lower < own[0] or upper > own[1])
        if is_beyond and joint not in robot.mechanism.sliding and look_like_degrees(Limits(lower, upper)):
            told = f"Guard: lower {lower:g} and upper {upper:g} of {joint!r} look like degrees"
            rule = f"the joint's own limits are [{own[0]:g}, {own[1]:g}] rad: give radians (numpy.radians)"
            raise InputError(f"{told}; {rule}", joint=joint)

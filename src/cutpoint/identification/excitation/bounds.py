"""Limits of joints: the tightest of those in the robot file, the drives and the user's."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import positive, refused
from cutpoint.errors import InputError
from cutpoint.model.mechanism import Joint
from cutpoint.robot import Robot

FREE_TURN, FREE_SLIDE = np.pi, 1.0
"""rad and m to either side of zero: the range of a joint without position limits."""


class Bounds(NamedTuple):
    """Limits of each joint, (n,): position from low to high, rad (m); the others symmetric, infinite if not stated."""

    low: Array
    high: Array
    speed: Array
    acceleration: Array
    torque: Array


def joints_of(robot: Robot) -> list[Joint]:
    """The driven joints in the order of the coordinates."""
    own = {body.joint.name: body.joint for body in robot.mechanism.bodies}
    return [own[name] for name in robot.joints]


def bounds_of(
    robot: Robot,
    position: tuple[ArrayLike, ArrayLike] | None,
    speed: ArrayLike | None,
    acceleration: ArrayLike | None,
    torque: ArrayLike | None,
    travel: float = 1.0,
) -> Bounds:
    """position: low and high; the others symmetric; each a number, or one per joint.  travel: share of the range from
    low to high, about its middle.

    Raises InputError: an invalid number, an empty range of positions, or a joint whose speed is not limited.
    """
    low, high = _positions(robot, position)
    spared = (1.0 - _share(travel)) * (high - low) / 2.0
    low, high = low + spared, high - spared
    speeds = [limits.velocity for limits in robot.limits.values()]
    bounds = Bounds(
        low,
        high,
        np.fmin(_largest(robot, "speed", speed), speeds),
        _largest(robot, "acceleration", acceleration),
        np.fmin(_largest(robot, "torque", torque), robot.effort_limits),
    )
    for name, most in zip(robot.joints, bounds.speed, strict=True):
        if np.isinf(most):
            remedy = "state a limit: speed=, or --speed on the command line"
            raise InputError(f"joint {name!r}: neither robot nor drive limits its speed; {remedy}", joint=name)
    return bounds


def _share(travel: float) -> float:
    if positive("excitation", "travel", travel) > 1.0:
        raise InputError(f"excitation: travel {travel:g} must be at most 1, all that limits leave", travel=travel)
    return travel


def _positions(robot: Robot, position: tuple[ArrayLike, ArrayLike] | None) -> tuple[Array, Array]:
    try:
        first, last = (-np.inf, np.inf) if position is None else position
    except (TypeError, ValueError):
        raise refused("excitation", "position", position, "(low, high), each a number or one per joint") from None
    free = np.array([FREE_SLIDE if joint.kind == "prismatic" else FREE_TURN for joint in joints_of(robot)])
    stated = robot.limits.values()
    low = np.maximum(_each(robot, "position", first), [each.lower for each in stated])
    high = np.minimum(_each(robot, "position", last), [each.upper for each in stated])
    # a joint without limits is kept about zero, one with a single limit within the same distance of that
    low, high = (
        np.where(np.isfinite(low), low, np.where(np.isfinite(high), high - 2.0 * free, -free)),
        np.where(np.isfinite(high), high, np.where(np.isfinite(low), low + 2.0 * free, free)),
    )
    for name, a, b in zip(robot.joints, low, high, strict=True):
        if not a < b:
            rule = "the first must be smaller; correct them, or lock a joint that does not move (lock=, --lock)"
            raise InputError(f"joint {name!r}: position limits {a:g} and {b:g} leave no range: {rule}", joint=name)
    return low, high


def _largest(robot: Robot, name: str, value: ArrayLike | None) -> Array:
    found = _each(robot, name, np.inf if value is None else value)
    for joint, x in zip(robot.joints, found, strict=True):
        if not x > 0.0:
            raise InputError(f"joint {joint!r}: {name} limit {x:g} must be positive", joint=joint, value=float(x))
    return found


def _each(robot: Robot, name: str, value: ArrayLike) -> Array:
    """One number per joint, not NaN."""
    n = len(robot.joints)
    try:
        found = np.broadcast_to(np.asarray(value, dtype=np.float64), n)
    except (TypeError, ValueError):
        raise InputError(f"{name} limit must be a number, or {n}, one per joint", name=name) from None
    if np.isnan(found).any():
        raise InputError(f"joint {robot.joints[int(np.isnan(found).argmax())]!r}: {name} limit is NaN", name=name)
    return found

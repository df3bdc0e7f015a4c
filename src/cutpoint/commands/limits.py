"""Limits in force, and sentences on those that a motion exceeds, for the command line."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import compress
from typing import TYPE_CHECKING, Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.joint_units import are_prismatic, at_joints
from cutpoint.model.mechanism import Limits
from cutpoint.robot import Robot

if TYPE_CHECKING:
    from cutpoint.control import Fault
    from cutpoint.simulation import Log

ROUNDING = 1e-6
"""rad (m), and per second, by which a joint that moves to its limits may exceed them without a note."""


def limits_by_joint(robot: Robot) -> dict[str, Limits]:
    """Limits in force, also of joints without a drive; infinite where there is none, which a file may state as 0."""
    stated, efforts = robot.limits, _efforts_of(robot)
    joints = {body.joint.name: stated.get(body.joint.name, body.joint.limits) for body in robot.mechanism.bodies}
    return {
        name: replace(own, velocity=own.velocity or np.inf, effort=efforts.get(name, own.effort) or np.inf)
        for name, own in joints.items()
    }


def beyond_limits(robot: Robot, low: Array, high: Array, peaks: Array) -> Iterator[str]:
    """A sentence for each limit of position or speed that a motion exceeds.

    low, high, peaks: (n,) least and largest positions, rad (m), and largest speeds, rad/s (m/s).
    """
    yield from _beyond_travel(robot, low, high)
    yield from _beyond_speed(robot, peaks)


def _beyond_travel(robot: Robot, low: Array, high: Array) -> Iterator[str]:
    """A sentence for each joint that moves, from `low` to `high` (n,), farther than files allow."""
    limits = robot.limits.values()
    for name, slides, own, least, most in zip(robot.joints, are_prismatic(robot), limits, low, high, strict=True):
        if least < own.lower - ROUNDING or most > own.upper + ROUNDING:
            factor, unit = (1e3, "mm") if slides else (np.degrees(1.0), "deg")
            place, limit = (most, own.upper) if most > own.upper + ROUNDING else (least, own.lower)
            digits = _digits_apart(place, limit, slides)
            allowed = range_of(own.lower, own.upper, factor, unit, digits)
            yield f"{name} goes to {in_units(place, slides, digits)}, beyond its limits, {allowed}"


def _beyond_speed(robot: Robot, peaks: Array) -> Iterator[str]:
    """A sentence for each joint that moves faster than files allow; peaks: (n,) rad/s (m/s), not negative."""
    for name, slides, own, peak in zip(robot.joints, are_prismatic(robot), robot.limits.values(), peaks, strict=True):
        if peak > own.velocity + ROUNDING:
            digits = _digits_apart(peak, own.velocity, slides)
            most, limit = in_units(peak, slides, digits), in_units(own.velocity, slides, digits)
            yield f"{name} moves at up to {most}/s, above its limit of {limit}/s"


def beyond_efforts(robot: Robot, motors: Array, joints: Array) -> Iterator[str]:
    """A sentence for each limit of torque that a motion exceeds.

    motors, joints: (n,) largest torques of motors, and on what their gears carry, N m (N) at the joint's side.
    """
    units, most = at_joints(robot, "N m"), _efforts_of(robot)
    for name, peak in zip(robot.joints, motors.tolist(), strict=True):
        if peak > most[name] * (1.0 + ROUNDING):
            yield f"{name} needs {peak:.4g} {units[name]} of its motor, above its limit of {most[name]:.4g}"
    yield from _beyond_ratings(robot, joints)


def limits_met(robot: Robot, log: "Log") -> Iterator[str]:
    """A sentence for a guard's fault, and for each limit that a run met."""
    yield from _fault_of(robot, log)
    yield from beyond_limits(robot, log["q"].min(axis=0), log["q"].max(axis=0), np.abs(log["v"]).max(axis=0))
    most, units = _efforts_of(robot), at_joints(robot, "N m")
    for name, share in log.meta.get("over_limit", {}).items():
        allowed = [f"its limit of {most[name]:.4g} {units[name]}"] if np.isfinite(most[name]) else []
        motor = robot.drives[name].motor
        if motor and motor.voltage_limit is not None:
            allowed.append("its voltage allows")
        yield f"{name} is asked for more than {' or '.join(allowed)} in {share:.1%} of the samples"
    yield from _beyond_ratings(robot, np.abs(log["joint_torque"]).max(axis=0))


def _fault_of(robot: Robot, log: "Log") -> Iterator[str]:
    """A sentence for the first fault of a run under a guard with the robot's own limits, if there is one."""
    from cutpoint.control import Fault

    if "fault" in log.channels and log["fault"].any():
        first = int(np.flatnonzero(log["fault"])[0])
        fault = Fault(int(log["fault"][first]))
        joints = _joints_of(fault, robot, log, first)
        what = fault.name.lower() + (f" of {', '.join(joints)}" if joints else "")
        yield f"the guard found a fault, {what}, at {log.time[first]:.4g} s: what follows is its reaction"


def _joints_of(fault: "Fault", robot: Robot, log: "Log", sample: int) -> list[str]:
    """Joints that are measured to be too fast, or too far, in a sample; none for other faults."""
    q, v, theta, theta_dot = (log[f"measured_{name}"][sample] for name in ("q", "v", "theta", "theta_dot"))
    place, speed = np.where(np.isnan(q), theta, q), np.fmax(np.abs(v), np.abs(theta_dot))
    low, high, most = np.array([(own.lower, own.upper, own.velocity) for own in robot.limits.values()]).T
    beyond = {"SPEED": speed > most, "POSITION": (place < low) | (place > high)}
    return [*compress(robot.joints, beyond.get(fault.name, ()))]


def _beyond_ratings(robot: Robot, peaks: Any) -> Iterator[str]:
    """A sentence for each gear loaded beyond its highest rating; peaks: (n,) N m."""
    units = at_joints(robot, "N m")
    for (name, drive), peak in zip(robot.drives.items(), peaks, strict=True):
        allowed = drive.ratings.momentary_peak_torque if drive.ratings else None
        if allowed is not None and peak > allowed:
            told = f"{peak:.4g} {units[name]}, above its gear's momentary peak of {allowed:.4g}"
            yield f"{name} transmits up to {told}: nothing limits it; see `cutpoint check`"


def in_units(x: float, slides: bool, digits: int = 4) -> str:
    """A position, rad (m), in the units that people read."""
    return f"{x * 1e3:.{digits}g} mm" if slides else f"{np.degrees(x):.{digits}g} deg"


def _digits_apart(x: float, y: float, slides: bool) -> int:
    """The fewest digits, 4 or more, that tell two different positions apart."""
    return next((k for k in range(4, 16) if in_units(x, slides, k) != in_units(y, slides, k)), 16)


def range_of(lower: float, upper: float, factor: float, unit: str, digits: int = 4) -> str:
    """A range of positions, in a unit of which one SI unit has `factor`; "-" without limits."""
    if np.isinf(lower) and np.isinf(upper):
        return "-"
    return f"{lower * factor:.{digits}g} to {upper * factor:.{digits}g} {unit}"


def _efforts_of(robot: Robot) -> dict[str, float]:
    """`Robot.effort_limits` by joint, N m (N)."""
    return dict(zip(robot.joints, robot.effort_limits.tolist(), strict=True))

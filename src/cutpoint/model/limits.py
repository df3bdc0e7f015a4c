"""Limits of driven joints: those of robot file and drives, combined, and positions far beyond them."""

from collections.abc import Mapping, Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Limits, Mechanism
from cutpoint.model.validation import DEGREES_BEYOND

ENDLESS = 1e5
"""rad or m: limits beyond, as some files state them for joints that turn on and on, are none."""

MILLIMETRES_BEYOND_LIMIT = 10.0
"""Times the widest limit of a joint that slides: beyond it, and a metre, a position is in mm."""

DEGREES_BEYOND_LIMIT = 1.25
"""Times the limit that a turning joint exceeds: beyond it, and a turn, a position is in degrees."""


class DegreesWarning(UserWarning):
    """Limits in a file, or the position at which a joint is locked, look like degrees."""


def limits_in_force(mechanism: Mechanism, drives: Mapping[str, Drive]) -> dict[str, Limits]:
    """The tighter of a joint's limits and its drive's, by joint, in the order of the drives.

    Efforts and speeds of 0 in a robot file, which stand for unknown ones, count as none, and so do ENDLESS positions.
    """
    stated = {body.joint.name: body.joint.limits for body in mechanism.bodies}
    return {joint: _tighter(stated[joint], drive.limits) for joint, drive in drives.items()}


def check_configuration(mechanism: Mechanism, q: Sequence[float]) -> None:
    """Raises InputError for a configuration far beyond limits, as if in degrees or mm; a little beyond is allowed.

    q: joint positions in the order of the driven joints, rad (m).
    """
    for (name, i), x in zip(mechanism.driven_joints.items(), q, strict=True):
        joint = mechanism.bodies[i].joint
        low, high = joint.limits.lower, joint.limits.upper
        exceeded, likeness, unit = abs(high if x > high else low), "", "rad"
        if joint.kind == "revolute" and abs(x) > max(2 * np.pi, DEGREES_BEYOND_LIMIT * exceeded):
            likeness = "degrees: give radians (numpy.radians, or --degrees on the command line)"
        if joint.kind == "prismatic" and looks_like_millimetres(x, joint.limits):
            likeness, unit = "mm: give metres", "m"
        if likeness and not low <= x <= high:
            found = f"position {x:g} {unit} exceeds its limits [{low:g}, {high:g}]"
            raise InputError(f"joint {name!r}: {found}; this looks like {likeness}", joint=name, position=x)


def looks_like_degrees(mechanism: Mechanism, name: str, x: float) -> bool:
    """Whether a position of a driven joint, with limits or none, is beyond two turns; some joints do turn on and on."""
    return abs(x) > DEGREES_BEYOND and name not in mechanism.sliding


def looks_like_millimetres(x: float, limits: Limits) -> bool:
    """Whether a position of a joint that slides is far beyond its limits, m."""
    low, high = limits.lower, limits.upper
    return low < high and abs(x) > max(1.0, MILLIMETRES_BEYOND_LIMIT * max(abs(low), abs(high)))


def look_like_degrees(limits: Limits) -> bool:
    """Whether a revolute joint's limits look like degrees: half or whole numbers up to 360, large for radians."""
    bounds = np.array([limits.lower, limits.upper])
    if not np.isfinite(bounds).all():
        return False
    furthest = np.max(np.abs(bounds))
    return bool(DEGREES_BEYOND < furthest <= 360.0 and np.array_equal(2.0 * bounds, np.round(2.0 * bounds)))


def efforts_in_force(mechanism: Mechanism, drives: Mapping[str, Drive]) -> Array:
    """(n,) N m at the joint: each drive's limit by effort and current, inf if there is none."""
    stated = [each.effort for each in limits_in_force(mechanism, drives).values()]
    return np.minimum(stated, [_by_current(drive) for drive in drives.values()])


def _by_current(drive: Drive) -> float:
    motor = drive.motor
    if motor is None or motor.current_limit is None:
        return np.inf
    return abs(float(motor.current_limit * motor.torque_constant * drive.ratio))


def _tighter(joint: Limits, drive: Limits) -> Limits:
    lower, upper = max(joint.lower, drive.lower), min(joint.upper, drive.upper)
    return Limits(
        lower=lower if lower > -ENDLESS else -np.inf,
        upper=upper if upper < ENDLESS else np.inf,
        velocity=min(joint.velocity or np.inf, drive.velocity),
        effort=min(joint.effort or np.inf, drive.effort),
    )

"""The door for drives: what their numbers must satisfy before any law sees them."""

from dataclasses import fields
from itertools import product
from typing import Any

import numpy as np

from cutpoint.errors import ModelError
from cutpoint.model.drive import (
    Compliance,
    Drive,
    Friction,
    Hysteresis,
    KinematicError,
    Motor,
    Ratings,
    Rotor,
)
from cutpoint.model.mechanism import Limits
from cutpoint.scalars import leaves

_POSITIVE = ("stiffness", "hardening", "stribeck_velocity", "smoothing", "gap", "distance", "reach")
_NOT_NEGATIVE = ("coulomb", "static", "viscous", "damping", "per_load")

_PARTS: dict[str, type] = {
    "rotor": Rotor, "compliance": Compliance, "link_friction": Friction, "motor_friction": Friction, "limits": Limits,
    "kinematic_error": KinematicError, "hysteresis": Hysteresis, "motor": Motor, "ratings": Ratings,
}  # fmt: skip

_NO_NUMBERS = ("in_link_inertia", "coupling", "ripple", "cogging")


def check_drive(name: str, drive: Drive) -> None:
    """Parts of their kinds, numbers finite, ratio not zero, a rotor where it bends; each part within its own bounds."""
    _check_kinds(name, drive)
    for number in leaves([getattr(drive, field.name) for field in fields(drive) if field.name != "limits"]):
        if not np.isfinite(number):
            raise ModelError(f"joint {name!r}: its drive holds {number}, every number must be finite", joint=name)
    if any(np.isnan(bound) for bound in leaves(drive.limits)):
        raise ModelError(f"joint {name!r}: limits {drive.limits} hold nan; infinite is no limit", joint=name)
    if drive.ratio == 0:
        raise ModelError(f"joint {name!r}: ratio 0 must not be zero: motor turns per joint turn, signed", joint=name)
    if drive.is_elastic and (drive.rotor is None or drive.rotor.inertia <= 0):
        raise ModelError(f"joint {name!r}: an elastic drive needs a rotor with a positive inertia, kg m2", joint=name)
    if drive.kinematic_error and drive.kinematic_error.steepest(drive.ratio) >= 1:
        rule = "order * ratio * amplitude, summed over harmonics, must stay below 1, or the drive would run backwards"
        raise ModelError(f"joint {name!r}: kinematic error is too large: {rule}", joint=name)
    for what in ("kinematic_error", "hysteresis"):
        if getattr(drive, what) and not drive.is_elastic:
            told = {"kinematic_error": "a kinematic error", "hysteresis": "hysteresis"}[what]
            raise ModelError(f"joint {name!r}: {told} needs an elastic drive; give it a compliance", joint=name)
    if drive.rotor and drive.rotor.coupling not in ("reduced", "full"):
        found = drive.rotor.coupling
        raise ModelError(f"joint {name!r}: rotor coupling {found!r} must be 'reduced' or 'full'", joint=name)
    if drive.rotor and min(drive.rotor.inertia, drive.rotor.mass, drive.rotor.transverse) < 0:
        raise ModelError(f"joint {name!r}: rotor inertia, mass and transverse must not be negative", joint=name)
    _check_friction(name, drive)
    _check_motor(name, drive.motor)
    for law in (drive.compliance, drive.hysteresis, drive.link_friction, drive.motor_friction):
        _check_constants(name, law)


def _check_kinds(name: str, drive: Any) -> None:
    """Each part is what its field says; numbers are no texts, and are there where they must be."""
    if not isinstance(drive, Drive):
        raise ModelError(f"joint {name!r}: its drive must be a Drive, got {drive!r}", joint=name)
    for what, kind in _PARTS.items():
        part = getattr(drive, what)
        if part is not None and not isinstance(part, kind):
            raise ModelError(f"joint {name!r}: {what} must be a {kind.__name__}, got {part!r}", joint=name)
    for part in (drive, drive.rotor, drive.motor, drive.ratings):
        for field in fields(part) if part else ():
            value = getattr(part, field.name)
            left_out = value is None and field.default is None
            if field.name not in (*_PARTS, *_NO_NUMBERS) and not left_out:
                _check_number(name, field.name, value)


def _check_number(name: str, what: str, value: Any) -> None:
    if isinstance(value, bool) or not hasattr(type(value), "__neg__"):
        raise ModelError(f"joint {name!r}: {what} must be a number, got {value!r}", joint=name)


def _check_friction(name: str, drive: Drive) -> None:
    """Load counts on the motor's side only; with bristles it takes a spring to tell the load."""
    if getattr(_sliding(drive.link_friction), "per_load", None) is not None:
        rule = "per_load is for motor_friction, where the gear's teeth are"
        raise ModelError(f"joint {name!r}: link friction grows with load; {rule}", joint=name)
    bristles = drive.motor_friction is not _sliding(drive.motor_friction)
    if not drive.is_elastic and bristles and _sliding(drive.motor_friction).per_load is not None:
        rule = "presliding friction that grows with load needs an elastic drive, whose spring tells the load"
        raise ModelError(f"joint {name!r}: {rule}; give it a compliance", joint=name)
    for law in (drive.link_friction, drive.motor_friction):
        sliding, asymmetry = _sliding(law), getattr(_sliding(law), "asymmetry", None)
        if asymmetry is not None and abs(asymmetry) >= 1:
            raise ModelError(f"joint {name!r}: asymmetry {asymmetry} must be between -1 and 1", joint=name)
        share = (getattr(sliding, "per_load", None) or 0) * (1 + abs(asymmetry or 0))
        if share >= 1:
            rule = "must stay below 1, or no load could be moved"
            raise ModelError(f"joint {name!r}: friction's share of the load {share:g} {rule}", joint=name)
        if sliding is not law and sliding.plateau(0) <= 0:
            raise ModelError(f"joint {name!r}: presliding needs dry friction, got none at rest", joint=name)
        elastic = getattr(law, "elastic", 0)
        if not 0 <= elastic < 1:
            raise ModelError(f"joint {name!r}: elastic {elastic} must be at least 0 and below 1", joint=name)


def _sliding(law: Any) -> Any:
    """Friction while it slides: of bristles, what they turn into."""
    return getattr(law, "sliding", law)


def _check_motor(name: str, motor: Motor | None) -> None:
    if motor is None:
        return
    for constant in ("torque_constant", "resistance", "bandwidth", "current_limit", "voltage_limit"):
        value = getattr(motor, constant)
        if value is not None and value <= 0:
            raise ModelError(f"joint {name!r}: motor {constant} {value} must be positive", joint=name)
    if motor.delay is not None and motor.delay < 0:
        raise ModelError(f"joint {name!r}: motor delay {motor.delay} s must not be negative", joint=name)
    if motor.voltage_limit is not None and motor.resistance is None:
        raise ModelError(f"joint {name!r}: a voltage limit needs the motor's resistance, ohm", joint=name)
    if sum(abs(wave.amplitude) for wave in motor.ripple) >= 1:
        raise ModelError(f"joint {name!r}: torque ripple, summed over its waves, must stay below 1", joint=name)


def _check_constants(name: str, law: Any) -> None:
    """Constants of spring and friction laws: positive where a law divides by them, otherwise not negative."""
    parts = (law, getattr(law, "sliding", None), getattr(law, "spring", None))
    for part, constant in product(parts, (*_POSITIVE, *_NOT_NEGATIVE)):
        if constant != "per_load" and not isinstance(value := getattr(part, constant, 0.0), (tuple, np.ndarray)):
            _check_number(name, constant, value)
    for part, constant in product(parts, _POSITIVE):
        if part is not None and np.min(getattr(part, constant, 1.0)) <= 0:
            value = getattr(part, constant)
            raise ModelError(f"joint {name!r}: {constant} {value} must be positive", joint=name, constant=constant)
    for part, constant in product(parts, _NOT_NEGATIVE):
        value = getattr(part, constant, None)
        if value is not None and np.min(value) < 0:
            raise ModelError(f"joint {name!r}: {constant} {value} must not be negative", joint=name, constant=constant)

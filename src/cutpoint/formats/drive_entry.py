"""One entry of a drive file to a `Drive` and back: the rules that join several fields, and who becomes what."""

from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.formats.drive_section import Section
from cutpoint.formats.drive_sheet import (
    ComplianceSheet,
    DriveSheet,
    GearSheet,
    LimitsSheet,
    LinkFrictionSheet,
    RotorSheet,
)
from cutpoint.mechanics.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.friction import Coulomb, Stribeck
from cutpoint.model.drive import Compliance, Drive, Friction, Rotor
from cutpoint.model.mechanism import Limits


def to_drive(sheet: DriveSheet, section: Section) -> Drive:
    """The drive that a sheet describes.

    Raises ModelError: ratio and gear both, a zero ratio, a gear on a joint that slides, both or neither spring law, an
    elastic drive without rotor, a rotor's mass that its link already holds or that no body can have, damping without a
    spring, static below Coulomb friction, bounds out of order.
    """
    friction, rotor = sheet.friction, sheet.rotor
    compliance = _compliance(sheet.compliance, section) if sheet.compliance else None
    _check_elastic(sheet, section)
    return Drive(
        ratio=_ratio(sheet, section),
        rotor=_rotor(rotor, section) if rotor else None,
        compliance=compliance,
        damping=sheet.damping,
        link_friction=_link_friction(friction.link, section) if friction and friction.link else None,
        motor_friction=Coulomb(**friction.motor.model_dump()) if friction and friction.motor else None,
        limits=_limits(sheet.limits, section) if sheet.limits else Limits(),
        torque_constant=sheet.torque_constant,
    )


def to_entry(drive: Drive) -> dict[str, Any]:
    """The fields that give the same drive when read back, defaults left out."""
    friction = {"link": _law_entry(drive.link_friction), "motor": _law_entry(drive.motor_friction)}
    fields = {
        "rotor": drive.rotor and _rotor_entry(drive.rotor),
        "compliance": _law_entry(drive.compliance) or "rigid",
        "damping": _number(drive.damping),
        "friction": _stated(friction),
        "limits": _stated(_limits_entry(drive.limits)),
        "torque_constant": _number(drive.torque_constant),
    }
    return {"ratio": float(drive.ratio)} | (_stated(fields) or {})


def _ratio(sheet: DriveSheet, section: Section) -> float:
    if sheet.gear is None:
        ratio = 1.0 if sheet.ratio is None else sheet.ratio
        if ratio == 0.0:
            raise section.error(("ratio",), f"{section.stated(DriveSheet, ('ratio',), ratio)} must not be zero")
        return ratio
    if sheet.ratio is not None:
        raise section.error(("gear",), "has both 'ratio' and 'gear'; state one of them")
    if section.slides:
        raise section.error(("gear",), "'gear' is for joints that turn; on a prismatic joint state 'ratio' in rad/m")
    return harmonic_ratio(sheet.gear)


def harmonic_ratio(gear: GearSheet) -> float:
    """Signed motor turns per joint turn of a harmonic drive, from Xia (2019) eq. (1) with one part at rest."""
    return gear.reduction + 1.0 if gear.fixed == "flexspline" else -gear.reduction


def _check_elastic(sheet: DriveSheet, section: Section) -> None:
    if sheet.compliance and sheet.rotor is None:
        raise section.error(("compliance",), "an elastic drive needs 'rotor' with its 'inertia' (kg m2)")
    if sheet.damping and sheet.compliance is None:
        stated = section.stated(DriveSheet, ("damping",), sheet.damping)
        raise section.error(("damping",), f"{stated} is the spring's, but 'compliance' is rigid")


def _rotor(sheet: RotorSheet, section: Section) -> Rotor:
    """Of an axisymmetric body the inertia about the axis is at most twice that across it."""
    for name in ("mass", "transverse", "position"):
        if sheet.in_link_inertia and getattr(sheet, name):
            path = ("rotor", name)
            stated = section.stated(DriveSheet, path, getattr(sheet, name))
            raise section.error(path, f"{stated} counts only with 'in_link_inertia: false'; the link holds the rotor")
    if sheet.transverse and sheet.inertia > 2.0 * sheet.transverse:
        path = ("rotor", "transverse")
        stated = section.stated(DriveSheet, path, sheet.transverse)
        raise section.error(path, f"{stated} must be at least half of inertia {sheet.inertia!r}")
    return Rotor(**sheet.model_dump())


def _compliance(sheet: ComplianceSheet, section: Section) -> Compliance:
    if (sheet.linear is None) == (sheet.flexspline is None):
        raise section.error(("compliance",), "compliance must state exactly one of 'linear', 'flexspline'")
    if sheet.linear:
        return LinearSpring(sheet.linear.stiffness)
    assert sheet.flexspline is not None
    return Flexspline(sheet.flexspline.stiffness, sheet.flexspline.hardening)


def _link_friction(sheet: LinkFrictionSheet, section: Section) -> Friction:
    path = ("friction", "link")
    if sheet.static is None and sheet.stribeck_velocity is None:
        return Coulomb(sheet.coulomb, sheet.viscous, sheet.smoothing)
    if sheet.static is None or sheet.stribeck_velocity is None:
        raise section.error(path, "friction.link must state 'static' and 'stribeck_velocity' together")
    if sheet.static < sheet.coulomb:
        stated = section.stated(DriveSheet, (*path, "static"), sheet.static)
        rule = f"must not be below coulomb {sheet.coulomb!r}"
        raise section.error((*path, "static"), f"{stated} {rule}")
    return Stribeck(sheet.coulomb, sheet.static, sheet.viscous, sheet.stribeck_velocity, sheet.smoothing)


def _limits(sheet: LimitsSheet, section: Section) -> Limits:
    lower, upper = sheet.position or (-np.inf, np.inf)
    if not lower < upper:  # false for nan too
        path = ("limits", "position")
        complaint = f"limits.position [{lower!r}, {upper!r}] must be [lower, upper] with lower < upper"
        raise section.error(path, complaint)
    return Limits(lower, upper, sheet.velocity or np.inf, sheet.torque or np.inf)


def _law_entry(law: Compliance | Friction | None) -> dict[str, Any] | None:
    match law:
        case None:
            return None
        case LinearSpring(stiffness):
            return {"linear": {"stiffness": float(stiffness)}}
        case Flexspline(stiffness, hardening):
            return {"flexspline": {"stiffness": float(stiffness), "hardening": float(hardening)}}
        case Stribeck() | Coulomb():
            return {name: float(value) for name, value in vars(law).items()}
    raise InputError(f"a drive file has no words for {law!r}", law=law)


def _rotor_entry(rotor: Rotor) -> dict[str, Any]:
    """Its own mass only where the link does not hold it: elsewhere it means nothing, and reading would refuse it."""
    own = () if rotor.in_link_inertia else ("mass", "transverse", "position")
    entry = {"inertia": float(rotor.inertia), "in_link_inertia": bool(rotor.in_link_inertia)}
    entry |= {name: float(value) for name in own if (value := getattr(rotor, name))}
    return entry | ({"coupling": "full"} if rotor.coupling == "full" else {})


def _limits_entry(limits: Limits) -> dict[str, Any]:
    position = [float(limits.lower), float(limits.upper)]
    bounded = np.isfinite(position).any()
    effort, velocity = _number(limits.effort), _number(limits.velocity)
    return {"torque": effort, "velocity": velocity, "position": position if bounded else None}


def _number(value: float | None) -> float | None:
    """A number that a file states: None where there is none, or no bound."""
    return float(value) if value is not None and np.isfinite(value) else None


def _stated(fields: dict[str, Any]) -> dict[str, Any] | None:
    return {name: value for name, value in fields.items() if value is not None} or None

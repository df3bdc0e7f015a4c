"""One entry of a drive file to a `Drive` and back: the rules that join several fields, and who becomes what."""

from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.formats.drive_section import Section
from cutpoint.formats.drive_sheet import (
    CatalogueSheet,
    ComplianceSheet,
    DriveSheet,
    GearSheet,
    LimitsSheet,
    LinkFrictionSheet,
    RotorSheet,
)
from cutpoint.mechanics.catalogue import CatalogueSpring
from cutpoint.mechanics.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.friction import Coulomb, Stribeck
from cutpoint.mechanics.kinematic_error import Harmonic, KinematicError
from cutpoint.mechanics.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.model.drive import Compliance, Drive, Friction, Rotor
from cutpoint.model.mechanism import Limits


def to_drive(sheet: DriveSheet, section: Section) -> Drive:
    """The drive that a sheet describes.

    Raises ModelError: ratio and gear both, a zero ratio, a gear on a joint that slides, both or neither spring law, an
    elastic drive without rotor, a rotor's mass that its link already holds or that no body can have, damping without a
    spring, static below Coulomb friction, bounds out of order.
    """
    friction, rotor = sheet.friction, sheet.rotor
    compliance = _compliance(sheet.compliance, _ratio(sheet, section), section) if sheet.compliance else None
    _check_elastic(sheet, section)
    return Drive(
        ratio=_ratio(sheet, section),
        rotor=_rotor(rotor, section) if rotor else None,
        compliance=compliance,
        damping=sheet.damping,
        kinematic_error=_kinematic_error(sheet, section) if sheet.kinematic_error else None,
        link_friction=_link_friction(friction.link, section) if friction and friction.link else None,
        motor_friction=Coulomb(**friction.motor.model_dump()) if friction and friction.motor else None,
        limits=_limits(sheet.limits, section) if sheet.limits else Limits(),
        torque_constant=sheet.torque_constant,
    )


def to_entry(drive: Drive) -> dict[str, Any]:
    """The fields that give the same drive when read back, defaults left out."""
    if isinstance(drive.compliance, HarmonicSpring) and drive.compliance.wave_generator.ratio != abs(drive.ratio):
        raise InputError("a drive file has one ratio; the wave generator's is another", ratio=drive.ratio)
    friction = {"link": _law_entry(drive.link_friction), "motor": _law_entry(drive.motor_friction)}
    fields = {
        "rotor": drive.rotor and _rotor_entry(drive.rotor),
        "compliance": _law_entry(drive.compliance) or "rigid",
        "damping": _number(drive.damping),
        "kinematic_error": _error_entry(drive.kinematic_error),
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


def _compliance(sheet: ComplianceSheet, ratio: float, section: Section) -> Compliance:
    if sum(law is not None for law in (sheet.linear, sheet.flexspline, sheet.catalogue)) != 1:
        raise section.error(("compliance",), "compliance must state exactly one of 'linear', 'flexspline', 'catalogue'")
    if sheet.wave_generator and not sheet.flexspline:
        path = ("compliance", "wave_generator")
        raise section.error(path, "compliance.wave_generator goes in series with 'flexspline', which is not stated")
    if sheet.linear:
        return LinearSpring(sheet.linear.stiffness)
    if sheet.catalogue:
        return _catalogue(sheet.catalogue, section)
    assert sheet.flexspline is not None
    flexspline = Flexspline(sheet.flexspline.stiffness, sheet.flexspline.hardening)
    if sheet.wave_generator is None:
        return flexspline
    wave = sheet.wave_generator
    return HarmonicSpring(flexspline, WaveGenerator(wave.stiffness, wave.hardening, abs(ratio), wave.blend))


def _catalogue(sheet: CatalogueSheet, section: Section) -> CatalogueSpring:
    if sheet.t2 <= sheet.t1:
        path = ("compliance", "catalogue", "t2")
        raise section.error(path, f"{section.stated(DriveSheet, path, sheet.t2)} must be above t1 {sheet.t1!r}")
    return CatalogueSpring(**sheet.model_dump())


def _kinematic_error(sheet: DriveSheet, section: Section) -> KinematicError:
    assert sheet.kinematic_error is not None
    stated, path = sheet.kinematic_error, ("kinematic_error",)
    if sheet.compliance is None:
        raise section.error(path, "'kinematic_error' needs an elastic drive, but 'compliance' is rigid")
    if stated.order != int(stated.order):
        found = section.stated(DriveSheet, (*path, "order"), stated.order)
        raise section.error((*path, "order"), f"{found} must be a whole number of waves a turn")
    error = KinematicError((Harmonic(int(stated.order), stated.amplitude, stated.phase),))
    steepest = error.steepest(_ratio(sheet, section))
    if steepest >= 1.0:
        found = section.stated(DriveSheet, (*path, "amplitude"), stated.amplitude)
        rule = f"times order and ratio is {steepest:.3g}; it must stay below 1, or the drive would run backwards"
        raise section.error((*path, "amplitude"), f"{found} {rule}")
    return error


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
        case CatalogueSpring():
            return {"catalogue": {name: float(value) for name, value in vars(law).items()}}
        case HarmonicSpring(flexspline, wave):
            own = {name: float(getattr(wave, name)) for name in ("stiffness", "hardening", "blend")}
            return (_law_entry(flexspline) or {}) | {"wave_generator": own}
        case Stribeck() | Coulomb():
            return {name: float(value) for name, value in vars(law).items()}
    raise InputError(f"a drive file has no words for {law!r}", law=law)


def _error_entry(error: Any) -> dict[str, Any] | None:
    match error:
        case None:
            return None
        case KinematicError((Harmonic(order, amplitude, phase),)):
            return {"amplitude": float(amplitude), "order": float(order), "phase": float(phase)}
    raise InputError(f"a drive file has words for one harmonic of kinematic error, not for {error!r}", error=error)


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

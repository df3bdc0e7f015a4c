"""One entry of a drive file to a `Drive`: the rules that join several fields, and who becomes what."""

import numpy as np

from cutpoint.formats.drive_section import Section
from cutpoint.formats.drive_sheet import DriveSheet, GearSheet, LimitsSheet
from cutpoint.formats.friction_entry import to_friction
from cutpoint.formats.motor_sheets import RotorSheet
from cutpoint.formats.sheet import WaveSheet
from cutpoint.formats.spring_sheets import CatalogueSheet, ComplianceSheet, HysteresisSheet
from cutpoint.mechanics.backlash import Backlash
from cutpoint.mechanics.catalogue import CatalogueSpring
from cutpoint.mechanics.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.hysteresis import MaxwellSlip
from cutpoint.mechanics.kinematic_error import KinematicError
from cutpoint.mechanics.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.model.drive import Compliance, Drive, Harmonic, Motor, Ratings, Rotor
from cutpoint.model.drive_validation import STEEPEST, complaints
from cutpoint.model.mechanism import Limits


def to_drive(sheet: DriveSheet, section: Section) -> Drive:
    """The drive that a sheet describes.

    Raises ModelError: ratio and gear both, a zero ratio, a gear on a joint that slides, both or neither spring law, an
    elastic drive without rotor, a rotor's mass that its link already holds or that no body can have, damping without a
    spring, static below Coulomb friction, bounds out of order; and what `check_drive` refuses.
    """
    friction, rotor, ratio = sheet.friction, sheet.rotor, _ratio(sheet, section)
    _check_elastic(sheet, section)
    spring = _compliance(sheet.compliance, ratio, section) if sheet.compliance else None
    drive = Drive(
        ratio=ratio,
        rotor=_rotor(rotor, section) if rotor else None,
        compliance=Backlash(spring, sheet.backlash) if spring and sheet.backlash else spring,
        damping=sheet.damping,
        kinematic_error=_kinematic_error(sheet, section) if sheet.kinematic_error else None,
        hysteresis=_hysteresis(sheet.hysteresis, spring, section) if sheet.hysteresis and spring else None,
        link_friction=to_friction(friction.link, "link", section) if friction and friction.link else None,
        motor_friction=to_friction(friction.motor, "motor", section) if friction and friction.motor else None,
        motor=_motor(sheet, section) if sheet.motor else None,
        limits=_limits(sheet.limits, section) if sheet.limits else Limits(),
        ratings=Ratings(**sheet.ratings.model_dump()) if sheet.ratings else None,
    )
    for field, words in complaints(drive):
        part, *rest = field.split(".")
        raise section.error((*_SIDES.get(part, (part,)), *rest), words)
    return drive


_SIDES = {"link_friction": ("friction", "link"), "motor_friction": ("friction", "motor")}
"""Where a file has what a drive has by other names."""


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
    for name in ("damping", "backlash"):
        if getattr(sheet, name) and sheet.compliance is None:
            stated = section.stated(DriveSheet, (name,), getattr(sheet, name))
            raise section.error((name,), f"{stated} is the spring's, but 'compliance' is rigid")
    for name in ("kinematic_error", "hysteresis"):
        if getattr(sheet, name) and sheet.compliance is None:
            raise section.error((name,), f"{name!r} needs an elastic drive, but 'compliance' is rigid")


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


def _hysteresis(sheet: HysteresisSheet, spring: Compliance, section: Section) -> MaxwellSlip:
    """Elements whose slipping torque bends the spring by half of the loss."""
    path = ("hysteresis", "elements")
    torque = float(spring.torque(sheet.loss / 2))
    elements = _whole(sheet.elements, path, "elements", section)
    return MaxwellSlip.smooth(torque, sheet.reach or sheet.loss, elements)


def _kinematic_error(sheet: DriveSheet, section: Section) -> KinematicError:
    assert sheet.kinematic_error is not None
    path = ("kinematic_error",)
    error = KinematicError(_harmonics(sheet.kinematic_error, path, section))
    steepest = error.steepest(_ratio(sheet, section))
    if steepest > STEEPEST:
        found = section.stated(DriveSheet, (*path, "amplitude"), sheet.kinematic_error.amplitude)
        told = f"{found} times order and ratio is {steepest:.3g}"
        rule = f"it must not exceed {STEEPEST}: at 1 the drive would run backwards"
        raise section.error((*path, "amplitude"), f"{told}; {rule}")
    return error


def _motor(sheet: DriveSheet, section: Section) -> Motor:
    assert sheet.motor is not None
    if sheet.motor.voltage_limit is not None and sheet.motor.resistance is None:
        path = ("motor", "voltage_limit")
        stated = section.stated(DriveSheet, path, sheet.motor.voltage_limit)
        raise section.error(path, f"{stated} needs motor.resistance (ohm) beside it")
    waves = {
        name: _harmonics(wave, ("motor", name), section)
        for name in ("ripple", "cogging")
        if (wave := getattr(sheet.motor, name))
    }
    return Motor(**sheet.motor.model_dump(exclude={"ripple", "cogging"}), **waves)


def _harmonics(sheet: WaveSheet, path: tuple[str, ...], section: Section) -> tuple[Harmonic, ...]:
    """The first wave and the further ones."""
    own = sheet.model_dump()
    rows = [(path, (own["order"], own["amplitude"], own["phase"]))]
    rows += [((*path, "harmonics"), tuple(row)) for row in sheet.harmonics]
    found = []
    for at, (order, amplitude, phase) in rows:
        if amplitude < 0.0 or order < 1.0:
            raise section.error(at, f"{'.'.join(at)} [{order!r}, {amplitude!r}, {phase!r}] must not be negative")
        found.append(Harmonic(_whole(order, (*at, "order"), "waves a turn", section), amplitude, phase))
    return tuple(found)


def _whole(value: float, path: tuple[str, ...], what: str, section: Section) -> int:
    if value != int(value):
        raise section.error(path, f"{'.'.join(path)} {value!r} must be a whole number of {what}")
    return int(value)


def _limits(sheet: LimitsSheet, section: Section) -> Limits:
    lower, upper = sheet.position or (-np.inf, np.inf)
    if not lower < upper:  # false for nan too
        path = ("limits", "position")
        complaint = f"limits.position [{lower!r}, {upper!r}] must be [lower, upper] with lower < upper"
        raise section.error(path, complaint)
    return Limits(lower, upper, sheet.velocity or np.inf, sheet.torque or np.inf)

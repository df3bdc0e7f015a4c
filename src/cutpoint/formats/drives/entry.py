"""Conversion of one drive-file entry to a `Drive`, with rules that involve several fields."""

from dataclasses import replace

import numpy as np

from cutpoint.formats.drives.drive_sheet import DriveSheet, GearSheet, LimitsSheet
from cutpoint.formats.drives.friction_entry import to_friction
from cutpoint.formats.drives.motor_sheets import MotorSheet, RotorSheet
from cutpoint.formats.drives.section import Section
from cutpoint.formats.drives.sheet import WaveSheet
from cutpoint.formats.drives.spring_sheets import ComplianceSheet, HysteresisSheet
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.model.drive import Compliance, Drive, Harmonic, Motor, Ratings, Rotor
from cutpoint.model.drive_validation import complaints
from cutpoint.model.mechanism import Limits


def to_drive(sheet: DriveSheet, section: Section) -> Drive:
    """The drive that a sheet describes.

    Raises ModelError: ratio and gear both, a gear on a joint that slides, several spring laws or none, backlash or
    hysteresis without a spring, a rotor's mass that its link already holds, static below Coulomb friction, waves or
    elements that are not whole, bounds out of order; and what `check_drive` refuses.
    """
    friction, rotor, ratio = sheet.friction, sheet.rotor, _ratio(sheet, section)
    _check_spring(sheet, section)
    spring = _compliance(sheet.compliance, ratio, section) if sheet.compliance else None
    error = sheet.kinematic_error
    drive = Drive(
        ratio=ratio,
        rotor=_rotor(rotor, section) if rotor else None,
        compliance=Backlash(spring, sheet.backlash) if spring and sheet.backlash else spring,
        damping=sheet.damping,
        kinematic_error=KinematicError(_harmonics(error, ("kinematic_error",), section)) if error else None,
        link_friction=to_friction(friction.link, "link", section) if friction and friction.link else None,
        motor_friction=to_friction(friction.motor, "motor", section) if friction and friction.motor else None,
        motor=_motor(sheet.motor, section) if sheet.motor else None,
        limits=_limits(sheet.limits, section) if sheet.limits else Limits(),
        ratings=Ratings(**sheet.ratings.model_dump()) if sheet.ratings else None,
    )
    _check(drive, section)
    if spring and sheet.hysteresis:  # last, since its torque depends on the spring, which has been checked by now
        drive = replace(drive, hysteresis=_hysteresis(sheet.hysteresis, spring, section))
        _check(drive, section)
    return drive


_KEYS = {
    "link_friction": "friction.link",
    "motor_friction": "friction.motor",
    "compliance.spring": "compliance",
    "compliance.t2": "compliance.catalogue.t2",
}
"""A drive's names that a file spells differently, each to be replaced in turn."""


def _check(drive: Drive, section: Section) -> None:
    """Raises ModelError for the first rule that the drive breaks, in the file's words: its keys and units."""
    for field, words, number in complaints(drive):
        for own, key in _KEYS.items():
            field = field.replace(own, key)
        path = tuple(field.split("."))
        raise section.error(path, words if number is None else f"{section.stated(DriveSheet, path, number)} {words}")


def _ratio(sheet: DriveSheet, section: Section) -> float:
    if sheet.gear is None:
        return 1.0 if sheet.ratio is None else sheet.ratio
    if sheet.ratio is not None:
        raise section.error(("gear",), "has both 'ratio' and 'gear'; state one of them")
    if section.slides:
        raise section.error(("gear",), "'gear' is for rotary joints; on a prismatic joint state 'ratio' in rad/m")
    return harmonic_ratio(sheet.gear)


def harmonic_ratio(gear: GearSheet) -> float:
    """Signed motor turns per joint turn of a harmonic drive, from Xia (2019) eq. (1) with one part at rest."""
    return gear.reduction + 1.0 if gear.fixed == "flexspline" else -gear.reduction


def _check_spring(sheet: DriveSheet, section: Section) -> None:
    """Checks that parts which belong to a spring, or derive from it, have one."""
    for name in ("backlash", "hysteresis"):
        if getattr(sheet, name) and sheet.compliance is None:
            raise section.error((name,), f"{name!r} needs an elastic drive, but 'compliance' is rigid")


def _rotor(sheet: RotorSheet, section: Section) -> Rotor:
    for name in ("mass", "transverse", "position"):
        if sheet.in_link_inertia and getattr(sheet, name):
            path = ("rotor", name)
            stated = section.stated(DriveSheet, path, getattr(sheet, name))
            raise section.error(
                path, f"{stated} counts only with 'in_link_inertia: false'; the link includes the rotor"
            )
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
        return CatalogueSpring(**sheet.catalogue.model_dump())
    assert sheet.flexspline is not None
    flexspline = Flexspline(sheet.flexspline.stiffness, sheet.flexspline.hardening)
    if sheet.wave_generator is None:
        return flexspline
    wave = sheet.wave_generator
    return HarmonicSpring(flexspline, WaveGenerator(wave.stiffness, wave.hardening, abs(ratio), wave.blend))


def _hysteresis(sheet: HysteresisSheet, spring: Compliance, section: Section) -> MaxwellSlip:
    """Elements whose slipping torque deflects the spring by half of the loss."""
    path = ("hysteresis", "elements")
    torque = float(spring.torque(sheet.loss / 2))
    elements = _whole(sheet.elements, path, "elements", section)
    return MaxwellSlip.smooth(torque, sheet.reach or sheet.loss, elements)


def _motor(sheet: MotorSheet, section: Section) -> Motor:
    waves = {
        name: _harmonics(wave, ("motor", name), section)
        for name in ("ripple", "cogging")
        if (wave := getattr(sheet, name))
    }
    return Motor(**sheet.model_dump(exclude={"ripple", "cogging"}), **waves)


def _harmonics(sheet: WaveSheet, path: tuple[str, ...], section: Section) -> tuple[Harmonic, ...]:
    """The first wave and the further ones."""
    rows = [(path, (sheet.order, sheet.amplitude, sheet.phase))]
    rows += [((*path, "harmonics"), tuple(row)) for row in sheet.harmonics]
    found = []
    for at, (order, amplitude, phase) in rows:
        if amplitude < 0.0 or order < 1.0:
            rule = "must have an order of at least 1 and an amplitude that is not negative"
            raise section.error(at, f"{'.'.join(at)} [{order!r}, {amplitude!r}, {phase!r}] {rule}")
        found.append(Harmonic(_whole(order, (*at, "order"), "waves per turn", section), amplitude, phase))
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

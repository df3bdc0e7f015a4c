"""Numbers of a drive file that are plausible in a data sheet's units, but nearly impossible in the file's."""

import math
from collections.abc import Iterator
from typing import Any

from cutpoint.formats.drives.drive_sheet import DriveSheet
from cutpoint.formats.drives.section import Section
from cutpoint.formats.safe_yaml import YamlPath


class UnitsWarning(UserWarning):
    """A number of a drive file looks like one in another unit."""


FASTEST = 1600.0
"""rad/s, of motors: 15 000 turns a minute."""

WIDEST = 0.05
"""rad, three degrees: backlash, lost motion, or deflection at the first corner of a gear's curve."""

HEAVIEST, GEARED = 0.05, 10.0
"""kg m2, of a rotor before a gear of such a ratio: at the joint, at least 5 kg m2."""

SOFTEST = 5.0
"""N m/rad, of a spring behind such a gear: a kilogram at half a metre would deflect it by a radian."""

STRONGEST = 5.0
"""N m/A, of a motor before such a gear."""

LEAST_RATIO = 0.2
"""Motor turns per joint turn."""

FROM_RATIO, TO_RATIO = 10.0, 1e5
"""rad/m, of the motor of a prismatic joint: leads of 0.6 m and of 0.06 mm."""

SOFTEST_SLIDE = 1e3
"""N/m, of the spring of a prismatic joint: a kilogram would deflect it by a centimetre."""

LATEST = 0.05
"""s, delay of commands to a motor's current loop."""

RPM, ARCMIN = "rpm (1 rpm = 0.1047 rad/s)", "arc minutes (1 arcmin = 2.909e-4 rad)"

Limits = dict[YamlPath, tuple[float, str]]
"""By path, the limit beyond which a number is doubted, and what it looks like."""

OF_MOTORS: Limits = {
    **{("ratings", f"{speed}_speed"): (FASTEST, RPM) for speed in ("rated", "average", "maximum")},
    ("motor", "delay"): (LATEST, "ms (1 ms = 1e-3 s)"),
}

OF_TURNING: Limits = {
    ("backlash",): (WIDEST, ARCMIN),
    ("hysteresis", "loss"): (WIDEST, ARCMIN),
    ("hysteresis", "reach"): (WIDEST, ARCMIN),
}
"""For drives of revolute joints only."""

BEFORE_A_GEAR: Limits = {
    ("rotor", "inertia"): (HEAVIEST, "kg cm2 (1 kg cm2 = 1e-4 kg m2), or like the inertia at the joint"),
    ("motor", "torque_constant"): (STRONGEST, "mN m/A (1 mN m/A = 1e-3 N m/A), or like the constant at the joint"),
}

STIFFNESSES: tuple[YamlPath, ...] = tuple(("compliance", law, "stiffness") for law in ("linear", "flexspline"))
"""Of springs with a stiffness of their own; a drive has at most one."""


def doubts_of(sheet: DriveSheet, section: Section, ratio: float) -> Iterator[tuple[str, YamlPath]]:
    """Numbers that look like another unit in the drive of a revolute joint, in words, and their paths in its entry."""
    geared = abs(ratio) >= GEARED
    yield from _too_large(sheet, section, OF_MOTORS | OF_TURNING | (BEFORE_A_GEAR if geared else {}))
    if sheet.ratio is not None and abs(ratio) < LEAST_RATIO:
        stated = section.stated(DriveSheet, ("ratio",), sheet.ratio)
        remedy = "state motor turns per joint turn"
        yield f"{stated} looks like joint turns per motor turn: {remedy}", ("ratio",)
    for path in STIFFNESSES if geared else ():
        stiffness = _at(sheet, path)
        if stiffness is not None and stiffness < SOFTEST:
            yield f"{section.stated(DriveSheet, path, stiffness)} looks like a number in 10^4 N m/rad", path
    curve = sheet.compliance.catalogue if sheet.compliance else None
    if curve and curve.t1 > WIDEST * curve.k1:
        path = ("compliance", "catalogue", "k1")
        stated, wound = section.stated(DriveSheet, path, curve.k1), f"{curve.t1 / curve.k1:.3g} rad at t1"
        yield f"{stated} is wound up by {wound}: it looks like a number in 10^4 N m/rad", path
    speed = sheet.limits.velocity if sheet.limits else None
    if speed is not None and geared and speed * abs(ratio) > 2.0 * FASTEST:
        path = ("limits", "velocity")
        stated, turns = section.stated(DriveSheet, path, speed), speed * abs(ratio) * 30.0 / math.pi
        likeness = "it looks like degrees per second, or like the motor's own speed"
        yield f"{stated} turns the motor at {turns:.3g} rpm: {likeness}", path


def doubts_of_sliding(sheet: DriveSheet, section: Section, ratio: float) -> Iterator[tuple[str, YamlPath]]:
    """The same for a prismatic joint."""
    yield from _too_large(sheet, section, OF_MOTORS | (BEFORE_A_GEAR if abs(ratio) >= FROM_RATIO else {}))
    if sheet.ratio is not None and abs(ratio) != 1.0 and not FROM_RATIO <= abs(ratio) <= TO_RATIO:
        lead = f"a lead of {2.0 * math.pi / abs(ratio):.3g} m per turn"
        stated = section.stated(DriveSheet, ("ratio",), sheet.ratio)
        yield f"{stated} is {lead}: its unit looks different from 2 pi / lead with the lead in m", ("ratio",)
    for path in STIFFNESSES:
        stiffness = _at(sheet, path)
        if stiffness is not None and stiffness < SOFTEST_SLIDE:
            yield f"{section.stated(DriveSheet, path, stiffness)} looks like N/mm or N/µm", path


def _too_large(sheet: DriveSheet, section: Section, limits: Limits) -> Iterator[tuple[str, YamlPath]]:
    for path, (most, likeness) in limits.items():
        value = _at(sheet, path)
        if value is not None and value > most:
            yield f"{section.stated(DriveSheet, path, value)} looks like {likeness}", path


def _at(sheet: Any, path: YamlPath) -> float | None:
    """The number at a path; None if a part of the path is not stated."""
    for key in path:
        sheet = getattr(sheet, key, None)
    return sheet

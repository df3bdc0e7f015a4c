"""Numbers that were identified, each with its interval and where a drive file states it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import norm

from cutpoint.identification.drives.columns import amplitude_errors
from cutpoint.identification.drives.identify_drives import DriveEstimate
from cutpoint.identification.drives.two_encoders import SpringEstimate
from cutpoint.identification.rigid import RigidEstimate
from cutpoint.identification.uncertainty import Parameter
from cutpoint.robot import Robot

Path = tuple[str, ...]

UNITS = {
    "m": ("kg", "kg"),
    "h": ("kg m", "kg m"),
    "I": ("kg m2", "kg m2"),
    "I_m": ("kg m2", "kg"),
    "viscous": ("N m s/rad", "N s/m"),
    "per_load": ("1", "1"),
}
"""By how a parameter's name begins, on a joint that turns and on one that slides; others are torques."""


@dataclass(frozen=True)
class Number:
    """value, low, high: with its interval, SI at the joint's side.  used: in the model.  prior: as the files had it; NaN
    where they do not say.

    path: of a drive file's entry that states it, () if none does, and scale: what the file's number is of this one.
    told: whether the log tells it; why not, if not.
    """

    joint: str
    name: str
    unit: str
    value: float
    low: float
    high: float
    used: float
    prior: float
    told: bool = True
    why: str = ""
    path: Path = ()
    scale: float = 1.0

    @property
    def remark(self) -> str:
        """The interval in the file's terms, or why there is none."""
        if not self.told:
            return f"not told by the log: {self.why}"
        ends = sorted((self.scale * self.low, self.scale * self.high))
        return f"{ends[0]:.4g} to {ends[1]:.4g}"


def rigid_numbers(robot: Robot, rigid: RigidEstimate) -> tuple[Number, ...]:
    """Base parameters, friction and offsets; robot: as it is now."""
    return tuple(_of_parameter(robot, each) for each in rigid.parameters)


def _of_parameter(robot: Robot, p: Parameter) -> Number:
    kind, _, owner = p.name.partition(".")
    joint = owner if owner in robot.drives else ""
    slides = any(body.joint.name == joint and body.joint.kind == "prismatic" for body in robot.mechanism.bodies)
    unit = UNITS.get(kind, UNITS.get(kind.split("_")[0], ("N m", "N")))[slides]
    path, scale = _place(robot, kind, joint)
    return Number(joint, p.name, unit, p.value, p.low, p.high, p.physical, p.prior, p.told, p.why, path, scale)


def _place(robot: Robot, kind: str, joint: str) -> tuple[Path, float]:
    if not joint:
        return (), 1.0
    drive = robot.drives[joint]
    if kind == "I_m":
        return ("rotor", "inertia"), 1.0 / drive.ratio**2
    return (() if kind == "offset" else ("friction", "link" if drive.link_friction else "motor", kind)), 1.0


def drive_numbers(joint: str, before: Any, found: DriveEstimate, level: float = 0.95) -> tuple[Number, ...]:
    """Of one drive's spring, kinematic error and rotor; before: the drive that the files state."""
    spring, rotor = found.spring, found.rotor
    margin = float(norm.ppf(0.5 + 0.5 * level))
    of_spring = dict(zip(spring.names, spring.values.tolist(), strict=True))
    names = [name for name in vars(spring.compliance) if name in of_spring]
    rows = [
        _row(joint, name, of_spring[name], spring.deviations[name], margin, _stated(before.compliance, name), found,
             "stiffness", ("compliance", spring.law, name))
        for name in names
    ]  # fmt: skip
    if "damping" in of_spring:
        rows.append(
            _row(joint, "damping", of_spring["damping"], spring.deviations["damping"], margin,
                 _stated(before, "damping"), found, "damping", ("damping",))
        )  # fmt: skip
    rows += _waves(joint, spring, margin)
    of_rotor = dict(zip(rotor.names, rotor.values.tolist(), strict=True))
    for name, thing in (("inertia", "rotor inertia"), ("coulomb", "motor friction"), ("viscous", "motor friction")):
        stated = float(before.reflected_inertia) if name == "inertia" else float("nan")
        rows.append(_row(joint, f"motor {name}", of_rotor[name], rotor.deviations[name], margin, stated, found, thing, ()))
    return tuple(rows)


def _row(
    joint: str, name: str, value: float, deviation: float, margin: float, prior: float, found: DriveEstimate,
    thing: str, path: Path,
) -> Number:  # fmt: skip
    why = found.unidentifiable.get(thing, "")
    ends = value - margin * deviation, value + margin * deviation
    used = prior if why else value
    return Number(joint, name, DRIVE_UNITS.get(name, ""), value, *ends, used, prior, not why, why, path)


DRIVE_UNITS: Mapping[str, str] = {
    **dict.fromkeys(("stiffness", "k1", "k2", "k3"), "N m/rad"),
    **dict.fromkeys(("t1", "t2", "motor coulomb"), "N m"),
    "hardening": "1/(N m)",
    "damping": "N m s/rad",
    "motor viscous": "N m s/rad",
    "motor inertia": "kg m2",
}


def _waves(joint: str, spring: SpringEstimate, margin: float) -> list[Number]:
    """Amplitudes of the kinematic error's waves."""
    if spring.kinematic_error is None:
        return []
    error: Any = spring.kinematic_error
    start = spring.names.index(f"sine {error.harmonics[0].order}")
    among = slice(start, start + 2 * len(error.harmonics))
    deviations = amplitude_errors(spring.values[among], spring.covariance[among, among])
    first: Sequence[Path] = [("kinematic_error", "amplitude")]
    paths = [*first, *(("kinematic_error", "harmonics", str(k)) for k in range(len(error.harmonics) - 1))]
    rows: list[Number] = []
    for wave, deviation, path in zip(error.harmonics, deviations.tolist(), paths, strict=True):
        size = float(wave.amplitude)
        ends = size - margin * deviation, size + margin * deviation
        name = f"kinematic error, order {wave.order}"
        rows.append(Number(joint, name, "rad", size, *ends, size, float("nan"), path=path))
    return rows


def _stated(part: Any, name: str) -> float:
    value = getattr(part, name, None)
    return float("nan") if value is None else float(value)

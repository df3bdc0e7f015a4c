"""Identified numbers, each with its interval and its place in a drive file."""

import re
from dataclasses import dataclass

import numpy as np

from cutpoint.identification.rigid.identify_rigid import RigidEstimate
from cutpoint.identification.rigid.uncertainty import FRICTION, Parameter
from cutpoint.model.units import SLIDING
from cutpoint.robot import Robot

EntryPath = tuple[str, ...]
"""Keys, from a joint of a drive file to one of its numbers."""

UNITS = {
    "m": "kg",
    "h": "kg m",
    "I": "kg m2",
    "I_m": "kg m2",
    "viscous": "N m s/rad",
    "per_load": "1",
}
"""Units by the start of a parameter's name, of links and joints that turn; others are torques."""


OF_JOINTS = ("I_m", *FRICTION, "offset")
"""Kinds of joint parameters; others are of links, which may have a joint's name."""


@dataclass(frozen=True)
class Number:
    """value, low, high: with its interval, SI at the joint's side.  used: in the model.  prior: as the files state it.

    NaN where there is no such number.
    path: of a drive file's entry that states it, () if none does, and scale: the file's number over this one.
    told: whether the log determines it; why: the reason if not.
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
    path: EntryPath = ()
    scale: float = 1.0

    @property
    def remark(self) -> str:
        """The interval in the file's units, or why there is none."""
        if not self.told:
            return f"not identified from the log: {self.why}"
        low, high = sorted((self.scale * self.low, self.scale * self.high))
        words = _interval(low, high, self.scale * self.used)
        within = self.low <= self.used <= self.high or np.isnan(self.used)
        return words if within else f"{words} from the log alone; of possible bodies and friction, this fits best"


def _interval(low: float, high: float, value: float) -> str:
    """Its ends, in enough digits to show on which side of them the value is."""

    def shows(ends: list[str]) -> bool:
        first, last = map(float, ends)
        return first < last and (first <= value, last <= value) == (low <= value, high <= value)

    written = [[f"{end:.{digits}g}" for end in (low, high)] for digits in range(4, 16)]
    return " to ".join(next(filter(shows, written), written[-1]))


def rigid_numbers(robot: Robot, rigid: RigidEstimate) -> tuple[Number, ...]:
    """Base parameters, friction and offsets; robot: as it is now."""
    return tuple(_of_parameter(robot, each) for each in rigid.parameters)


def _of_parameter(robot: Robot, p: Parameter) -> Number:
    kind, _, owner = p.name.partition(".")
    joint = owner if kind in OF_JOINTS and owner in robot.drives else ""
    # for a sum, which has no joint, the links' terms give the unit: rotors' are kg on prismatic joints
    terms = [term.partition(".")[0].split()[-1] for term in re.split(" [+-] ", p.name)]
    slides = joint in robot.mechanism.sliding
    kind = kind if joint else next((term for term in terms if term != "I_m"), kind)
    unit = UNITS.get(kind, UNITS.get(kind.split("_")[0], "N m"))
    unit = SLIDING.get(unit, unit) if slides else unit
    path, scale = _place(robot, kind, joint)
    return Number(joint, p.name, unit, p.value, p.low, p.high, p.physical, p.prior, p.told, p.why, path, scale)


def _place(robot: Robot, kind: str, joint: str) -> tuple[EntryPath, float]:
    if not joint:
        return (), 1.0
    drive = robot.drives[joint]
    if kind == "I_m":
        return ("rotor", "inertia"), 1.0 / drive.ratio**2
    # a log determines the sum of friction on both sides, which no line states
    sides = [side for side, law in (("link", drive.link_friction), ("motor", drive.motor_friction)) if law]
    return (() if kind == "offset" or len(sides) != 1 else ("friction", sides[0], kind)), 1.0

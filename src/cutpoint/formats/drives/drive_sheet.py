"""The drive file's fields: types, units, defaults, meanings, and rules for single numbers.

`docs/drive-file.md` says the same in prose and is checked against this.
"""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from cutpoint.formats.drives.friction_sheets import FrictionSheet
from cutpoint.formats.drives.motor_sheets import MotorSheet, RatingsSheet, RotorSheet
from cutpoint.formats.drives.sheet import Sheet, quantity, short
from cutpoint.formats.drives.spring_sheets import ComplianceSheet, HysteresisSheet, KinematicErrorSheet


class GearSheet(Sheet):
    """A harmonic drive by its reduction l and the part that is fixed.  Xia (2019) eq. (1)."""

    reduction: float = quantity("1", "1", "catalogue reduction l of a harmonic drive", gt=0)
    fixed: Literal["flexspline", "circular_spline"] = Field(
        description="flexspline: the circular spline turns the joint, ratio = l + 1;"
        " circular_spline: the flexspline turns it, backwards, ratio = -l"
    )


class LimitsSheet(Sheet):
    """What the drive can do, at the joint's side; no limit where nothing is stated."""

    torque: float | None = quantity("N m", "N", "largest motor torque times ratio", None, gt=0)
    velocity: float | None = quantity("rad/s", "m/s", "largest speed", None, gt=0)
    position: Annotated[list[Annotated[float, Field(allow_inf_nan=True)]], Field(min_length=2, max_length=2)] | None = (
        quantity("rad", "m", "[lower, upper]; -.inf or .inf for no bound", None)
    )


def _rigid_is_none(value: Any) -> Any:
    return None if value == "rigid" else value


class DriveSheet(Sheet):
    """One joint's drive."""

    catalogue: str | None = Field(
        None, description="a drive by its catalogue name; what is stated beside it overrides it"
    )
    ratio: float | None = quantity("1", "rad/m", "signed motor turns per joint turn; 1 without a gear", None)
    gear: GearSheet | None = Field(None, description="the ratio by the gear's design; instead of `ratio`")
    rotor: RotorSheet | None = Field(None, description="the motor's rotating part; required for an elastic drive")
    compliance: Annotated[ComplianceSheet | None, BeforeValidator(_rigid_is_none)] = short(
        "'rigid'", "the spring between motor and link, or `rigid`", None
    )
    backlash: float | None = quantity(
        "rad", "m", "play before the spring, flank to flank; needs `compliance`", None, gt=0
    )
    damping: float | None = quantity("N m s/rad", "N s/m", "of the spring, at the joint's side", None, ge=0)
    hysteresis: HysteresisSheet | None = Field(None, description="of the spring; needs `compliance`")
    kinematic_error: KinematicErrorSheet | None = Field(
        None, description="lag of the unloaded output behind the exact ratio; needs `compliance`"
    )
    friction: FrictionSheet | None = Field(None, description="on either side of the spring")
    motor: MotorSheet | None = Field(None, description="what lies between a torque command and the shaft")
    limits: LimitsSheet | None = Field(None, description="of the drive, at the joint's side")
    ratings: RatingsSheet | None = Field(None, description="what the maker allows; used only by sizing")


class FileSheet(Sheet):
    """The file as a whole."""

    version: float = Field(description="1 for this format")
    defaults: dict[str, Any] = Field({}, description="default fields of every drive below")
    drives: dict[str, dict[str, Any]] = Field(description="one entry per driven joint, by joint name")

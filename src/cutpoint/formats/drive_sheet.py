"""The drive file's fields: types, units, defaults, what each means, and the rules that one number keeps by itself.

`docs/drive-file.md` says the same in prose and is checked against this.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic.config import JsonDict

DEFAULT_SMOOTHING = 0.01
"""Speed, rad/s (m/s), over which dry friction changes sign where nothing is stated."""


def quantity(rotary: str, linear: str, meaning: str, default: Any = ..., **rules: Any) -> Any:
    """A field with its unit on a joint that turns and on one that slides, and rules such as `gt=0`."""
    units: JsonDict = {"unit": rotary, "linear_unit": linear}
    return Field(default, description=meaning, json_schema_extra=units, **rules)


class Sheet(BaseModel):
    """Unknown keys are errors, and nothing is converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class GearSheet(Sheet):
    """A harmonic drive by its reduction l and the part that is fixed.  Xia (2019) eq. (1)."""

    reduction: float = quantity("1", "1", "catalogue reduction l of a harmonic drive", gt=0)
    fixed: Literal["flexspline", "circular_spline"] = Field(
        description="flexspline: the circular spline turns the joint, ratio = l + 1;"
        " circular_spline: the flexspline turns it, backwards, ratio = -l"
    )


class RotorSheet(Sheet):
    """The motor's turning part."""

    inertia: float = quantity(
        "kg m2", "kg m2", "of rotor and wave generator about their axis, on the motor's side of the gear", gt=0
    )
    in_link_inertia: bool = Field(
        True, description="whether the carrying link's inertia in the robot file already holds the rotor's mass"
    )
    mass: float = quantity("kg", "kg", "of the rotor; needs `in_link_inertia: false`", 0.0, ge=0)
    transverse: float = quantity(
        "kg m2", "kg m2", "of the rotor across its axis, about its centre; needs `in_link_inertia: false`", 0.0, ge=0
    )
    position: float = quantity(
        "m", "m", "of the rotor's centre along the joint's axis; needs `in_link_inertia: false`", 0.0
    )
    coupling: Literal["reduced", "full"] = Field(
        "reduced",
        description="reduced: the rotor feels its own spin only; full: its carrier's turning too, eqs. (4)-(11)",
    )


class LinearSheet(Sheet):
    """A spring of constant stiffness."""

    stiffness: float = quantity("N m/rad", "N/m", "of the spring, at the joint's side", gt=0)


class FlexsplineSheet(Sheet):
    """A flexspline that hardens with load.  Xia (2019) eq. (2)."""

    stiffness: float = quantity("N m/rad", "N/m", "K_f0, unloaded, at the joint's side", gt=0)
    hardening: float = quantity("1/(N m)", "1/N", "c_f: stiffness grows by 1 + (c_f torque)^2", gt=0)


class WaveGeneratorSheet(Sheet):
    """A wave generator that hardens with load, in series with the flexspline.  Xia (2019) eq. (3)."""

    stiffness: float = quantity("N m/rad", "N m/rad", "K_w0, unloaded, at the wave generator", gt=0)
    hardening: float = quantity("1/(N m)", "1/(N m)", "c_w: stiffness grows by exp(c_w torque)", gt=0)
    blend: float = quantity(
        "N m", "N m", "torque at the wave generator below which the law's kink at zero is rounded", 0.01, gt=0
    )


class CatalogueSheet(Sheet):
    """A catalogue's stiffness curve: straight segments with rounded corners."""

    k1: float = quantity("N m/rad", "N/m", "stiffness K1, below t1", gt=0)
    k2: float = quantity("N m/rad", "N/m", "stiffness K2, from t1 to t2", gt=0)
    k3: float = quantity("N m/rad", "N/m", "stiffness K3, beyond t2", gt=0)
    t1: float = quantity("N m", "N", "torque T1 of the first corner", gt=0)
    t2: float = quantity("N m", "N", "torque T2 of the second corner, above t1", gt=0)


class ComplianceSheet(Sheet):
    """The spring between motor and link: exactly one law, the flexspline with its wave generator if wanted."""

    linear: LinearSheet | None = Field(None, description="a spring of constant stiffness")
    flexspline: FlexsplineSheet | None = Field(None, description="a flexspline that hardens with load, eq. (2)")
    wave_generator: WaveGeneratorSheet | None = Field(
        None, description="the wave generator's own compliance, in series with `flexspline`, eq. (3)"
    )
    catalogue: CatalogueSheet | None = Field(None, description="the stiffness curve of a catalogue, corners rounded")


class KinematicErrorSheet(Sheet):
    """What the output deviates from ratio-true rotation: one harmonic of the wave generator's angle."""

    amplitude: float = quantity("rad", "m", "half of the catalogue's transmission accuracy, at the joint's side", ge=0)
    order: float = quantity("1", "1", "waves for each turn of the wave generator, a whole number", 2.0, ge=1)
    phase: float = quantity("rad", "rad", "of the wave where the joint's coordinate is zero", 0.0)


class LinkFrictionSheet(Sheet):
    """Friction on the link's speed.  Xia (2019) eq. (54); without `static`, Coulomb and viscous only."""

    coulomb: float = quantity("N m", "N", "dry friction f_c while sliding", 0.0, ge=0)
    static: float | None = quantity("N m", "N", "dry friction f_s near standstill, f_c at least", None, ge=0)
    viscous: float = quantity("N m s/rad", "N s/m", "f_v: friction per speed", 0.0, ge=0)
    stribeck_velocity: float | None = quantity("rad/s", "m/s", "v_s over which f_s falls to f_c", None, gt=0)
    smoothing: float = quantity("rad/s", "m/s", "sgn(speed) is tanh(speed / smoothing)", DEFAULT_SMOOTHING, gt=0)


class MotorFrictionSheet(Sheet):
    """Friction on the rotor's speed, in joint-side units.  Xia (2019) eq. (55), with a viscous part."""

    coulomb: float = quantity("N m", "N", "dry friction as felt at the joint: ratio times the rotor's", 0.0, ge=0)
    viscous: float = quantity(
        "N m s/rad", "N s/m", "friction per speed as felt at the joint: ratio^2 times the rotor's", 0.0, ge=0
    )
    smoothing: float = quantity("rad/s", "m/s", "sgn(speed) is tanh(speed / smoothing)", DEFAULT_SMOOTHING, gt=0)


class FrictionSheet(Sheet):
    """Friction on either side of the spring."""

    link: LinkFrictionSheet | None = Field(None, description="acts on the link's speed, eq. (54)")
    motor: MotorFrictionSheet | None = Field(None, description="acts on the rotor's speed over ratio, eq. (55)")


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

    ratio: float | None = quantity("1", "rad/m", "signed motor turns per joint turn; 1 without a gear", None)
    gear: GearSheet | None = Field(None, description="the ratio by the gear's make; instead of `ratio`")
    rotor: RotorSheet | None = Field(None, description="the motor's turning part; an elastic drive needs it")
    compliance: Annotated[ComplianceSheet | None, BeforeValidator(_rigid_is_none)] = Field(
        None, description="the spring between motor and link, or `rigid`"
    )
    damping: float | None = quantity("N m s/rad", "N s/m", "of the spring, at the joint's side", None, ge=0)
    kinematic_error: KinematicErrorSheet | None = Field(
        None, description="deviation of the output from ratio-true rotation; needs `compliance`"
    )
    friction: FrictionSheet | None = Field(None, description="on either side of the spring")
    limits: LimitsSheet | None = Field(None, description="of the drive, at the joint's side")
    torque_constant: float | None = quantity("N m/A", "N m/A", "shaft torque per ampere", None, gt=0)


class FileSheet(Sheet):
    """The file as a whole."""

    version: float = Field(description="of this format: 1")
    defaults: dict[str, Any] = Field({}, description="fields that every drive below starts from")
    drives: dict[str, dict[str, Any]] = Field(description="one entry for each driven joint, by the joint's name")

"""The drive file's fields on friction."""

from typing import Literal

from pydantic import Field

from cutpoint.formats.drives.sheet import Sheet, quantity
from cutpoint.mechanics.drives.friction import SMOOTHING


class PreslidingSheet(Sheet):
    """Bristles that wind up before friction slides, and hold."""

    law: Literal["elasto_plastic", "lugre"] = Field(
        "elasto_plastic", description="elasto_plastic: holds forever below breakaway; lugre: creeps under vibration"
    )
    distance: float = quantity(
        "rad",
        "m",
        "displacement over which friction would build up from rest to breakaway if nothing slid before",
        gt=0,
    )
    damping: float = quantity("N m s/rad", "N s/m", "of the bristles while they wind up", 0.0, ge=0)
    elastic: float = quantity(
        "1", "1", "share of the breakaway torque that elasto_plastic holds forever", 0.7, ge=0, lt=1
    )


class GreaseSheet(Sheet):
    """How viscous friction follows temperature."""

    temperature: float = quantity("deg C", "deg C", "of the grease; `viscous` is stated at 25")
    thinning: float = quantity("1/K", "1/K", "viscous friction changes by exp(-thinning (temperature - 25))", ge=0)


class FrictionLawSheet(Sheet):
    """Friction on a speed.  Xia (2019) eq. (54); without `static`, Coulomb and viscous only, eq. (55)."""

    coulomb: float = quantity("N m", "N", "dry friction f_c while sliding, as felt at the joint", 0.0, ge=0)
    static: float | None = quantity("N m", "N", "dry friction f_s near standstill, at least f_c", None, ge=0)
    viscous: float = quantity("N m s/rad", "N s/m", "f_v: friction per speed, as felt at the joint", 0.0, ge=0)
    stribeck_velocity: float | None = quantity("rad/s", "m/s", "v_s over which f_s falls to f_c", None, gt=0)
    smoothing: float = quantity("rad/s", "m/s", "sgn(speed) is tanh(speed / smoothing)", SMOOTHING, gt=0)
    asymmetry: float | None = quantity(
        "1", "1", "dry friction is multiplied by 1 + asymmetry forwards, 1 - asymmetry backwards", None, gt=-1, lt=1
    )
    presliding: PreslidingSheet | None = Field(
        None, description="behaviour before sliding; where it is followed, sgn is not smoothed"
    )
    grease: GreaseSheet | None = Field(None, description="how `viscous` varies with temperature")


class MotorFrictionSheet(FrictionLawSheet):
    """Friction on the rotor's speed over ratio, in joint-side units; that of the gear's teeth grows with its load."""

    per_load: float | None = quantity(
        "1",
        "1",
        "dry friction per N m transmitted by the drive: the efficiency lost to load",
        None,
        ge=0,
        lt=1,
    )


class FrictionSheet(Sheet):
    """Friction on either side of the spring."""

    link: FrictionLawSheet | None = Field(None, description="acts on the link's speed, eq. (54)")
    motor: MotorFrictionSheet | None = Field(None, description="acts on the rotor's speed over ratio, eq. (55)")

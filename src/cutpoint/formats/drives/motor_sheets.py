"""The drive file's fields on the motor: rotor, electrics, and what the maker allows."""

from typing import Literal

from pydantic import Field

from cutpoint.formats.drives.sheet import Sheet, WaveSheet, quantity


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


class RippleSheet(WaveSheet):
    """Waves of the torque over the rotor's turn, in proportion to it."""

    amplitude: float = quantity("1", "1", "share of the torque", ge=0, lt=1)


class CoggingSheet(WaveSheet):
    """Waves of torque over the rotor's turn without any current."""

    amplitude: float = quantity("N m", "N m", "at the motor's shaft", ge=0)


class MotorSheet(Sheet):
    """An electric motor with its current control, at its shaft."""

    torque_constant: float = quantity(
        "N m/A", "N m/A", "shaft torque per ampere; K_e in V s/rad is the same number", gt=0
    )
    resistance: float | None = quantity("ohm", "ohm", "winding resistance that goes with torque_constant", None, gt=0)
    bandwidth: float | None = quantity(
        "Hz", "Hz", "of the current loop; without one the torque follows instantly", None, gt=0
    )
    delay: float | None = quantity("s", "s", "from command to current loop, at most a control period", None, ge=0)
    current_limit: float | None = quantity("A", "A", "largest current", None, gt=0)
    voltage_limit: float | None = quantity(
        "V", "V", "supply voltage: it limits torque more, the faster the motor turns", None, gt=0
    )
    ripple: RippleSheet | None = Field(None, description="torque ripple, proportional to the torque")
    cogging: CoggingSheet | None = Field(None, description="torque without current, over a turn of the rotor")


class RatingsSheet(Sheet):
    """What makers allow the gear, at the joint's side but for speeds, and the motor; only sizing reads it."""

    rated_torque: float | None = quantity("N m", "N", "for the stated life at rated speed", None, gt=0)
    average_torque: float | None = quantity("N m", "N", "largest average over a cycle", None, gt=0)
    repeated_peak_torque: float | None = quantity("N m", "N", "largest when starting and stopping", None, gt=0)
    momentary_peak_torque: float | None = quantity("N m", "N", "largest in a collision", None, gt=0)
    rated_speed: float | None = quantity("rad/s", "rad/s", "of the motor, at which `life` is stated", None, gt=0)
    average_speed: float | None = quantity("rad/s", "rad/s", "largest average of the motor's", None, gt=0)
    maximum_speed: float | None = quantity("rad/s", "rad/s", "largest of the motor's", None, gt=0)
    life: float | None = quantity("h", "h", "at rated torque and rated speed", None, gt=0)
    continuous_current: float | None = quantity("A", "A", "largest RMS over a cycle of the motor's", None, gt=0)

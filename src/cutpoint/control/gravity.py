"""Gravity compensation at the measured configuration."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Law
from cutpoint.control.model_law import check_all_driven
from cutpoint.definitions import gravity_forces
from cutpoint.errors import InputError
from cutpoint.robot import Robot


@dataclass(frozen=True)
class GravityCompensation(Law):
    """Torque that holds the links where they are measured to be.  Takegaki and Arimoto (1981); Tomei (1991).

    side: the encoder whose position is taken for the links'; the motor's is off by the deflection, but cannot excite
    the spring.
    """

    robot: Robot
    side: Literal["motor", "link"] = "link"

    def __post_init__(self) -> None:
        if self.side not in ("motor", "link"):
            raise InputError(f"GravityCompensation: side {self.side!r} must be 'motor' or 'link'")
        check_all_driven("GravityCompensation", self.robot)

    @property
    def needs(self) -> tuple[str, ...]:
        """What it must be told by sensors."""
        return ("theta",) if self.side == "motor" else ("q",)

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        q = measurement.q if self.side == "link" else measurement.theta
        return memory, Command(np.array(gravity_forces(self.robot.machine, [*q])))

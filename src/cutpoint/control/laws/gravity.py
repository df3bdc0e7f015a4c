"""Gravity compensation at the measured configuration."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.model_law import ModelLaw
from cutpoint.control.laws.side import Side, SidedLaw
from cutpoint.definitions import gravity_forces


@dataclass(frozen=True, eq=False)
class GravityCompensation(SidedLaw, ModelLaw):
    """Torque that holds the links where they are measured to be.  Takegaki and Arimoto (1981); Tomei (1991).

    side: the encoder whose position is used as the links'; the motor's is off by the deflection, but does not feed
    spring oscillations back.
    """

    side: Side = field(default="link", kw_only=True)

    def __post_init__(self) -> None:
        self.check_side()
        super().__post_init__()

    @property
    def needs(self) -> tuple[str, ...]:
        """Measurement fields that the law reads."""
        return super().needs[:1]

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        q, *_ = self.seen(measurement, reference)
        return memory, Command(np.array(gravity_forces(self.model, [*q])))

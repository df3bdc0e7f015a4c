"""Proportional-derivative control.  Xia (2019) eq. (58), with its side stated."""

from dataclasses import dataclass
from typing import Any

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.side import Side, SidedLaw
from cutpoint.errors import InputError


@dataclass(frozen=True, eq=False)
class PD(SidedLaw):
    """tau_e = K_p (position error) + K_v (speed error), on the motor's or on the link's encoder.  Xia (2019) eq. (58).

    kp in N m/rad and kd in N m s/rad, both at the joint's side, one for each drive.  Side "motor" tracks the motor's
    reference, which a feedforward may shift by the deflection; side "link" tracks the link's.  On an elastic joint the
    latter is non-collocated feedback, with the spring in the loop: only small gains are stable.
    """

    kp: Any
    kd: Any
    side: Side = "motor"

    def __post_init__(self) -> None:
        self._keep_gains("kp", "kd")
        if self.kp.shape != self.kd.shape:
            raise InputError(
                f"PD: kp has shape {self.kp.shape}, but kd {self.kd.shape}; give one of each for every drive"
            )
        self.check_side()

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.kp)

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        x, x_dot, x_d, x_dot_d = self.seen(measurement, reference)
        return memory, Command(self.kp * (x_d - x) + self.kd * (x_dot_d - x_dot))

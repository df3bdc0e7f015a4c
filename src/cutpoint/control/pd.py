"""Proportional-derivative control.  Xia (2019) eq. (58), with its side stated."""

from dataclasses import dataclass
from typing import Any, Literal

from cutpoint.control.gains import gains
from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Law
from cutpoint.errors import InputError


@dataclass(frozen=True, eq=False)
class PD(Law):
    """tau_e = K_p (position error) + K_v (speed error), on the motor's or on the link's encoder.  Xia (2019) eq. (58).

    kp in N m/rad and kd in N m s/rad, both at the joint's side, one for each drive.  Side "motor" tracks the motor's
    reference, which a feedforward may shift by the deflection; side "link" tracks the link's, and on a joint that bends
    it feeds back around the spring: only small gains are stable.
    """

    kp: Any
    kd: Any
    side: Literal["motor", "link"] = "motor"

    def __post_init__(self) -> None:
        object.__setattr__(self, "kp", gains("PD", "kp", self.kp))
        object.__setattr__(self, "kd", gains("PD", "kd", self.kd))
        if self.kp.shape != self.kd.shape:
            raise InputError(f"PD: kp has shape {self.kp.shape}, kd {self.kd.shape}; give one of each for every drive")
        if self.side not in ("motor", "link"):
            raise InputError(f"PD: side {self.side!r} must be 'motor' or 'link'")

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.kp)

    @property
    def needs(self) -> tuple[str, ...]:
        """What it must be told by sensors."""
        return ("theta", "theta_dot") if self.side == "motor" else ("q", "v")

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        m, r = measurement, reference
        if self.side == "motor":
            return memory, Command(self.kp * (r.theta - m.theta) + self.kd * (r.theta_dot - m.theta_dot))
        return memory, Command(self.kp * (r.q - m.q) + self.kd * (r.v - m.v))

"""Proportional-integral-derivative control with anti-windup."""

from dataclasses import dataclass
from typing import Any

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.side import Side, SidedLaw
from cutpoint.scalars import clip, where


@dataclass(frozen=True, eq=False)
class PID(SidedLaw):
    """kp e + ki (integral of e) + kd e', within +-limit, on the motor's or on the link's encoder.

    kp in N m/rad, ki in N m/(rad s), kd in N m s/rad, limit in N m, one for each drive, all at the joint's side.
    The integral stands still while the torque is at its limit and the error would drive it further; Astrom and Hagglund
    (2006) section 3.5, conditional integration.
    """

    kp: Any
    ki: Any
    kd: Any
    limit: Any
    side: Side = "motor"

    def __post_init__(self) -> None:
        self.check_side()
        self._keep_gains("kp")
        self._keep_gains("ki", "kd", "limit", size=self.size, positive=("limit",))

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.kp)

    def start(self) -> Any:
        """The integral's torque, N m."""
        return [0.0] * self.size

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        x, x_dot, x_d, x_dot_d = self.seen(measurement, reference)
        error, rate = x_d - x, x_dot_d - x_dot
        after, torque = [], 0 * error
        for k, integral in enumerate(memory):
            more = self.ki[k] * error[k] * measurement.period
            asked = self.kp[k] * error[k] + self.kd[k] * rate[k] + integral
            torque[k] = clip(asked, -self.limit[k], self.limit[k])
            winds = (asked - torque[k]) * more > 0
            after.append(where(winds, integral, integral + more))
        return after, Command(torque)

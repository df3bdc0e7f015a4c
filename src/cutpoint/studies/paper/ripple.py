"""Torque ripple of motor and gear, as a law that adds to what the motor gives."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control import Command, Measurement, Reference
from cutpoint.control.law import Law
from cutpoint.scalars import sin


@dataclass(frozen=True, eq=False)
class Ripple(Law):
    """tau = sum over k of amplitude_k sin(order_k ratio theta + phase_k), of n drives.

    orders (m,): periods a turn of the rotor.  amplitudes (m, n) in N m at the joint's side; phases (m, n) in rad; ratio
    (n,).  A law sees the rotor through its encoder, so the ripple comes with the encoder's steps and delay: at 7 rad/s
    of the rotor a millisecond shifts an order of 24 by a fortieth of its period.
    """

    orders: Any
    amplitudes: Any
    phases: Any
    ratio: Any

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.ratio)

    def torque(self, theta: Any) -> Any:
        """Of motor positions (..., n) in rad, (..., n) in N m, both at the joint's side."""
        rotor = self.ratio * theta
        parts = [
            amplitude * sin(rotor * order + phase)
            for order, amplitude, phase in zip(self.orders, self.amplitudes, self.phases, strict=True)
        ]
        return sum(parts, np.zeros(self.size))

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        return memory, Command(self.torque(measurement.theta))

"""Computed torque: the rigid robot's inverse dynamics around a linear feedback.  Luh, Walker and Paul (1980)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.rigid_law import RigidLaw
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics


@dataclass(frozen=True, eq=False)
class ComputedTorque(RigidLaw):
    """tau = M(q) (a_d + kd (v_d - v) + kp (q_d - q)) + bias(q, v) + friction(v_d, v).

    kp in 1/s2, kd in 1/s: on a rigid robot each joint's error then obeys e'' + kd e' + kp e = 0.
    """

    kp: Any
    kd: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep_gains("kp", "kd", size=self.size)

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        q, v, q_d, v_d = self.seen(measurement, reference)
        a = reference.a + self.kd * (v_d - v) + self.kp * (q_d - q)
        tau = inverse_dynamics(self.model.system, [*q], [*v], [*a])
        return memory, Command(np.array(tau) + np.array(self.friction(reference.v, v, tau)))

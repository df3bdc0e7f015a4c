"""A sliding-mode law whose torque is continuous.  Levant (1993); Moreno and Osorio (2012).

Of the kind of Xia (2019) reference [11], on the rigid robot.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.rigid_law import RigidLaw
from cutpoint.scalars import absolute, sqrt, where


@dataclass(frozen=True, eq=False)
class SuperTwisting(RigidLaw):
    """tau = M a_r + C v_r + g + friction(v_r, v) + K s + k_1 |s|^(1/2) sgn(s) + w, w' = k_2 sgn(s).

    s = v_r - v, v_r = v_d + Lambda (q_d - q).  position_gain: Lambda, 1/s.  speed_gain: K, N m s/rad.
    root_gain: k_1, N m (s/rad)^(1/2).  twist: k_2, N m/s: bound on the rate of the model's torque error.
    """

    position_gain: Any
    speed_gain: Any
    root_gain: Any
    twist: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep_gains("position_gain", "speed_gain", "root_gain", "twist", size=self.size)

    @property
    def jumps_at_rest(self) -> bool:
        """Not without k_1 and k_2: what is left is linear."""
        return bool(np.any(self.root_gain) or np.any(self.twist))

    def start(self) -> Any:
        """w, N m."""
        return [0.0] * self.size

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        s, tau = self.required_effort(self.position_gain, measurement, reference)
        sign = np.array([where(x < 0, -1.0, where(x > 0, 1.0, 0.0)) for x in s])
        root = np.array([sqrt(absolute(x)) for x in s])
        torque = tau + self.speed_gain * s + self.root_gain * root * sign + np.array(memory)
        return [*(np.array(memory) + measurement.period * self.twist * sign)], Command(torque)

"""Robust control: a nominal model plus a bounded term for its errors.  Corless and Leitmann (1981); Spong (1992).

Of the kind of Xia (2019) reference [7], on the rigid robot.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.rigid_law import RigidLaw
from cutpoint.scalars import absolute


@dataclass(frozen=True, eq=False)
class Robust(RigidLaw):
    """tau = M a_r + C v_r + g + friction(v_r, v) + K s + bound s / (|s| + width).

    s = v_r - v, v_r = v_d + Lambda (q_d - q).  position_gain: Lambda, 1/s.  speed_gain: K, N m s/rad.
    bound: N m, model error per joint.  width: rad/s, boundary layer that smooths the last term to avoid chatter.
    """

    position_gain: Any
    speed_gain: Any
    bound: Any
    width: Any = 0.05

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep_gains("position_gain", "speed_gain", "bound", "width", size=self.size, positive=("width",))

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        s, tau = self.required_effort(self.position_gain, measurement, reference)
        size = np.array([absolute(x) for x in s])
        return memory, Command(tau + self.speed_gain * s + self.bound * s / (size + self.width))

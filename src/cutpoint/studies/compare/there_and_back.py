"""A move and its reverse."""

from dataclasses import dataclass, field

import numpy as np

from cutpoint.arrays import Array
from cutpoint.trajectories import Trajectory


@dataclass(frozen=True, eq=False)
class ThereAndBack(Trajectory):
    """`way`, and the same way back in the same time."""

    duration: float = field(init=False)
    way: Trajectory

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", 2 * self.way.duration)

    @property
    def size(self) -> int:
        return self.way.size

    def _inside(self, t: Array, order: int) -> Array:
        half, back = self.way.duration, t > self.way.duration
        found = self.way.derivatives(np.where(back, 2 * half - t, t), order)
        # time runs backwards: odd derivatives change sign
        found[1::2, back] *= -1
        return found

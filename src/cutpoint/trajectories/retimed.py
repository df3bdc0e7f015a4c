"""A motion in another time."""

from dataclasses import dataclass

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import positive
from cutpoint.trajectories.trajectory import (
    Moves,
    Trajectory,
    check_trajectory,
    derivatives_of,
    names_of,
    size_of,
)


@dataclass(frozen=True, eq=False)
class Retimed(Trajectory):
    """q(t) = motion(t motion.duration / duration)."""

    motion: Moves

    @property
    def size(self) -> int:
        return size_of("retimed", self.motion)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names that the motion has; empty if it has none."""
        return names_of("retimed", self.motion)

    def _inside(self, t: Array, order: int) -> Array:
        speed = np.float64(self.motion.duration) / self.duration
        motion, times = self.motion, np.minimum(t * speed, self.motion.duration)
        # rates of our own may be beyond what machines do until they are slowed down
        is_ours = isinstance(motion, Trajectory)
        found = motion.derivatives(times, order) if is_ours else derivatives_of("retimed", motion, times, order)
        powers = speed ** np.arange(order + 1)  # may be infinite
        return found * powers.reshape(-1, *[1] * t.ndim, 1)


def retimed(trajectory: Moves, duration: float) -> Retimed:
    """The same path in `duration` s, uniformly slower or faster: the k-th derivative grows as 1 / duration^k.

    For first runs of a motion at a share of its speed: `retimed(motion, motion.duration / 0.2)` is at 20 %.

    Raises:
        InputError: no trajectory, or a duration that is not positive.
    """
    check_trajectory("retimed", trajectory)
    positive("retimed", "trajectory.duration", trajectory.duration, "s")
    return Retimed(positive("retimed", "duration", duration, "s"), trajectory)

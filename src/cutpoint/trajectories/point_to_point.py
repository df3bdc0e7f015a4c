"""Motion from one position to another, all joints with the same time profile."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import positive
from cutpoint.errors import InputError, counted
from cutpoint.trajectories.arrays import positions
from cutpoint.trajectories.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class PointToPoint(Trajectory):
    """q(t) = start + (end - start) s(t / duration), with s(0) = 0 and s(1) = 1; start and end (n,) in rad (m)."""

    start: Array
    end: Array

    @classmethod
    def between(cls, start: ArrayLike | None, end: ArrayLike, duration: float) -> Self:
        """A validated one; without a start it starts at zero.

        Raises:
            InputError: a duration that is not positive, or positions that are not finite or do not match.
        """
        last = positions("end", end)
        first = positions("start", np.zeros_like(last) if start is None else start)
        if first.shape != last.shape:
            found = f"start has {counted(first.size, 'joint')} and end has {last.size}"
            raise InputError(f"{found}: the numbers must match")
        return cls(positive(cls.__name__.lower(), "duration", duration, "s"), first, last)

    @property
    def size(self) -> int:
        return self.end.size

    @abstractmethod
    def _profile(self, u: Array, k: int) -> Array:
        """The k-th derivative of s at u, 0 <= u <= 1."""

    def _inside(self, t: Array, order: int) -> Array:
        u = t / self.duration
        duration = np.float64(self.duration)  # its powers may be infinite
        profile = np.stack([self._profile(u, k) / duration**k for k in range(order + 1)])
        found = profile[..., None] * (self.end - self.start)
        found[0] += self.start
        return found

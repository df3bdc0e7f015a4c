"""Excitation as a minimisation problem: from free coordinates of a Fourier series to information and limits."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.excitation.bounds import Bounds
from cutpoint.identification.excitation.information import Criterion, Information, judged
from cutpoint.identification.excitation.limits import Box, limits_of
from cutpoint.identification.excitation.series import FourierSeries, still_waves
from cutpoint.robot import Robot

SAMPLES = 30
"""Samples per shortest wave during the search."""

FINER = 32
"""Limits are checked with this many times as many samples: friction peaks for some milliseconds as a joint reverses."""

RESERVE = 0.005
"""Share of each limit that the search keeps in reserve, since waves may peak between its samples."""


class Worst(NamedTuple):
    """The tightest limit of a motion: room left over the limit's scale; in words, the limit and the value reached."""

    room: float
    words: str


class Problem:
    """Free coordinates z (1 + r, n): each joint's centre, over half its range, and its waves, over its limits."""

    def __init__(
        self,
        robot: Robot,
        bounds: Bounds,
        boxes: Mapping[str, Box],
        criterion: Criterion,
        base_frequency: float,
        harmonics: int,
    ) -> None:
        self.criterion: Criterion = criterion
        self.frequency, self.harmonics = base_frequency, harmonics
        # a motor behind a spring jumps where the jerk does, and its torque where the snap does
        rest = 4 if any(drive.is_elastic for drive in robot.drives.values()) else 2
        self._sine, self._cosine = still_waves(harmonics, rest)
        self._middle, half = (bounds.low + bounds.high) / 2.0, (bounds.high - bounds.low) / 2.0
        slowest = half * 2.0 * np.pi * base_frequency
        reached = bounds._replace(speed=np.minimum(bounds.speed, harmonics * slowest))  # some files state 10,000 rad/s
        self.information, self.limits = Information(robot, reached), limits_of(robot, bounds, boxes)
        waves = np.minimum(bounds.speed, slowest)
        self._scale = np.vstack([half, np.broadcast_to(waves, (self._sine.shape[1], half.size))])
        self._coarse, self._fine = self._basis(SAMPLES), self._basis(FINER * SAMPLES)

    @property
    def shape(self) -> tuple[int, int]:
        """The shape of z."""
        return self._scale.shape

    def series(self, z: Array, duration: float) -> FourierSeries:
        """The trajectory of z, periodic over a duration, s."""
        x = z * self._scale
        sine, cosine = self._sine @ x[1:], self._cosine @ x[1:]
        return FourierSeries(duration, self.frequency, self._middle + x[0], sine, cosine)

    def coordinates(self, series: FourierSeries) -> Array:
        """The z of a trajectory that is at rest at its ends."""
        waves = self._sine.T @ series.sine + self._cosine.T @ series.cosine
        return np.vstack([series.centre - self._middle, waves]) / self._scale

    def barred(self, z: Array, weight: float, softness: float) -> tuple[float, Array]:
        """The cost with relaxed logarithmic barriers at all limits, and its gradient, shaped like z.

        Hauser and Saccon (2006), A barrier function method for the optimization of trajectory functionals with
        constraints, IEEE CDC.
        """
        motion = self.motion(z)
        cost, slope = judged(self.information.regressor(motion), self.criterion)
        barrier, away = self._barrier(motion, softness)
        gradient = self.information.gradient(motion, slope) + weight * away
        return cost + weight * barrier, self._pulled_back(gradient)

    def barrier(self, z: Array, softness: float) -> tuple[float, Array]:
        """The barriers alone, and their gradient, shaped like z."""
        value, gradient = self._barrier(self.motion(z), softness)
        return value, self._pulled_back(gradient)

    def _barrier(self, motion: Array, softness: float) -> tuple[float, Array]:
        """The sum over limits of the mean over samples, and its gradient, shaped like the motion."""
        total, gradient, count = 0.0, np.zeros_like(motion), motion.shape[1]
        for limit in self.limits:
            value, (low, high) = relaxed_barrier(limit.slack(motion) - RESERVE, softness)
            total += float(value.sum()) / count
            gradient += limit.gradient(motion, (low - high) / limit.scale / count)
        return total, gradient

    def _pulled_back(self, gradient: Array) -> Array:
        return np.einsum("kir,kij->rj", self._coarse, gradient) * self._scale

    def cost(self, z: Array) -> float:
        """The cost of the criterion alone."""
        return judged(self.information.regressor(self.motion(z)), self.criterion)[0]

    def untold(self, z: Array) -> tuple[str, ...]:
        """The parameters about which the torques tell next to nothing."""
        return self.information.untold(self.information.regressor(self.motion(z)))

    def motion(self, z: Array, fine: bool = False) -> Array:
        """Position to snap (5, N, n) over one period."""
        found = (self._fine if fine else self._coarse) @ (z * self._scale)
        found[0] += self._middle
        return found

    def worst(self, z: Array) -> Worst:
        """The limit that is closest, or exceeded most, over a finely sampled period."""
        motion = self.motion(z, fine=True)
        rooms = [limit.slack(motion).min(axis=(0, 1)) for limit in self.limits]
        tightest = int(np.argmin([room.min() for room in rooms]))
        limit, column = self.limits[tightest], int(rooms[tightest].argmin())
        x, unit = limit.values(motion)[:, column], limit.units[column]
        what = f"{'frame' if limit.kind == 'place' else 'joint'} {limit.names[column]!r}: {limit.kind}"
        allowed = f"{limit.low[column]:.4g} to {limit.high[column]:.4g} {unit} is allowed"
        words = f"{what} runs from {x.min():.4g} to {x.max():.4g} {unit} where {allowed}"
        return Worst(float(rooms[tightest].min()), words)

    def standing(self, centres: Array) -> Array:
        """(m,): the least room at rest at each of m centres (m, n), scaled as z[0]."""
        motion = np.zeros((5, *centres.shape))
        motion[0] = self._middle + centres * self._scale[0]
        return np.min([limit.slack(motion).min(axis=(0, 2)) for limit in self.limits], axis=0)

    def _basis(self, samples: int) -> Array:
        """(5, N, 1 + r): position to snap of the motions of unit coordinates, unscaled."""
        count = self._sine.shape[1]
        sine, cosine = (np.column_stack([np.zeros(self.harmonics), x]) for x in (self._sine, self._cosine))
        unit = FourierSeries(1.0 / self.frequency, self.frequency, np.eye(1 + count)[0], sine, cosine)
        return unit.derivatives(np.arange(samples * self.harmonics) / (samples * self.harmonics * self.frequency))


def relaxed_barrier(slack: Array, softness: float) -> tuple[Array, Array]:
    """- log(slack) and its slope, continued by a parabola below `softness`; zero where the slack is infinite."""
    bounded = np.isfinite(slack)
    inside, bent = np.where(bounded, np.maximum(slack, softness), 1.0), (slack - 2.0 * softness) / softness
    far = slack >= softness
    value = np.where(far, -np.log(inside), 0.5 * (bent**2 - 1.0) - np.log(softness))
    return value, np.where(bounded, np.where(far, -1.0 / inside, bent / softness), 0.0)

"""A joint's deflection as it was measured, and one law's fit to it with all else that a deflection is made of."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.drives.columns import wave_columns, wave_slopes
from cutpoint.identification.drives.spring_laws import SpringLaw

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Deflections:
    """A joint's measured channels, each (N,), without gaps: theta - q and theta in rad, torque in N m; period, s.

    resolution: rad at the joint's side.  cutoff: Hz, of what the deflection's rate and turning points are read from.
    corrections: (N, m), derivatives of the torque by what is not known of it; shared_noise: (m,), the covariance of
    noise in each with that in the torque, which it makes.  noise: RMS of the lead's own, rad.
    band: Hz, of the filter that all of them went through; None if there was none.
    transmission: (N,), 1 - e'(theta) by which a torque that was read from the motor was divided; None for the link's.
    """

    lead: Array
    theta: Array
    torque: Array
    period: float
    ratio: float
    resolution: float
    cutoff: float
    corrections: Array
    shared_noise: Array
    noise: float = np.inf
    band: float | None = None
    transmission: Array | None = None

    def waves(self, orders: Sequence[int]) -> Array:
        """Sine and cosine (N, 2 k) of the motor's angle, k waves a turn, through the same filter as all else."""
        return self._passed(wave_columns(self.ratio * self.theta, orders))

    def torque_by_waves(self, orders: Sequence[int]) -> tuple[Array, Array]:
        """Derivatives (N, 2 k), N m/rad, of the torque by the waves' weights, and what it has of these already, (N,).

        Of a motor's torque the spring bears 1 / (1 - e'(theta)) times as much: waves wind it too.
        """
        if self.transmission is None:
            return np.zeros((self.theta.size, 2 * len(orders))), np.zeros_like(self.torque)
        by_slope = self.torque / self.transmission
        found = by_slope[:, None] * self.ratio * wave_slopes(self.ratio * self.theta, orders)
        return self._passed(found), self._passed(by_slope * (1.0 - self.transmission))

    def _passed(self, values: Array) -> Array:
        """Through the filter that the channels went through, the ends as they are."""
        return values if self.band is None else self.smooth(values, self.band)

    def smooth(self, values: Array, cutoff: float | None = None) -> Array:
        """Low-passed, by default at `cutoff`, the ends as they are."""
        found = low_pass(values, self.period, self.cutoff if cutoff is None else cutoff)
        return np.where(np.isfinite(found), found, values)

    def rate(self, values: Array) -> Array:
        """By differences of sixth order, central ones times 1 - d^2 / 6 + d^4 / 30, d^2 a second difference: those of
        second order are 6 % short at a tenth of the sampling rate, of fourth 0.5 %."""
        simple = np.gradient(values, self.period)
        bent = _bent(simple)
        return simple - bent / 6.0 + _bent(bent) / 30.0


def _bent(values: Array) -> Array:
    """Second differences (N,), none at the ends."""
    return np.pad(np.diff(values, 2), 1)


@dataclass(frozen=True, eq=False)
class DeflectionFit:
    """A law's constants, weights of waves, offset (rad), corrections, elements' stiffnesses, damping; what is left.

    columns: the model's derivatives (N, p) by all of these, in that order.  residual: (N,), rad.
    tangent: (N,), N m/rad, of the law.
    beside: (N,), rad, what all that acts beside the spring takes from its deflection.
    moving: whether the elements' reaches were sought too; then columns have their derivatives before the elements'.
    """

    law: SpringLaw
    constants: Array
    waves: Array
    offset: float
    corrections: Array
    stiffness: Array
    damping: float
    reaches: Array
    tangent: Array = field(repr=False)
    beside: Array = field(repr=False)
    columns: Array = field(repr=False)
    residual: Array = field(repr=False)
    moving: bool = False

    @property
    def values(self) -> Array:
        """All unknowns (p,), in the columns' order."""
        moving = self.reaches if self.moving else self.reaches[:0]
        parts = [self.constants, self.waves, [self.offset], self.corrections, moving, self.stiffness, [self.damping]]
        return np.concatenate(parts)[: self.columns.shape[1]]

    def moved(self, step: Array, residual: Array) -> "DeflectionFit":
        """With all unknowns a step (p,) on, and what is then left."""
        sizes = [self.constants.size, self.waves.size, 1, self.corrections.size, self.reaches.size * self.moving]
        parts = np.split(self.values + step, np.cumsum([*sizes, self.stiffness.size]))
        constants, waves, offset, corrections, reaches, stiffness, damping = parts
        return replace(
            self,
            constants=constants,
            waves=waves,
            offset=float(offset[0]),
            corrections=corrections,
            reaches=reaches if self.moving else self.reaches,
            stiffness=stiffness,
            damping=float(damping[0]) if damping.size else 0.0,
            residual=residual,
        )

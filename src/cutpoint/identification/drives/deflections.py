"""A joint's measured deflection, and the fit of one spring law and the other components to it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.drives.columns import wave_columns, wave_slopes
from cutpoint.identification.drives.spring_laws import SpringLaw


@dataclass(frozen=True, eq=False)
class TorqueReading:
    """How an imperfectly known torque was obtained: from the motor, for example, or through a filter.

    unknowns: derivatives (N,) of the torque by its unknown corrections, by name; these are estimated.
    shared_noise: covariance of the noise in these derivatives with that in the torque; for an inertia, the
    acceleration's noise is in both.  The resulting bias counts as uncertainty.
    errors: (N, m), N m, possible errors of the torque, one standard deviation each; they count as uncertainty, too.
    transmission: (N,), 1 - e'(theta), by which a motor's torque was divided: the estimated kinematic error then acts
    both on the encoders and on the torque ratio of spring and motor.  None for the link's.
    noise: RMS of the encoders', rad; residuals beyond it are due to the torque.  By default all is the encoders'.
    band: Hz, cut-off of a filter applied to angles and torque; None if there was none.
    angle: (N,), rad, the motor's before that filter, which does not commute with waves of kinematic error; NaN where a
    channel was unknown before the filter.  None for the angle given beside the torque.
    every: which of that angle's samples are those given beside the torque: every one, or every so many.
    """

    unknowns: Mapping[str, Array] = field(default_factory=dict)
    shared_noise: Mapping[str, float] = field(default_factory=dict)
    errors: Array | None = None
    transmission: Array | None = None
    noise: float = np.inf
    band: float | None = None
    angle: Array | None = None
    every: int = 1


@dataclass(frozen=True, eq=False)
class Deflections:
    """A joint's measured channels, each (N,), where all are known: theta - q and theta, rad; torque, N m; period, s.

    resolution: rad at the joint's side.  cutoff: Hz, of the deflection used for its rate and reversals.
    reading: of the torque, with channels like these, except its angle.  among: which samples of that these are.
    """

    lead: Array
    theta: Array
    torque: Array
    period: float
    ratio: float
    resolution: float
    cutoff: float
    reading: TorqueReading
    among: NDArray[np.bool_]

    @property
    def corrections(self) -> Array:
        """(N, m), derivatives of the torque by its unknown corrections."""
        return np.column_stack([np.empty((self.torque.size, 0)), *self.reading.unknowns.values()])

    @property
    def shared_noise(self) -> Array:
        """(m,), the covariance of noise in each of these with that in the torque."""
        return np.array([self.reading.shared_noise.get(name, 0.0) for name in self.reading.unknowns])

    def waves(self, orders: Sequence[int]) -> Array:
        """Sine and cosine (N, 2 k) of k waves per turn of the motor, through the same filter as the channels."""
        before, band, every = self.reading.angle, self.reading.band, self.reading.every
        if before is None or band is None:
            return self._passed(wave_columns(self.ratio * self.theta, orders))
        # filtered with the samples beyond these ends, as the channels were
        return low_pass(wave_columns(self.ratio * before, orders), self.period / every, band)[::every][self.among]

    def torque_by_waves(self, orders: Sequence[int]) -> tuple[Array, Array]:
        """Derivatives (N, 2 k), N m/rad, of the torque by the waves' weights, and their part already in it, (N,).

        The spring bears 1 / (1 - e'(theta)) times a motor's torque: waves wind it too.
        """
        share = self.reading.transmission
        if share is None:
            return np.zeros((self.theta.size, 2 * len(orders))), np.zeros_like(self.torque)
        by_slope = self.torque / share
        found = by_slope[:, None] * self.ratio * wave_slopes(self.ratio * self._angle, orders)
        return self._passed(found), self._passed(by_slope * (1.0 - share))

    @property
    def _angle(self) -> Array:
        """(N,), rad, of the motor, unfiltered if known."""
        before = self.reading.angle
        return self.theta if before is None else before[:: self.reading.every][self.among]

    def _passed(self, values: Array) -> Array:
        """Applies the channels' filter; the ends stay unfiltered."""
        band = self.reading.band
        return values if band is None else self.smooth(values, band)

    def smooth(self, values: Array, cutoff: float | None = None) -> Array:
        """Low-passed, by default at `cutoff`, never across a gap; ends of stretches stay unfiltered."""
        band = self.cutoff if cutoff is None else cutoff
        found = np.concatenate([low_pass(part, self.period, band) for part in self._stretches(values)])
        return np.where(np.isfinite(found), found, values)

    def rate(self, values: Array) -> Array:
        """By sixth-order differences within each stretch, central ones times 1 - d^2 / 6 + d^4 / 30, d^2 a second
        difference: second-order ones are 6 % too small at a tenth of the sampling rate, fourth-order ones 0.5 %."""
        return np.concatenate([_rate(part, self.period) for part in self._stretches(values)])

    def _stretches(self, values: Array) -> list[Array]:
        """Values (N, ...) split where samples are missing between them."""
        return np.split(values, np.flatnonzero(np.diff(np.flatnonzero(self.among)) > 1) + 1)


def _rate(values: Array, period: float) -> Array:
    """Derivative (N,) of samples without gaps, zero of a single one."""
    if values.size < 2:
        return np.zeros_like(values)
    simple = np.gradient(values, period)
    bent = _bent(simple)
    return simple - bent / 6.0 + _bent(bent) / 30.0


def _bent(values: Array) -> Array:
    """Second differences (N,), zero at the ends."""
    return np.pad(np.diff(values, 2), 1)


@dataclass(frozen=True, eq=False)
class DeflectionFit:
    """A law's constants, weights of waves, offset (rad), corrections, elements' stiffnesses, damping; the residual.

    columns: the model's derivatives (N, p) by all of these, in that order.  residual: (N,), rad.
    tangent: (N,), N m/rad, of the law.
    beside: (N,), rad, reduction of the spring's deflection by everything parallel to it.
    moving: whether the elements' reaches were estimated too; then columns have their derivatives before the elements'.
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

    @property
    def places(self) -> dict[str, slice]:
        """Where each component's unknowns are among the columns."""
        sizes = {
            "constants": self.constants.size,
            "waves": self.waves.size,
            "offset": 1,
            "corrections": self.corrections.size,
            "reaches": self.reaches.size * self.moving,
            "elements": self.stiffness.size,
        }
        ends = [*np.cumsum([0, *sizes.values()]).tolist(), None]
        return {name: slice(*own) for name, own in zip([*sizes, "damping"], pairwise(ends), strict=True)}

    @property
    def beside_the_law(self) -> NDArray[np.intp]:
        """Columns of waves, offset and corrections, and of those elements, and of the damping, that are above zero."""
        places, every = self.places, np.arange(self.columns.shape[1])
        free, positive = every[places["waves"].start : places["reaches"].start], every[places["elements"].start :]
        return np.append(free, positive[self.values[positive] > 0.0])

    def moved(self, step: Array, residual: Array) -> "DeflectionFit":
        """The fit with all unknowns changed by a step (p,), and its residual."""
        changed = self.values + step
        found = {name: changed[place] for name, place in self.places.items()}
        return replace(
            self,
            constants=found["constants"],
            waves=found["waves"],
            offset=float(found["offset"][0]),
            corrections=found["corrections"],
            reaches=found["reaches"] if self.moving else self.reaches,
            stiffness=found["elements"],
            damping=float(found["damping"].sum()),
            residual=residual,
        )

"""Encoders on both sides of the drives, with resolution, noise and delay."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import check_choice, number, whole
from cutpoint.errors import InputError
from cutpoint.scalars import Scalar

SAMPLED = ("q", "theta", "v", "theta_dot")
"""The order of a sample: what encoders read, which are positions, comes before speeds."""

_TO_WHOLE = 6755399441055744.0  # 1.5 * 2^52: adding it rounds a double to a whole number, to even

MOST_DELAYED = 1_000_000
"""Numbers on their way, four a drive and control period: every sample moves all of them along."""


@dataclass(frozen=True, eq=False)
class Sensors:
    """Encoders on link and motor.

    link_resolution, motor_resolution: smallest step, rad at the joint's side (a motor encoder's step over ratio).
    link_noise, motor_noise: standard deviation, rad at the joint's side, from a generator with this seed.
    Each is one number for all drives or one for each; None is a perfect encoder.
    delay: s, a whole number of control periods, at most 250,000 over the number of drives.
    speeds: "true", or "differenced" from positions as measured, over one control period.  Readings of
        before the first sample are those of the initial state, true speeds included, without noise; differences of
        them are 0.
    sides: where there are encoders, "both", "motor" or "link"; a controller gets NaN for the other side.
    Numbers are checked where they are used: `simulate` and the like raise InputError.
    """

    link_resolution: ArrayLike | None = None
    motor_resolution: ArrayLike | None = None
    link_noise: ArrayLike | None = None
    motor_noise: ArrayLike | None = None
    delay: float = 0.0
    speeds: Literal["true", "differenced"] = "true"
    seed: int = 0
    sides: Literal["both", "motor", "link"] = "both"


@dataclass(frozen=True)
class Encoders:
    """Sensors of n drives at one control period, checked: arrays of n, or None; the delay in periods."""

    resolution: Any  # link side, then motor side: each an array (n,) or None
    noise: Any
    delay: int
    differenced: bool
    seed: int
    size: int
    sides: str = "both"

    @property
    def normals(self) -> int:
        """How many random numbers a sample takes."""
        return sum(self.size for x in self.noise if x is not None)

    def at_rest(self, sample: Sequence[float]) -> tuple[Array, Array]:
        """Readings on their way, (delay, 4 n), and the last positions, if all of them were of one sample."""
        reading = np.array(replace(self, noise=(None, None)).read(sample, []), float)
        return np.tile(reading, (self.delay, 1)), reading[: 2 * self.size if self.differenced else 0]

    def read(self, sample: Sequence[Scalar], noise: Sequence[Scalar]) -> list[Scalar]:
        """What encoders read of a sample: both are SAMPLED, n each, true speeds included."""
        n, normals = 2 * self.size, iter(noise)
        noises, steps = self._spread(self.noise), self._spread(self.resolution)
        drawn = [0 if x is None else next(normals) for x in noises]
        return self._of_its_sides([*map(_encode, sample[:n], noises, steps, drawn), *sample[n:]])

    def difference(
        self, reading: Sequence[Scalar], before: Sequence[Scalar], period: Scalar
    ) -> tuple[list[Scalar], list[Scalar]]:
        """The reading with speeds from its positions and those before; and its positions, for the next one."""
        positions = [*reading[: 2 * self.size]]
        return [*positions, *((now - then) / period for now, then in zip(positions, before, strict=True))], positions

    def _of_its_sides(self, measured: list[Scalar]) -> list[Scalar]:
        """Sets NaN for the side without encoders; quantities alternate, the link's first."""
        missing = {"both": None, "link": 1, "motor": 0}[self.sides]
        return [math.nan if k // self.size % 2 == missing else x for k, x in enumerate(measured)]

    def _spread(self, both: Any) -> list[Any]:
        """One entry for each of q and theta."""
        return [x for side in both for x in ([None] * self.size if side is None else [*side])]


def encoders_of(sensors: Sensors, size: int, period: float) -> Encoders:
    """The sensors, checked.  Raises InputError for sizes, signs, or a delay that is no whole number of periods."""
    steps = number("sensors", "delay", sensors.delay, "s") / period
    if not (np.isfinite(steps) and steps >= 0 and abs(steps - round(steps)) < 1e-6):
        rule = f"must be a whole number of control periods of {period} s, 0 or more"
        raise InputError(f"sensors: delay {sensors.delay} s {rule}", delay=sensors.delay)
    check_choice("sensors", "speeds", sensors.speeds, ("true", "differenced"))
    check_choice("sensors", "sides", sensors.sides, ("both", "motor", "link"))
    if steps > (most := MOST_DELAYED // (4 * max(size, 1))):
        found = f"delay {sensors.delay:g} s is {steps:.4g} control periods of {period} s"
        rule = f"with {size} drives at most {most} are supported; shorten it (is it in ms?), or lengthen control_period"
        raise InputError(f"sensors: {found}, {rule}", delay=sensors.delay)
    seed = whole("sensors", "seed", sensors.seed, least=0)
    resolution = [one_each(sensors, side + "_resolution", size) for side in ("link", "motor")]
    noise = [one_each(sensors, side + "_noise", size) for side in ("link", "motor")]
    return Encoders(resolution, noise, round(steps), sensors.speeds == "differenced", seed, size, sensors.sides)


def one_each(sensors: Sensors, name: str, size: int) -> Array | None:
    """A number for each of so many drives, or None.  Raises InputError."""
    value = getattr(sensors, name)
    if value is None:
        return None
    try:
        array = np.asarray(value, float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.shape not in ((), (size,)):
        raise InputError(f"sensors: {name} {value} must be one number, or one for each of {size} drives")
    if not np.isfinite(array).all() or (array <= 0).any():
        raise InputError(f"sensors: {name} {value} must be positive; leave it out, or give None, for a perfect encoder")
    if (array > math.tau).any():
        rule = "is more than a turn, in rad at the joint's side (m)"
        remedy = "a 17-bit encoder has steps of 2 pi / 2**17, divided by the ratio for a motor's encoder"
        raise InputError(f"sensors: {name} {value} {rule}; {remedy}")
    return np.broadcast_to(array, size).copy()


def _encode(x: Scalar, noise: Scalar | None, resolution: Scalar | None, normal: Scalar) -> Scalar:
    """A position as an encoder reads it: disturbed, then rounded to its steps."""
    if noise is not None:
        x = x + noise * normal
    if resolution is not None:
        x = ((x / resolution + _TO_WHOLE) - _TO_WHOLE) * resolution
    return x

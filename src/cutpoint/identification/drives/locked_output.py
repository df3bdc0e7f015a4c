"""A drive on a test bench with locked output: loops of torque over the motor's angle."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import channels, positive, turns_per_turn
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.correlated_noise import NORMAL
from cutpoint.identification.drives.scatter import SIGNIFICANT
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.identification.drives.spring_laws import LAWS
from cutpoint.identification.drives.two_encoders import two_encoders

REACHED = 0.9
"""Share of the largest torque in both directions: a sweep must reach it to count, and the curve ends there."""

REVERSAL = 0.05
"""Share of the torque's range: a smaller decrease is noise, not a reversal."""

POINTS = 181
"""Points of the curve, over the torques of both directions."""

INNER = 0.1
"""Share of the largest torque below which play is still being closed."""

NOISES = 4.0
"""Half a window, in which a branch is a line, in standard deviations of the torque's noise: single samples within are
in any order.  A wider one would round the corners of play."""


@dataclass(frozen=True, eq=False)
class LockedOutput:
    """Loops of a drive with locked output; angles in rad at the joint's side.

    torque: (P,), N m.  rising, falling: (P,), the motor's angle at rising and falling torque, less their mean.
    hysteresis_loss: distance of the two branches at zero torque, backlash included.
    lost_motion: travel of the middle curve from -share to +share of the rated torque; None without a rated torque, or
        if no sweep reaches that far.
    backlash: extrapolated to zero torque from where the play is closed; 0 if not significant.
    spring: the law and the hysteresis elements, as from `two_encoders`; meaningless with backlash.
    deviations: standard deviations of hysteresis_loss and lost_motion, rad.
    unidentifiable: what cannot be determined, each with the reason as a sentence.
    """

    torque: Array = field(repr=False)
    rising: Array = field(repr=False)
    falling: Array = field(repr=False)
    hysteresis_loss: float
    lost_motion: float | None
    backlash: float
    spring: SpringEstimate
    deviations: dict[str, float]
    unidentifiable: dict[str, str]

    @property
    def middle(self) -> Array:
        """Middle of the two branches, (P,), rad: the spring without its hysteresis."""
        return 0.5 * (self.rising + self.falling)

    @property
    def stiffness(self) -> Array:
        """Slope of the middle curve, (P,), N m/rad."""
        return 1.0 / np.gradient(self.middle, self.torque)


def locked_output(
    theta: ArrayLike,
    torque: ArrayLike,
    period: float,
    ratio: float,
    *,
    rated_torque: float | None = None,
    share: float = 0.03,
    resolution: float | None = None,
    laws: Sequence[str] = tuple(LAWS),
) -> LockedOutput:
    """Stiffness curve, hysteresis loss, lost motion and backlash from slow loops of torque to both sides.

    theta: the motor's angle over ratio, (N,), rad.  torque: on the locked output, (N,), N m; the motor's times ratio
    works too, but then its friction widens the loop.  NaN: unknown.  period: s.  ratio: motor turns per joint turn.
    share: of the rated torque (N m), between which lost motion is read, 0.03 in makers' catalogues of cycloidal gears.
    resolution: of the encoder, rad at the joint's side; by default its smallest step.  laws: as in `two_encoders`.

    Raises:
        InputError: shapes, no complete sweep in both directions, a rated torque or share that is not positive.
    """
    angle, load = channels("locked_output", theta=theta, torque=torque)
    period, ratio = positive("locked_output", "period", period, "s"), turns_per_turn("locked_output", ratio)
    share = positive("locked_output", "share", share)
    read = None if rated_torque is None else share * positive("locked_output", "rated_torque", rated_torque, "N m")
    spring = two_encoders(
        angle, np.zeros_like(angle), load, period, ratio, resolution=resolution, orders=(), laws=laws, damping=False
    )
    known = np.isfinite(angle) & np.isfinite(load)
    at, rising, falling, variance = _branches(angle[known], load[known])
    middle = 0.5 * (rising + falling)
    play, error = _play(at, middle)
    why = {name: sentence for name, sentence in spring.unidentifiable.items() if name != "kinematic_error"}
    if play < SIGNIFICANT * error:
        why["backlash"] = f"{play:.2g} +- {error:.2g} rad cannot be told from zero"
        play = 0.0
    loss = float(np.interp(0.0, at, falling - rising))
    deviations = {"hysteresis_loss": float(np.sqrt(np.interp(0.0, at, variance)))}
    if loss < SIGNIFICANT * deviations["hysteresis_loss"]:
        why["hysteresis_loss"] = _as_nothing(loss, deviations["hysteresis_loss"])
    lost = None
    if read is not None and read > at[-1]:
        why["lost_motion"] = f"it is read at {read:.3g} N m, but the sweeps end at {at[-1]:.3g} N m; load further"
    elif read is not None:
        lost, deviations["lost_motion"] = _travel(read, at, middle, variance)
        if lost < SIGNIFICANT * deviations["lost_motion"]:
            why["lost_motion"] = _as_nothing(lost, deviations["lost_motion"])
    return LockedOutput(at, rising, falling, loss, lost, play, spring, deviations, why)


def _branches(angle: Array, load: Array) -> tuple[Array, Array, Array, Array]:
    """Torques, the angle there while torque rises and while it falls, less their mean, and the sum of their variances.

    Raises InputError without a complete sweep in both directions.
    """
    limit = REACHED * min(float(load.max()), -float(load.min()))
    if not limit > 0.0:
        found = f"torque runs from {load.min():.3g} to {load.max():.3g} N m"
        raise InputError(f"locked_output: {found}; sweep it up and down on both sides of zero")
    at, softness = np.linspace(-limit, limit, POINTS), float(np.ptp(angle) / np.ptp(load))
    noise = float(np.hypot(_noise(load), _noise(angle) / softness))
    noise = min(noise, INNER * limit / NOISES)
    both = (_mean_way(angle, load, at, noise, softness, direction) for direction in (1.0, -1.0))
    (rising, falling), (up, down) = zip(*both, strict=True)
    mean = 0.5 * (rising + falling).mean()
    return at, rising - mean, falling - mean, up + down


def _travel(read: float, at: Array, middle: Array, variance: Array) -> tuple[float, float]:
    """Travel of the middle curve from -read to read, N m, and its standard deviation; rad."""
    ends = np.interp([-read, read], at, middle)
    return float(ends[1] - ends[0]), 0.5 * float(np.sqrt(np.interp([-read, read], at, variance).sum()))


def _as_nothing(value: float, deviation: float) -> str:
    return f"{value:.2g} +- {deviation:.2g} rad cannot be told from zero: sweep more slowly, or more often"


def _noise(values: Array) -> float:
    """Standard deviation of white noise in samples (N,) of a slow channel."""
    return float(np.median(np.abs(np.diff(values, 2)))) / (NORMAL * np.sqrt(6.0))


def _mean_way(
    angle: Array, load: Array, at: Array, noise: float, softness: float, direction: float
) -> tuple[Array, Array]:
    """The angle at torques `at` while rising (1) or falling (-1), mean of all complete sweeps, and its variance.

    noise: N m, of both channels together.  softness: rad/(N m).
    """
    found: list[tuple[Array, Array]] = []
    for start, end in pairwise(_reversals(load)):
        x, y = direction * load[start : end + 1], angle[start : end + 1]
        if x[0] <= at[0] and x[-1] >= at[-1]:
            values, shares, square = _smooth(x, y, direction * at, NOISES * noise)
            found.append((values, shares * max(square, (softness * noise) ** 2)))
    if not found:
        way = "upward" if direction > 0.0 else "downward"
        raise InputError(f"locked_output: no {way} sweep reaches {at[-1]:.3g} N m on both sides; load further")
    ways, variances = np.array(found).transpose(1, 0, 2)
    apart = float(np.median(ways.var(axis=0, ddof=1))) if len(ways) > 1 else 0.0
    return ways.mean(axis=0), np.maximum(variances.mean(axis=0), apart) / len(ways)


def _smooth(x: Array, y: Array, at: Array, width: float) -> tuple[Array, Array, float]:
    """A sweep's y at some x, (P,), by lines through the samples nearer than a width; and its variance over that of the
    noise, (P,), and the latter."""
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    middle = np.searchsorted(x, at)
    first = np.minimum(np.searchsorted(x, at - width), middle - 1).clip(0)
    last = np.maximum(np.searchsorted(x, at + width, side="right"), middle + 1)
    lines = [_line(x[a:b] - t, y[a:b]) for a, b, t in zip(first, last, at, strict=True)]
    values, shares, squares = np.array(lines).T
    return values, shares, float(np.median(squares))


def _line(x: Array, y: Array) -> tuple[float, float, float]:
    """The value at zero of a line through samples, its variance over that of their noise, and the latter."""
    columns = np.column_stack([np.ones_like(x), x])
    inverse = np.linalg.pinv(columns.T @ columns, hermitian=True)
    weights = inverse @ columns.T @ y
    left = y - columns @ weights
    return float(weights[0]), float(inverse[0, 0]), float(left @ left) / max(x.size - 2, 1)


def _reversals(load: Array) -> list[int]:
    """Samples at which the torque turns, ends included."""
    least = REVERSAL * float(np.ptp(load))
    found, extreme, direction = [0], 0, 0.0
    for k, x in enumerate(load.tolist()):
        ahead = (x - load[extreme]) * (direction or 1.0)
        if ahead > 0.0 or (not direction and abs(ahead) > least):
            direction = direction or (np.sign(ahead) if abs(ahead) > least else 0.0)
            extreme = k if direction else extreme
        elif direction and ahead < -least:
            found.append(extreme)
            extreme, direction = k, -direction
    return [*found, load.size - 1]


def _play(torque: Array, middle: Array) -> tuple[float, float]:
    """The jump of the middle curve at zero torque, rad, fitted with a linear and cubic spring, and its deviation.

    A spring that is soft within the inner tenth of the torque appears as backlash: loops cannot distinguish them.
    """
    used = np.abs(torque) > INNER * torque[-1]
    x, y = torque[used] / torque[-1], middle[used]
    columns = np.column_stack([np.sign(x) / 2.0, x, x**3, np.ones_like(x)])
    weights, *_ = np.linalg.lstsq(columns, y, rcond=None)
    left = y - columns @ weights
    # the curve is smooth: its departures from the cubic are not noise, so the largest counts in full
    error = float(np.abs(left).max()) + float(np.std(left)) / np.sqrt(x.size)
    return float(weights[0]), error

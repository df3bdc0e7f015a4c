"""A drive's rotor inertia, motor friction and torque constant, from the rotor's equation of motion.

torque(t - delay) = J theta_ddot + (1 - e'(theta)) tau_f + xi(theta_dot) - offset, all at the joint's side.
Xia (2019) eqs. (22), (27).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from cutpoint.arrays import Array
from cutpoint.door import channels, checked_numbers, number, positive, turns_per_turn
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.bridging import longest_bridge
from cutpoint.identification.conditioning.correlated_noise import independent
from cutpoint.identification.conditioning.filtering import derivative, low_pass, low_pass_together, noise_cutoff
from cutpoint.identification.drives.bounded import bounded_weights
from cutpoint.identification.drives.scatter import SIGNIFICANT, Unknowns, covariance
from cutpoint.mechanics.drives.friction import Coulomb

UNCERTAIN = 0.1
"""Relative standard deviation above which an estimate counts as unidentifiable."""

TOO_UNCERTAIN = f"is uncertain by more than {UNCERTAIN:.0%}"

UNITS = {
    "inertia": "kg m2 at the joint",
    "coulomb": "N m",
    "viscous": "N m s/rad",
    "gain": "N m/A at the joint",
}
"""Of unknowns that may be too uncertain, for messages."""

SMOOTHEST = 0.3
"""Largest smoothing of dry friction's sign change, as a share of the RMS speed; the smallest is a hundredth of it."""

LEAST_SAMPLES = 200

WIDER, BELOW_HALF = 3.0, 0.45
"""Times the band, and largest share of the sampling rate: positions are differentiated up to there, and filtered once
more with all other terms."""


@dataclass(frozen=True, eq=False)
class RotorEstimate(Unknowns):
    """Estimates from a motor's motion and torque.

    names, values, covariance: of all unknowns at the joint's side, (p,), (p,), (p, p): "inertia" (kg m2), "offset"
    (N m), "viscous" (N m s/rad), "coulomb" (N m), and "gain" (N m/A), "delay" (s) where a current, no delay was given.
    smoothing: rad/s over which dry friction changes sign; its uncertainty is unknown.
    scatter: RMS of the residual, N m.  ratio: motor turns per joint turn.
    """

    smoothing: float
    scatter: float
    ratio: float

    @property
    def inertia(self) -> float:
        """Rotor inertia about its own axis, on the motor's side, kg m2."""
        return self["inertia"] / self.ratio**2

    @property
    def friction(self) -> Coulomb | None:
        """Motor friction at the joint's side; None if not significant."""
        if "motor friction" in self.unidentifiable:
            return None
        return Coulomb(max(self["coulomb"], 0.0), max(self["viscous"], 0.0), self.smoothing)

    @property
    def torque_constant(self) -> float | None:
        """N m of shaft torque per ampere; None if no current was given, or it cannot be determined."""
        told = "gain" in self.names and "torque constant" not in self.unidentifiable
        return self["gain"] / self.ratio if told else None

    @property
    def unidentifiable(self) -> dict[str, str]:
        """What cannot be determined, "rotor inertia", "motor friction" or "torque constant", each with the reason."""
        found: dict[str, str] = {}
        if not self._surpasses("inertia", 1.0 / UNCERTAIN):
            found["rotor inertia"] = vague(self, "inertia")
        if not (self._surpasses("coulomb", SIGNIFICANT) or self._surpasses("viscous", SIGNIFICANT)):
            found["motor friction"] = vague(self, "coulomb")
        if "gain" in self.names and not self._surpasses("gain", 1.0 / UNCERTAIN):
            found["torque constant"] = vague(self, "gain")
        return found

    def possible_errors(self, columns: Mapping[str, Array]) -> Array:
        """(N, m), N m: of a torque with these derivatives (N,) by m of the unknowns, one standard deviation each."""
        names = [name for name in columns if name in self.names]
        among = [self.names.index(name) for name in names]
        # what is not determined at all is a combination of others
        own = independent(self.covariance[np.ix_(among, among)])
        return np.asarray(np.column_stack([columns[name] for name in names]) @ own)

    def _surpasses(self, name: str, times: float) -> bool:
        value = abs(self[name]) if name == "gain" else self[name]
        return value > times * self.deviations[name]


def vague(found: RotorEstimate, name: str) -> str:
    """Why an unknown of `UNITS` cannot be determined."""
    complaint = "cannot be told from zero" if name in ("coulomb", "viscous") else TOO_UNCERTAIN
    figures = f"{found[name]:.3g} +- {found.deviations[name]:.2g} {UNITS[name]}"
    return f"{name} {figures} {complaint}: excite with more acceleration and speed"


def motor_side(
    theta: ArrayLike,
    joint_torque: ArrayLike,
    period: float,
    ratio: float,
    *,
    torque: ArrayLike | None = None,
    current: ArrayLike | None = None,
    transmission: ArrayLike = 1.0,
    cutoff: float | None = None,
    delay: float | None = None,
) -> RotorEstimate:
    """Rotor inertia and motor friction from a torque, or these and the torque constant from a current; all (N,).

    theta: rad.  joint_torque: of the drive on the link, N m, found independently of the motor.
    torque: the motor's times ratio, N m; or current, A.  transmission: 1 - e'(theta), if it is known.
    period: s.  ratio: motor turns per joint turn.  cutoff: Hz, of the low-pass for all terms; by default where the
    joint torque falls below its noise.  delay: s by which the motor's torque acts later than its time stamp, half a
    period for held commands; by default it is estimated too.

    Raises:
        InputError: neither or both of torque and current, shapes, too few samples, a motor that stands still.
    """
    effort = torque if current is None else current
    if effort is None or (torque is not None and current is not None):
        raise InputError("motor_side: give either torque or current")
    period, ratio = positive("motor_side", "period", period, "s"), turns_per_turn("motor_side", ratio)
    angle, load, drive = channels("motor_side", theta=theta, joint_torque=joint_torque, effort=effort)
    if not np.nanmax(angle) > np.nanmin(angle):
        raise InputError("motor_side: theta never changes: was it measured?")
    band = noise_cutoff(load, period) if cutoff is None else positive("motor_side", "cutoff", cutoff, "Hz")
    speed = derivative(low_pass(angle, period, min(WIDER * band, BELOW_HALF / period)), period)
    # the unknowns' columns, (N,)
    fixed = {"inertia": -derivative(angle, period, 2), "offset": np.ones_like(angle)}
    if delay is not None:
        drive = late(drive, period, number("motor_side", "delay", delay, "s"))
    borne = checked_numbers("motor_side", "transmission", transmission) * load
    if current is None:
        known = borne
    else:  # the noise is the current's: all else is estimated over the gain, and the gain as its reciprocal
        known, fixed["gain"] = np.zeros_like(load), -borne
    passed = np.column_stack(low_pass_together([*fixed.values(), -speed, known - drive], period, band))
    if np.isfinite(passed).all(axis=1).sum() < LEAST_SAMPLES:
        raise InputError(f"motor_side: a filter of {band:.3g} Hz leaves fewer than {LEAST_SAMPLES} samples")
    sign = _sign(passed, len(fixed) - 1) if "gain" in fixed else 1.0
    passed[:, -1] *= sign  # a current of opposite sign
    if delay is None:
        passed = _with_delay(passed, low_pass(known, period, band), len(fixed), speed, period, band)
    free = (*fixed, "delay") if delay is None else (*fixed,)
    return _estimate(free, passed, sign, speed, period, band, ratio)


def _with_delay(passed: Array, known: Array, free: int, speed: Array, period: float, band: float) -> Array:
    """The columns with that of a delay behind the `free` ones: the rate of the torque that all others explain.

    The rate of the recorded torque has its noise, which would make delays too small.  known: of the target, (N,).
    """
    smoothing = _best_smoothing(speed, passed, free, period, band)
    _, weights, _ = _fit(smoothing, speed, passed, free, period, band)
    explained = np.column_stack([passed[:, :-1], _dry(smoothing, speed, period, band)]) @ weights
    return np.insert(passed, free, np.gradient(explained - known, period), axis=1)


def _estimate(
    free: tuple[str, ...], passed: Array, sign: float, speed: Array, period: float, band: float, ratio: float
) -> RotorEstimate:
    """The unknowns that fit best.

    passed: columns (N, ...), filtered, of the unknowns of either sign, named `free`, then that of viscous friction, and
    the target; with a gain, the target is the current, times its sign.
    """
    smoothing = _best_smoothing(speed, passed, len(free), period, band)
    columns, weights, residual = _fit(smoothing, speed, passed, len(free), period, band)
    spread, scatter = covariance(columns, residual), float(np.sqrt(np.mean(residual**2)))
    names = (*free, "viscous", "coulomb")
    if "gain" in free:
        weights, spread = _by_gain(names, weights, spread, sign)
        scatter *= abs(float(weights[names.index("gain")]))
    return RotorEstimate(names, weights, spread, smoothing, scatter, ratio)


def _sign(passed: Array, column: int) -> float:
    """Sign of the gain, by least squares: friction dissipates energy only with the right one."""
    known = passed[np.isfinite(passed).all(axis=1)]
    return -1.0 if np.linalg.lstsq(known[:, :-1], known[:, -1], rcond=None)[0][column] < 0.0 else 1.0


def _by_gain(names: tuple[str, ...], weights: Array, spread: Array, sign: float) -> tuple[Array, Array]:
    """Values and covariance, to first order, of unknowns that were estimated over the gain's size; the delay is
    unscaled, and the gain was estimated as its reciprocal."""
    k = names.index("gain")
    # estimates below their own deviation are not significant
    least = float(np.sqrt(spread[k, k])) if np.isfinite(spread[k, k]) else 0.0
    gain = 1.0 / max(float(weights[k]), least, np.finfo(float).eps)
    scaled = np.array([name not in ("gain", "delay") for name in names])
    values = np.where(scaled, gain * weights, weights)
    slopes = np.diag(np.where(scaled, gain, 1.0))
    slopes[:, k] -= np.where(scaled, gain * values, 0.0)
    values[k], slopes[k, k] = sign * gain, -sign * gain**2
    unseen = np.isinf(np.diag(spread)) | (np.isinf(spread[k, k]) & scaled)
    found = slopes @ np.where(np.isfinite(spread), spread, 0.0) @ slopes.T
    found[unseen, unseen] = np.inf
    return values, found


def _fit(
    smoothing: float, speed: Array, passed: Array, free: int, period: float, band: float
) -> tuple[Array, Array, Array]:
    """Columns, weights and residual, with dry friction that changes sign over a smoothing, rad/s.

    passed: the columns without it, the first `free` of either sign, and the target last.
    """
    columns = np.column_stack([passed[:, :-1], _dry(smoothing, speed, period, band)])
    known = np.isfinite(columns).all(axis=1) & np.isfinite(passed[:, -1])
    weights = bounded_weights(columns[known], passed[known, -1], free)
    return columns[known], weights, passed[known, -1] - columns[known] @ weights


def _dry(smoothing: float, speed: Array, period: float, band: float) -> Array:
    """The column of dry friction."""
    return np.asarray(low_pass(-np.tanh(speed / smoothing), period, band))


def _best_smoothing(speed: Array, passed: Array, free: int, period: float, band: float) -> float:
    largest = SMOOTHEST * float(np.sqrt(np.nanmean(speed**2)))

    def error(logarithm: float) -> float:
        return float(np.sum(_fit(float(np.exp(logarithm)), speed, passed, free, period, band)[2] ** 2))

    bounds = (np.log(0.01 * largest), np.log(largest))
    best: Any = minimize_scalar(error, bounds=bounds, method="bounded", options={"xatol": 0.05})
    return float(np.exp(best.x))


def late(values: Array, period: float, delay: float) -> Array:
    """A channel (N,) that acts later than its stamps, at the times at which it acts: linear between samples, NaN in
    gaps that are too long to bridge."""
    time, known = period * np.arange(values.size), np.isfinite(values)
    if not known.any():
        return values
    at, stamps = time - delay, time[known]
    after = np.searchsorted(stamps, at)
    before, after = (stamps[k.clip(0, stamps.size - 1)] for k in (after - 1, after))
    # at the ends, the nearest sample is held for as long
    is_gap = np.maximum(after, at) - np.minimum(before, at) > longest_bridge(period)
    return np.where(is_gap, np.nan, np.interp(at, stamps, values[known]))

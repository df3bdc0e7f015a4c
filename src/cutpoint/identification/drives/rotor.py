"""A drive's rotor inertia, motor friction and torque constant from what its motor does: the equation of the rotor.

torque(t - delay) = J theta_ddot + (1 - e'(theta)) tau_f + xi(theta_dot) - offset, all at the joint's side.
Xia (2019) eqs. (22), (27).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from cutpoint.errors import InputError
from cutpoint.identification.drives.bounded import bounded_weights
from cutpoint.identification.drives.scatter import covariance
from cutpoint.identification.filtering import derivative, low_pass, noise_cutoff
from cutpoint.mechanics.friction import Coulomb

Array = NDArray[np.float64]

SIGNIFICANT = 4.0
"""Standard deviations above which friction is told from none."""

UNCERTAIN = 0.1
"""Of an estimate: with a standard deviation above that it counts as unidentifiable."""

SMOOTHEST = 0.3
"""Of the RMS speed: dry friction changes sign over that at most, and over a hundredth of it at least."""

LEAST_SAMPLES = 200


@dataclass(frozen=True, eq=False)
class RotorEstimate:
    """What a motor's motion and torque tell; None where it was not sought or cannot be told.

    inertia: of the rotor about its own axis, on the motor's side, kg m2.  friction: at the joint's side.
    torque_constant: N m of shaft torque per ampere.  delay: s by which the torque acts later than it is stamped: half
    a period for commands that are held.  offset: N m that the motor is helped by.
    names, values, covariance: of all unknowns at the joint's side, (p,), (p,), (p, p); "smoothing" is not among them.
    scatter: RMS of what is left, N m.  unidentifiable: what cannot be told, each with the sentence why.
    """

    inertia: float
    friction: Coulomb | None
    torque_constant: float | None
    delay: float
    offset: float
    names: tuple[str, ...]
    values: Array
    covariance: Array = field(repr=False)
    scatter: float
    unidentifiable: Mapping[str, str]

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each unknown, by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))


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
) -> RotorEstimate:
    """Rotor inertia and motor friction from a torque, or these and the torque constant from a current; all (N,).

    theta: rad.  joint_torque: what the drive exerts on the link, N m, found otherwise than from the motor.
    torque: the motor's times ratio, N m; or current, A.  transmission: 1 - e'(theta), if it is known.
    period: s.  ratio: motor turns per joint turn.  cutoff: Hz, of the low-pass through which all terms go; by default
    where the joint torque sinks into its noise.

    Raises:
        InputError: neither or both of torque and current, shapes, too few samples.
    """
    if (torque is None) == (current is None):
        raise InputError("motor_side: give either torque or current")
    drive = np.asarray(torque if current is None else current, dtype=np.float64)
    angle, load = np.asarray(theta, dtype=np.float64), np.asarray(joint_torque, dtype=np.float64)
    if not angle.shape == load.shape == drive.shape or angle.ndim != 1:
        shapes = f"{angle.shape}, {load.shape} and {drive.shape}"
        raise InputError(f"motor_side: theta, joint_torque and torque or current have shapes {shapes}: each must be (N,)")
    band = noise_cutoff(load, period) if cutoff is None else cutoff
    speed = derivative(low_pass(angle, period, min(3.0 * band, 0.45 / period)), period)
    rate = np.gradient(drive, period)
    fixed = [-derivative(angle, period, 2), np.ones_like(angle), -rate]
    names = ["inertia", "offset", "delay"]
    if current is not None:
        fixed, names = [*fixed, drive], [*names, "gain"]
    target = np.asarray(transmission, dtype=np.float64) * load - (drive if current is None else 0.0)
    passed = low_pass(np.column_stack([*fixed, -speed, target]), period, band)
    if np.isfinite(passed).all(axis=1).sum() < LEAST_SAMPLES:
        raise InputError(f"motor_side: less than {LEAST_SAMPLES} samples are left by a filter of {band:.3g} Hz")

    def fit(smoothing: float) -> tuple[Array, Array, Array]:
        dry = low_pass(-np.tanh(speed / smoothing), period, band)
        columns = np.column_stack([passed[:, :-1], dry])
        known = np.isfinite(columns).all(axis=1) & np.isfinite(passed[:, -1])
        weights = bounded_weights(columns[known], passed[known, -1], len(fixed))
        return columns[known], weights, passed[known, -1] - columns[known] @ weights

    moving = float(np.sqrt(np.nanmean(speed**2)))
    limits = (np.log(0.01 * SMOOTHEST * moving), np.log(SMOOTHEST * moving))
    best = minimize_scalar(lambda x: float(np.sum(fit(np.exp(x))[2] ** 2)), bounds=limits, method="bounded",
                           options={"xatol": 0.05})  # fmt: skip
    smoothing = float(np.exp(best.x))
    return _estimate(*fit(smoothing), [*names, "viscous", "coulomb"], smoothing, ratio)


def _estimate(
    columns: Array, weights: Array, residual: Array, names: list[str], smoothing: float, ratio: float
) -> RotorEstimate:
    spread = covariance(columns, residual)
    value = dict(zip(names, weights.tolist(), strict=True))
    error = dict(zip(names, np.sqrt(np.diag(spread)).tolist(), strict=True))
    why: dict[str, str] = {}
    if not value["inertia"] > error["inertia"] / UNCERTAIN:
        why["rotor inertia"] = _vague("the rotor's inertia at the joint", value["inertia"], error["inertia"], "kg m2")
    friction = None
    if any(value[name] > SIGNIFICANT * error[name] for name in ("coulomb", "viscous")):
        friction = Coulomb(value["coulomb"], value["viscous"], smoothing)
    else:
        why["motor friction"] = _vague("dry motor friction", value["coulomb"], error["coulomb"], "N m")
    constant = value["gain"] / ratio if "gain" in value else None
    if constant is not None and not abs(value["gain"]) > error["gain"] / UNCERTAIN:
        why["torque constant"] = _vague("the torque constant times ratio", value["gain"], error["gain"], "N m/A")
        constant = None
    delay = value["delay"] / value.get("gain", 1.0)
    return RotorEstimate(
        value["inertia"] / ratio**2,
        friction,
        constant,
        delay,
        value["offset"],
        tuple(names),
        weights,
        spread,
        float(np.sqrt(np.mean(residual**2))),
        why,
    )


def _vague(thing: str, value: float, error: float, unit: str) -> str:
    return f"{thing}, {value:.3g} +- {error:.2g} {unit}, is not told from none: excite with more acceleration or speed"

"""Drive torques on links, found in three ways: from the links' motion, from encoders, from the motors."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import derivative, low_pass
from cutpoint.identification.drives.rotor import SMOOTHEST, RotorEstimate, late
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.mechanics.drives.friction import Coulomb
from cutpoint.mechanics.drives.presliding import sliding_of
from cutpoint.model.drive import Drive, Friction
from cutpoint.robot import Robot

AVERAGED, CENTRAL = (-1 / 12, 1 / 90, -1 / 560), (-1 / 6, 1 / 30, -1 / 140)
"""Coefficients of differences of second, fourth and sixth order that correct averages with triangular weights, and
central differences.  From the series of (2 arsinh(d / 2))^2 and of its root over (1 + d^2 / 4)^(1/2)."""


def link_torque(robot: Robot, q: Array, period: float, cutoff: float) -> tuple[Array, Array, Array]:
    """From the links' motion q (N, n), rad: inverse dynamics and link friction, (N, n) each, N m; and directions of
    motion and speeds (N, n, 2), the columns of any further link friction; NaN at the ends.

    Friction is as in steady sliding.  cutoff: Hz, of the low-pass before differentiation.
    """
    smooth = low_pass(q, period, cutoff)
    v, a = derivative(smooth, period), derivative(smooth, period, 2)
    known = np.isfinite(a).all(axis=1)
    found, friction = np.full_like(q, np.nan), np.full_like(q, np.nan)
    found[known] = robot.inverse_dynamics(smooth[known], v[known], a[known])
    friction[known] = robot.friction_torques(v[known])
    widest = SMOOTHEST * np.sqrt(np.nanmean(v**2, axis=0))
    smoothings = [
        smoothing_of(drive, width) for drive, width in zip(robot.drives.values(), widest.tolist(), strict=True)
    ]
    return found, friction, np.stack([np.tanh(v / smoothings), v], axis=2)


def beyond_coulomb(law: Friction | None, speed: Array, load: Array) -> Array:
    """(N,) N m: friction of one side in excess of Coulomb's, by its known law.

    speed: (N,), rad/s.  load: (N,), N m, transmitted by the drive.
    """
    known: Any = sliding_of(law)
    if known is None:
        return np.zeros_like(speed)
    plain = Coulomb(known.coulomb, known.viscous, known.smoothing, grease=known.grease)
    return np.asarray(known.torque(speed, load) - plain.torque(speed))


def smoothing_of(drive: Drive, otherwise: float) -> float:
    """rad/s over which friction changes sign, as the drive states it on either side."""
    stated = sliding_of(drive.link_friction or drive.motor_friction)
    return float(stated.smoothing) if stated else max(otherwise, np.finfo(float).tiny)


def torque_left(
    rotor: RotorEstimate,
    theta: Array,
    torque: Array,
    period: float,
    delay: float,
    transmission: Array,
) -> tuple[Array, dict[str, Array]]:
    """The motor's torque (N,), N m, less that of its rotor and friction, (N,), NaN at the ends; and its derivatives by
    inertia and friction of the estimate, which `corrected` takes.

    theta: (N,), rad.  period, delay: s.  transmission: (N,), 1 - e'(theta).
    """
    # differences of samples average what acts between them, held torque too; springs act at the samples
    part = delay / period % 1.0
    acceleration = sharpened(derivative(theta, period, 2))
    acting = sharpened(late(torque, period, delay), 4.0 * part * (1.0 - part))
    speed = sharpened(derivative(theta, period), 1.0, CENTRAL)
    direction = np.tanh(speed / rotor.smoothing)
    by = {
        "inertia": -acceleration / transmission,
        "viscous": -speed / transmission,
        "coulomb": -direction / transmission,
    }
    left = (acting + rotor["offset"]) / transmission
    for name, column in by.items():
        left = left + rotor[name] * column
    # the law of dry friction is linear in its smoothing only locally
    by["smoothing"] = rotor["coulomb"] * (1.0 - direction**2) * speed / rotor.smoothing**2 / transmission
    return left, by


def sharpened(values: Array, share: float = 1.0, weights: Sequence[float] = AVERAGED) -> Array:
    """Values (N,) at samples from their averages over a period on either side, with triangular weights.

    share: how much of the values is such an average: 1 for a held torque that is half a period late, 0 for a measured
    one.
    """
    found, bent = values.copy(), values
    for weight in weights:
        bent = derivative(bent, 1.0, 2)
        found += share * weight * bent
    return found


def corrected(rotor: RotorEstimate, spring: SpringEstimate) -> RotorEstimate:
    """A rotor with the corrections found from its spring's deflection: see `torque_left`."""
    names = ("inertia", "viscous", "coulomb")
    own, theirs = ([each.names.index(name) for name in names] for each in (rotor, spring))
    values, spread = rotor.values.copy(), rotor.covariance.copy()
    values[own] += spring.values[theirs]
    spread[own, :] = spread[:, own] = 0.0
    spread[np.ix_(own, own)] = spring.covariance[np.ix_(theirs, theirs)]
    smoothing = rotor.smoothing + spring["smoothing"]
    smoothing = min(max(smoothing, 0.5 * rotor.smoothing), 2.0 * rotor.smoothing)
    return replace(rotor, values=values, covariance=spread, smoothing=smoothing)


def transmitted_share(spring: SpringEstimate, theta: Array, ratio: float) -> Array:
    """1 - e'(theta), (N,): the share of the spring's torque that acts on the motor."""
    if spring.kinematic_error is None:
        return np.ones_like(theta)
    return 1.0 - np.asarray(spring.kinematic_error.slope(theta, ratio))

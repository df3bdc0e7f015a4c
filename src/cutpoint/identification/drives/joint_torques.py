"""What drives exert on their links, found in three ways: from the links' motion, from encoders, from the motors."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.identification.conditioning.filtering import derivative, low_pass, noise_cutoff
from cutpoint.identification.drives.rotor import RotorEstimate, late
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.robot import Robot

Array = NDArray[np.float64]


def link_torque(robot: Robot, q: Array, period: float, cutoff: float | None = None) -> Array:
    """From the links' motion q (N, n), rad: inverse dynamics and link friction, (N, n), N m; NaN at the ends.

    Friction is as in steady sliding.  cutoff: Hz, of the low-pass before differentiation; by default where the
    positions sink into their noise.
    """
    smooth = low_pass(q, period, noise_cutoff(q, period) if cutoff is None else cutoff)
    v, a = derivative(smooth, period), derivative(smooth, period, 2)
    known = np.isfinite(a).all(axis=1)
    found = np.full_like(q, np.nan)
    found[known] = robot.inverse_dynamics(smooth[known], v[known], a[known]) + robot.friction_torques(v[known])
    return found


def torque_left(
    rotor: RotorEstimate,
    theta: ArrayLike,
    torque: ArrayLike,
    period: float,
    delay: float,
    transmission: ArrayLike = 1.0,
) -> tuple[Array, dict[str, Array]]:
    """From the motor's torque (N,), N m: what is left beside its rotor and its friction, (N,), NaN at the ends; and its
    derivatives by inertia and friction of the estimate, which `corrected` takes.

    theta: (N,), rad.  period, delay: s.  transmission: 1 - e'(theta).
    """
    angle, given = np.asarray(theta, dtype=np.float64), np.asarray(torque, dtype=np.float64)
    share = np.asarray(transmission, dtype=np.float64)
    # differences of samples average what acts between them, torque that is held too; springs act at the samples
    part = delay / period % 1.0
    acceleration = sharpened(derivative(angle, period, 2))
    acting = sharpened(late(given, period, delay), 4.0 * part * (1.0 - part))
    speed = derivative(angle, period)
    by = {
        "inertia": -acceleration / share,
        "viscous": -speed / share,
        "coulomb": -np.tanh(speed / rotor.smoothing) / share,
    }
    left = (acting + rotor["offset"]) / share
    for name, column in by.items():
        left = left + rotor[name] * column
    # dry friction's own law is linear in its smoothing only nearby
    direction = np.tanh(speed / rotor.smoothing)
    by["smoothing"] = rotor["coulomb"] * (1.0 - direction**2) * speed / rotor.smoothing**2 / share
    return left, by


def sharpened(values: Array, share: float = 1.0) -> Array:
    """Values (N,) at samples from their averages over a period on either side, with triangular weights.

    share: of them that is an average; of a torque that is held all, half a period late, of one that was measured none.
    """
    found = values.copy()
    found[1:-1] -= share * (values[2:] - 2.0 * values[1:-1] + values[:-2]) / 12.0
    return found


def corrected(rotor: RotorEstimate, spring: SpringEstimate) -> RotorEstimate:
    """A rotor with the corrections that its spring's deflection found: see `torque_left`."""
    names = ("inertia", "viscous", "coulomb")
    own, theirs = ([each.names.index(name) for name in names] for each in (rotor, spring))
    values, spread = rotor.values.copy(), rotor.covariance.copy()
    values[own] += spring.values[theirs]
    spread[own, :] = spread[:, own] = 0.0
    spread[np.ix_(own, own)] = spring.covariance[np.ix_(theirs, theirs)]
    smoothing = rotor.smoothing + float(spring.values[spring.names.index("smoothing")])
    smoothing = min(max(smoothing, 0.5 * rotor.smoothing), 2.0 * rotor.smoothing)
    return replace(rotor, values=values, covariance=spread, smoothing=smoothing)


def transmitted_share(spring: SpringEstimate | None, theta: Array, ratio: float) -> Array:
    """1 - e'(theta), (N,): what of the spring's torque the motor bears."""
    if spring is None or spring.kinematic_error is None:
        return np.ones_like(theta)
    return 1.0 - np.asarray(spring.kinematic_error.slope(theta, ratio))

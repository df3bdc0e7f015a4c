"""What drives exert on their links, found in three ways: from the links' motion, from encoders, from the motors."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.identification.drives.columns import strain_columns
from cutpoint.identification.drives.rotor import RotorEstimate
from cutpoint.identification.drives.two_encoders import SpringEstimate
from cutpoint.identification.filtering import derivative, low_pass, noise_cutoff
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


def spring_reading(spring: SpringEstimate, theta: ArrayLike, q: ArrayLike, period: float, ratio: float) -> Array:
    """From both encoders of one joint, (N,), rad, and what was found of its spring: (N,), N m."""
    angle, link = np.asarray(theta, dtype=np.float64), np.asarray(q, dtype=np.float64)
    wound = angle - link - spring.offset
    if spring.kinematic_error is not None:
        wound = wound - spring.kinematic_error.value(angle, ratio)
    found = np.asarray(spring.compliance.torque(wound))
    if spring.hysteresis is not None:
        strains = strain_columns(wound, np.array(spring.hysteresis.reach))
        found = found + strains @ np.array(spring.hysteresis.stiffness)
    return found if spring.damping is None else found + spring.damping * np.gradient(wound, period)


def motor_torque_left(
    rotor: RotorEstimate, theta: ArrayLike, torque: ArrayLike, period: float, ratio: float, transmission: ArrayLike = 1.0
) -> Array:
    """From the motor's torque (N,), N m: what is left beside its rotor and its friction, (N,); NaN at the ends."""
    angle, given = np.asarray(theta, dtype=np.float64), np.asarray(torque, dtype=np.float64)
    time = period * np.arange(angle.size)
    known = np.isfinite(given)
    acting = np.interp(time - rotor.delay, time[known], given[known])
    left = acting + rotor.offset - rotor.inertia * ratio**2 * derivative(angle, period, 2)
    if rotor.friction is not None:
        left = left - np.asarray(rotor.friction.torque(derivative(angle, period)))
    return left / np.asarray(transmission, dtype=np.float64)


def transmitted_share(spring: SpringEstimate | None, theta: Array, ratio: float) -> Array:
    """1 - e'(theta), (N,): what of the spring's torque the motor bears."""
    if spring is None or spring.kinematic_error is None:
        return np.ones_like(theta)
    return 1.0 - np.asarray(spring.kinematic_error.slope(theta, ratio))

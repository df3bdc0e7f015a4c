"""The motor between command and shaft: limits, current loop, torque ripple and cogging.

Torques at the joint's side, ratio times the shaft's; rotor angle ratio * theta.
"""

import math
from collections.abc import Sequence

from cutpoint.mechanics.drives.harmonics import series
from cutpoint.model.drive import Drive, Harmonic, Motor
from cutpoint.scalars import Scalar, clip


def within_limits(drive: Drive, command: Scalar, theta_dot: Scalar) -> Scalar:
    """The torque that current and voltage allow at a speed, N m: the torque-speed curve.

    Back-EMF takes K_e ratio theta_dot of the voltage, K_e = torque_constant in SI units; what is left drives
    the current through the resistance.
    """
    motor = drive.motor
    if motor is None or (motor.current_limit is None and motor.voltage_limit is None):
        return command
    gain = motor.torque_constant * drive.ratio  # N m at the joint per ampere
    current = command / gain
    if motor.voltage_limit is not None:
        assert motor.resistance is not None, "a voltage limit needs the resistance"
        most, back = motor.voltage_limit, gain * theta_dot
        current = clip(current, (-most - back) / motor.resistance, (most - back) / motor.resistance)
    if motor.current_limit is not None:
        current = clip(current, -motor.current_limit, motor.current_limit)
    return gain * current


def lag_rate(motor: Motor, command: Scalar, torque: Scalar) -> Scalar:
    """d torque / dt of a current loop of first order, N m/s."""
    assert motor.bandwidth is not None, "a motor without bandwidth follows at once"
    return (math.tau * motor.bandwidth) * (command - torque)


def shaft_torque(drive: Drive, torque: Scalar, theta: Scalar) -> Scalar:
    """Torque on the rotor from an electromagnetic torque, N m, with ripple and cogging."""
    ripple, cogging = ripple_and_cogging(drive, theta)
    return torque * (1 + ripple) + cogging


def torque_for(drive: Drive, shaft: Scalar, theta: Scalar) -> Scalar:
    """Electromagnetic torque for a torque on the rotor, N m: the inverse of `shaft_torque`."""
    ripple, cogging = ripple_and_cogging(drive, theta)
    return (shaft - cogging) / (1 + ripple)


def ripple_and_cogging(drive: Drive, theta: Scalar) -> tuple[Scalar, Scalar]:
    """Ripple as a share of the torque, and cogging in N m."""
    motor = drive.motor
    if motor is None:
        return 0, 0
    angle = drive.ratio * theta
    return _waves(motor.ripple, angle), drive.ratio * _waves(motor.cogging, angle)


def _waves(harmonics: Sequence[Harmonic], angle: Scalar) -> Scalar:
    return series(harmonics, angle) if harmonics else 0

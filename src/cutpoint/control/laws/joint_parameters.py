"""Parameters that a joint subsystem learns: friction, rotor inertia and spring compliance.

A drive's parameters, those that it has, in this order: coefficients of the link's friction, reflected inertia (kg m2),
compliance of a linear spring (rad/(N m)), coefficients of the motor's friction.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple, cast

from cutpoint.control.laws.adaptation import projected
from cutpoint.mechanics.drives.compliance import LinearSpring
from cutpoint.mechanics.drives.harmonic_drive import DriveState
from cutpoint.mechanics.drives.presliding import Presliding, sliding_of
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar

Scalars = list[Scalar]


class JointPower(NamedTuple):
    """Inputs of a joint's parameter update: its state, and the required motions of its link and motor."""

    at: DriveState
    speed: Any
    acceleration: Any
    torque: Any
    motor_speed: Any
    motor_acceleration: Any


def nominal(drive: Drive) -> Scalars:
    """The model's values of the parameters."""
    numbers = _coefficients(drive.link_friction)
    if drive.rotor is not None:
        numbers.append(drive.reflected_inertia)
    if isinstance(drive.compliance, LinearSpring):
        numbers.append(1 / drive.compliance.stiffness)
    return numbers + _coefficients(drive.motor_friction)


def with_numbers(drive: Drive, numbers: Scalars) -> Drive:
    """The drive with estimated parameters."""
    rest = iter(numbers)
    drive = replace(drive, link_friction=_with(drive.link_friction, rest))
    if drive.rotor is not None:
        inertia = next(rest) / (drive.ratio * drive.ratio)
        drive = replace(drive, rotor=replace(drive.rotor, inertia=inertia))
    if isinstance(drive.compliance, LinearSpring):
        drive = replace(drive, compliance=LinearSpring(1 / next(rest)))
    return replace(drive, motor_friction=_with(drive.motor_friction, rest))


def powers(drive: Drive, p: JointPower) -> Scalars:
    """The power error per unit of each parameter, W.

    Friction's is that of steady motion at the required speed: it varies less than the law's, which sticking disturbs.
    The compliance's is scaled by the nominal stiffness in place of the true one, a constant: it enters the energy of
    the spring's error, K (delta_r - delta)^2 / 2, and the required deflection is compliance * tau_r.
    """
    lag, motor_lag = p.speed - p.at.v, p.motor_speed - p.at.theta_dot
    if not drive.is_elastic:
        motor_lag = lag
    found = [x * lag for x in _columns(drive.link_friction, p.speed)]
    if drive.rotor is not None:
        found.append((p.motor_acceleration if drive.is_elastic else p.acceleration) * motor_lag)
    if isinstance(drive.compliance, LinearSpring):
        found.append(drive.compliance.stiffness * p.torque * (lag - motor_lag))
    return found + [x * motor_lag for x in _columns(drive.motor_friction, p.motor_speed)]


def adapted(
    drive: Drive, numbers: Scalars, power: JointPower, rate: Scalar, uncertainty: Scalar, period: Scalar
) -> Scalars:
    """The parameters a period later, each within `uncertainty` times its nominal value."""
    return [
        projected(x, s, rate * x_0 * x_0, x_0 * (1 - uncertainty), x_0 * (1 + uncertainty), period)
        for x, x_0, s in zip(numbers, nominal(drive), powers(drive, power), strict=True)
    ]


def _coefficients(law: Any) -> Scalars:
    sliding = sliding_of(law)
    return [] if sliding is None else [getattr(sliding, name) for name in sliding.coefficients]


def _columns(law: Any, speed: Scalar) -> Scalars:
    sliding = sliding_of(law)
    return [] if sliding is None else sliding.columns(speed)


def _with(law: Any, numbers: Iterator[Scalar]) -> Any:
    sliding = sliding_of(law)
    if sliding is None:
        return None
    learnt = sliding.with_coefficients([next(numbers) for _ in sliding.coefficients])
    return replace(cast(Any, law), sliding=learnt) if isinstance(law, Presliding) else learnt

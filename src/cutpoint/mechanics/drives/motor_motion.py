"""What a drive asks of its motor: the motion and the torque for which it exerts a given torque on its link.

The inverse of `harmonic_drive`, with time derivatives as jets; all at the joint's side.
"""

from dataclasses import dataclass

from cutpoint.mechanics.drives.harmonic_drive import (
    beside_damping,
    friction_torque,
    load_on_motor,
    motor_position,
    slipping_torque,
)
from cutpoint.mechanics.drives.strains import Strains
from cutpoint.model.drive import Drive
from cutpoint.scalars import Jet, Scalar, where


@dataclass(frozen=True)
class MotorMotion:
    """A motor's motion with its derivatives, and the torque that its drive transmits, N m."""

    theta: Jet
    passed: Scalar


def motor_motion(drive: Drive, tau: Jet, q: Scalar, v: Jet, strains: Strains, *, friction_rates: bool) -> MotorMotion:
    """The motor motion for which its drive exerts the joint torque tau, N m, on the link.  Xia (2019) eqs. (2), (3).

    q, v: the link's position, rad, and speed, rad/s.  friction_rates: see `elastic_inverse.Options`.
    """
    tau_0, v_0 = tau.derivative(0), v.derivative(0)
    link = Jet(q, *v.derivatives)
    if drive.compliance is None:
        return MotorMotion(link, tau_0 + friction_torque(drive.link_friction, v_0, strain=strains.link))
    xi = friction_torque(drive.link_friction, v if friction_rates else v_0, strain=strains.link)
    tau_f = tau + xi
    on_spring = tau_f - slipping_torque(drive, strains.spring)
    wound = _stiffened(drive, drive.compliance.deflection(on_spring), strains)
    wound = beside_damping(drive, wound, on_spring.derivative(0))
    return MotorMotion(motor_position(drive, link + wound), tau_f.derivative(0))


def motor_torque(drive: Drive, motor: MotorMotion, strain: Scalar | None = None) -> Scalar:
    """The motor's torque, N m: on its drive, against friction, and on its rotor's own spin.

    Xia (2019) eqs. (22), (27).  strain: of the motor's friction.
    """
    theta = motor.theta
    torque = load_on_motor(drive, motor.passed, theta.derivative(0), theta.derivative(1), strain)
    if drive.compliance is not None:
        torque = torque + drive.reflected_inertia * theta.derivative(2)
    return torque


def _stiffened(drive: Drive, wound: Jet, strains: Strains) -> Jet:
    """A spring's deflection, its rates those of the spring with all sticking hysteresis elements."""
    if drive.compliance is None or drive.hysteresis is None or strains.spring is None:
        return wound
    direction = where(wound.derivative(1) < 0, -1, 1)
    spring, beside = drive.compliance.tangent(wound.derivative(0)), drive.hysteresis.sticking(strains.spring, direction)
    share = spring / (spring + beside)
    return Jet(wound.derivative(0), *(share * x for x in wound.derivatives[1:]))

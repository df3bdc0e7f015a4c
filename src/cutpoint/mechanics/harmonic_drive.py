"""A joint with a harmonic drive: what motor and link exert on each other.  Xia (2019) section II.

All quantities at the joint's side: theta is the rotor's angle divided by ratio, motor_torque the shaft torque times it.
"""

from cutpoint.model.drive import Drive, Friction
from cutpoint.scalars import Scalar


def deflection(theta: Scalar, q: Scalar) -> Scalar:
    """How far the motor leads the link, rad (m).  Xia (2019) eq. (3)."""
    return theta - q


def spring_torque(drive: Drive, theta: Scalar, q: Scalar, theta_dot: Scalar = 0, v: Scalar = 0) -> Scalar:
    """tau_f: what the drive exerts on the link, from an encoder on either side, N m.  Xia (2019) eqs. (1)-(3).

    The spring's own damping needs the speeds on both sides; without them it is left out.
    """
    assert drive.compliance is not None, "a rigid drive has no deflection to read a torque from"
    tau_f = drive.compliance.torque(deflection(theta, q))
    return tau_f if drive.damping is None else tau_f + drive.damping * (theta_dot - v)


def friction_torque(law: Friction | None, speed: Scalar) -> Scalar:
    """xi: what friction takes at this speed, N m.  Xia (2019) eqs. (54)-(55)."""
    return law.torque(speed) if law else 0


def rotor_acceleration(drive: Drive, motor_torque: Scalar, tau_f: Scalar, theta_dot: Scalar) -> Scalar:
    """Acceleration of the rotor over ratio, rad/s2.  Xia (2019) eqs. (22), (56); Spong (1987)."""
    xi = friction_torque(drive.motor_friction, theta_dot)
    return (motor_torque - tau_f - xi) / drive.reflected_inertia

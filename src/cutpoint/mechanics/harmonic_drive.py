"""A joint with a harmonic drive: what motor and link exert on each other.  Xia (2019) section II.

All quantities at the joint's side: theta is the rotor's angle divided by ratio, motor_torque the shaft torque times it.
"""

from cutpoint.model.drive import Drive, Friction
from cutpoint.scalars import Scalar


def deflection(drive: Drive, theta: Scalar, q: Scalar) -> Scalar:
    """How far the spring is wound up, rad (m): the motor's lead, less the kinematic error.  Xia (2019) eq. (3)."""
    lead = theta - q
    return lead if drive.kinematic_error is None else lead - drive.kinematic_error.value(theta, drive.ratio)


def motor_position(drive: Drive, output: Scalar) -> Scalar:
    """Where the motor stands when the spring's near end is at `output`, q plus deflection.  Xia (2019) eq. (3)."""
    return output if drive.kinematic_error is None else drive.kinematic_error.motor_position(output, drive.ratio)


def transmission(drive: Drive, theta: Scalar) -> Scalar:
    """1 - e'(theta): output turns for each of theta, and so what of the spring's torque the motor bears."""
    return 1 if drive.kinematic_error is None else 1 - drive.kinematic_error.slope(theta, drive.ratio)


def spring_torque(drive: Drive, theta: Scalar, q: Scalar, theta_dot: Scalar = 0, v: Scalar = 0) -> Scalar:
    """tau_f: what the drive exerts on the link, from an encoder on either side, N m.  Xia (2019) eqs. (1)-(3).

    The spring's own damping needs the speeds on both sides; without them it is left out.
    """
    assert drive.compliance is not None, "a rigid drive has no deflection to read a torque from"
    tau_f = drive.compliance.torque(deflection(drive, theta, q))
    if drive.damping is None:
        return tau_f
    return tau_f + drive.damping * (transmission(drive, theta) * theta_dot - v)


def friction_torque(law: Friction | None, speed: Scalar) -> Scalar:
    """xi: what friction takes at this speed, N m.  Xia (2019) eqs. (54)-(55)."""
    return law.torque(speed) if law else 0


def load_on_motor(drive: Drive, tau_f: Scalar, theta: Scalar, theta_dot: Scalar) -> Scalar:
    """What the motor must exert beside accelerating its rotor, N m: on the spring, and against friction.

    Xia (2019) eqs. (22), (27).
    """
    return transmission(drive, theta) * tau_f + friction_torque(drive.motor_friction, theta_dot)

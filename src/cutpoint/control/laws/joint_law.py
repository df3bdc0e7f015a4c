"""The joint subsystem of virtual decomposition control: motor torque and motion that its link requires.

Xia (2019) eqs. (13), (22), (27)-(28), in the corrected reading; Zhu and De Schutter (1999), Adaptive control of mixed
rigid/flexible joint robot manipulators based on virtual decomposition.  All at the joint's side.
"""

from typing import Any, NamedTuple

from cutpoint.mechanics.drives.harmonic_drive import (
    DriveState,
    beside_damping,
    deflection,
    motor_position,
    required_friction,
    transmission,
)
from cutpoint.model.drive import Drive
from cutpoint.scalars import Jet, Scalar, value_of


class JointGains(NamedTuple):
    """k_vq (N m s/rad), k_vkappa (N m s/rad) and the gain of the spring (1/s), one each."""

    speed: Any
    motor: Any
    spring: Any


class RequiredTorque(NamedTuple):
    """Torque required of a drive.

    tau_r: torque of the drive on its link, N m, with derivatives.  rotor: torque for the rotor's motion with its
    carrier, N m.
    """

    tau_r: Jet
    rotor: Any


class JointCommand(NamedTuple):
    """Command to a joint's motor: torque, N m, and required motion, rad, rad/s, rad/s2."""

    torque: Any
    theta: Any
    theta_dot: Any
    theta_ddot: Any


def required_drive_torque(drive: Drive, tau: Scalar, v_r: Scalar, v: Scalar, speed_gain: Scalar) -> Scalar:
    """tau_r: torque on the link, friction for the required speed and feedback of the speed, N m.  Xia (2019) eq. (26).

    tau: this joint's torque for the required motion of all links.  Friction enters by value, without derivatives, and
    in the required direction: printed at the actual speed, it would not damp.
    """
    return tau + speed_gain * (v_r - v) + required_friction(drive.link_friction, value_of(v_r), value_of(v))


def joint_command(
    drive: Drive, at: DriveState, q_d: Scalar, v_r: Jet, required: RequiredTorque, gain: JointGains
) -> JointCommand:
    """The joint's law, from the required motion and torque of its link.  Xia (2019) eqs. (13), (22), (27), (28).

    kappa_r' = v_r + d delta_r/dt + beta (delta_r - delta): the motor follows the deflection that tau_r requires, and
    corrects the spring's deflection error.  A rigid drive has the same law with kappa_r' = v_r.
    """
    tau_r, rotor = required
    if drive.compliance is None:
        speed, load = v_r.derivative(0), tau_r.derivative(0) + rotor
        torque = load + required_friction(drive.motor_friction, speed, at.v, load) + gain.motor * (speed - at.v)
        return JointCommand(torque, q_d, speed, v_r.derivative(1))
    # the required deflection, and the deflection error
    wound = beside_damping(drive, drive.compliance.deflection(tau_r), tau_r.derivative(0))
    turns = transmission(drive, Jet(at.theta, at.theta_dot))
    lag = wound - Jet(deflection(drive, at.theta, at.q), value_of(turns) * at.theta_dot - at.v)
    kappa_r = (v_r + wound.rate() + gain.spring * lag) / turns
    speed, acceleration = kappa_r.derivative(0), kappa_r.derivative(1)
    tau = tau_r.derivative(0)
    load = value_of(turns) * tau + required_friction(drive.motor_friction, speed, at.theta_dot, tau)
    torque = drive.reflected_inertia * acceleration + rotor + load + gain.motor * (speed - at.theta_dot)
    return JointCommand(torque, motor_position(drive, q_d + wound.derivative(0)), speed, acceleration)

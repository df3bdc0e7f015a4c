"""A joint with a harmonic drive: torques between motor and link.  Xia (2019) section II.

All quantities at the joint's side: theta is the rotor's angle divided by ratio, motor_torque the shaft torque times it.
"""

from typing import Any, NamedTuple

from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.presliding import Presliding
from cutpoint.model.drive import Drive, Friction, Harmonic
from cutpoint.scalars import Jet, Scalar, where


class DriveState(NamedTuple):
    """Positions and speeds of one drive's link and motor, at the joint's side; rad, rad/s."""

    q: Any
    v: Any
    theta: Any
    theta_dot: Any


def deflection(drive: Drive, theta: Scalar, q: Scalar) -> Scalar:
    """Deflection of the spring, rad (m): the motor's lead, less the kinematic error.  Xia (2019) eq. (3)."""
    lead = theta - q
    return lead if drive.kinematic_error is None else lead - drive.kinematic_error.value(theta, drive.ratio)


def motor_position(drive: Drive, output: Scalar) -> Scalar:
    """Motor position when the spring's motor-side end is at `output`, q plus deflection.  Xia (2019) eq. (3)."""
    return output if drive.kinematic_error is None else drive.kinematic_error.motor_position(output, drive.ratio)


def static_lead(drive: Drive, q: Scalar, load: Scalar) -> Scalar:
    """Lead of the motor over its link at rest, rad (m), with a load on the spring, N m (N); 0 for a rigid drive.

    Xia (2019) eqs. (2)-(3).
    """
    if drive.compliance is None:
        return 0
    return motor_position(drive, q + drive.compliance.deflection(load)) - q


def transmission(drive: Drive, theta: Scalar) -> Scalar:
    """1 - e'(theta): output speed over motor speed, and so the share of the spring's torque that acts on the motor."""
    return 1 if drive.kinematic_error is None else 1 - drive.kinematic_error.slope(theta, drive.ratio)


def spring_torque(drive: Drive, theta: Scalar, q: Scalar, theta_dot: Scalar = 0, v: Scalar = 0) -> Scalar:
    """tau_f: the drive's torque on the link, from encoders on both sides, N m.  Xia (2019) eqs. (1)-(3).

    The spring's own damping needs the speeds on both sides; without them it is left out.
    """
    assert drive.compliance is not None, "a rigid drive has no deflection to read a torque from"
    tau_f = drive.compliance.torque(deflection(drive, theta, q))
    if drive.damping is None:
        return tau_f
    return tau_f + drive.damping * (transmission(drive, theta) * theta_dot - v)


def spring_torque_and_rate(drive: Drive, at: DriveState) -> Jet:
    """tau_f with its time derivative, N m and N m/s, from the speeds on both sides; damping enters by value."""
    assert drive.compliance is not None, "a rigid drive has no deflection to read a torque from"
    wound = deflection(drive, Jet(at.theta, at.theta_dot), Jet(at.q, at.v))
    tau_f = drive.compliance.torque(wound)
    return tau_f if drive.damping is None else tau_f + drive.damping * wound.derivative(1)


def beside_damping(drive: Drive, wound: Jet, tau_f: Scalar) -> Jet:
    """Deflection, rad, at which spring and damping together give tau_f; wound: at which the spring alone does.

    Its rates stay those of the undamped law.
    """
    if drive.compliance is None or drive.damping is None:
        return wound
    return Jet(drive.compliance.deflection(tau_f - drive.damping * wound.derivative(1)), *wound.derivatives[1:])


def slipping_torque(drive: Drive, strains: tuple[Scalar, ...] | None) -> Scalar:
    """Torque of the hysteresis elements parallel to the spring, N m; zero if their strains are not known."""
    return drive.hysteresis.torque(strains) if drive.hysteresis and strains is not None else 0


def transmitted_torque(drive: Drive, at: DriveState, strains: tuple[Scalar, ...] | None) -> Scalar:
    """Torque of an elastic drive on its link, N m: of its spring, and of the hysteresis elements with these strains."""
    return spring_torque(drive, at.theta, at.q, at.theta_dot, at.v) + slipping_torque(drive, strains)


def friction_torque(law: Friction | None, speed: Scalar, load: Scalar = 0, strain: Scalar | None = None) -> Scalar:
    """xi: friction torque, N m; that of steady sliding if the strain is not known.  Xia (2019) eqs. (54)-(55)."""
    if law is None:
        return 0
    if strain is None or not isinstance(law, Presliding):
        return law.torque(speed, load)
    return law.strained_torque(strain, speed, load)


def required_friction(law: Friction | None, required: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
    """xi that a law compensates which wants the required speed, N m: see `Sliding.required_torque`.

    Laws that do not tell the size of friction from its direction count at the required speed.
    """
    if isinstance(law, Sliding | Presliding):
        return law.required_torque(required, speed, load)
    return friction_torque(law, required, load)


def friction_of_both_sides(drive: Drive, required: Scalar, speed: Scalar, torque: Scalar) -> Scalar:
    """Friction of both sides, as `required_friction`, N m; torque: transmitted by the gear without friction."""
    on_link = required_friction(drive.link_friction, required, speed)
    return on_link + required_friction(drive.motor_friction, required, speed, torque + on_link)


def friction_resistance(law: Friction | None, speed: Scalar, load: Scalar, strain: Scalar | None) -> Scalar:
    """Resistance of friction to a change of speed, N m s/rad, never below 0."""
    if law is None:
        return 0
    if strain is None or not isinstance(law, Presliding):
        return law.resistance(speed, load)
    return law.strained_resistance(strain, speed, load)


def load_on_motor(
    drive: Drive, tau_f: Scalar, theta: Scalar, theta_dot: Scalar, strain: Scalar | None = None
) -> Scalar:
    """Motor torque apart from accelerating its rotor, N m: for the spring, and against friction.

    Xia (2019) eqs. (22), (27).
    """
    return transmission(drive, theta) * tau_f + friction_torque(drive.motor_friction, theta_dot, tau_f, strain)


def rigidly_transmitted(drive: Drive, motor_torque: Scalar, speed: Scalar, strain: Scalar | None = None) -> Scalar:
    """Torque of a rigid drive on its link, N m: the motor's torque less friction, which may depend on it."""
    law = drive.motor_friction
    left = motor_torque - friction_torque(law, speed, 0, strain)
    if law is None:
        return left
    share = law.share_of_load(speed)
    return left / (1 + where(left < 0, -share, share))


def waves_of(drive: Drive) -> list[Harmonic]:
    """Those that go with the rotor's turns: kinematic error, ripple and cogging."""
    waves = [*drive.kinematic_error.harmonics] if isinstance(drive.kinematic_error, KinematicError) else []
    return waves + ([*drive.motor.ripple, *drive.motor.cogging] if drive.motor else [])

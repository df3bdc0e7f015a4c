"""The joint with its harmonic drive, friction, reference and feedback: sections II and IV."""

import numpy as np

from agreements.manipulator import robot
from agreements.registry import equations
from cutpoint import Coulomb, Drive, Flexspline, Rotor, Stribeck
from cutpoint.control import PD, Measurement, Reference
from cutpoint.control.laws.required_velocity import required_velocity
from cutpoint.formats.drives.drive_sheet import GearSheet
from cutpoint.formats.drives.entry import harmonic_ratio
from cutpoint.mechanics.drives.harmonic_drive import friction_torque, load_on_motor, motor_position, spring_torque
from cutpoint.mechanics.drives.kinematic_error import Harmonic, KinematicError
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.trajectories import cycloid
from transcript import data, joint, simulation

ELL = data.ELL


def random_drive(rng: np.random.Generator) -> Drive:
    """With the friction (54)-(55), smoothed so finely that its sign is that of any speed drawn."""
    return Drive(
        ratio=ELL,
        rotor=Rotor(data.I_M / ELL),
        compliance=Flexspline(rng.uniform(4e3, 2e4), rng.uniform(0.01, 0.1)),
        link_friction=Stribeck(*rng.uniform(0.1, 0.5, 5)),
        motor_friction=Coulomb(rng.uniform(0.1, 0.5), 0.0, 1e-6),
    )


@equations("(1)")
def ratio_of_the_gear(rng):
    """With one part at rest, the wave generator's angle per turn of the other is the ratio."""
    ell, turn = rng.uniform(30, 160), rng.normal()
    by_part = {part: harmonic_ratio(GearSheet(reduction=ell, fixed=part)) for part in ("flexspline", "circular_spline")}
    return [
        (by_part["flexspline"] * turn, joint.wave_generator_angle(ell, theta_c=turn, theta_f=0.0)),
        (by_part["circular_spline"] * turn, joint.wave_generator_angle(ell, theta_c=0.0, theta_f=turn)),
    ]


@equations("(2)")
def flexspline_law(rng):
    law, bend, torque = Flexspline(16e3, 0.0464), rng.uniform(-1.9e-3, 1.9e-3), rng.normal(0, 20)
    forth = joint.flexspline_torque(bend, law.hardening, law.stiffness)
    back = joint.deflection_of_torque(torque, law.hardening, law.stiffness)
    return [(law.torque(bend), forth), (law.deflection(torque), back)]


@equations("(3)")
def deflection_between_encoders(rng):
    """What the flexspline is left with of the lead: less wave generator, beyond its blend, and kinematic error."""
    flexspline, wave = Flexspline(16e3, 0.0464), WaveGenerator(60.0, 2.0, ELL, 1e-3)
    spring, error = HarmonicSpring(flexspline, wave), KinematicError((Harmonic(2, 1e-4, 0.3),))
    drive = Drive(ELL, Rotor(1e-5), spring, kinematic_error=error)
    q, tau_f = rng.normal(), rng.choice([-1, 1]) * rng.uniform(1.0, 50.0)
    theta = motor_position(drive, q + spring.deflection(tau_f))
    left = joint.flexspline_deflection(theta - q, tau_f / ELL, 2.0, 60.0, ELL, error.value(theta, ELL))
    return [(flexspline.deflection(tau_f), left), (spring_torque(drive, theta, q), tau_f)]


@equations("(12)")
def required_velocity_of_the_joints(rng):
    gains = rng.uniform(1.0, 50.0, 6)
    desired, actual = rng.normal(size=(2, 6)), rng.normal(size=(1, 6))
    found = [v_r.derivative(0) for v_r in required_velocity(gains, desired, actual)]
    return [(found, joint.required_joint_velocity(desired[1], np.diag(gains), desired[0], actual[0]))]


@equations("(4)", "(13)")
def rotor_speed(rng):
    """About its own axis, on a base at rest: the reduced model's rotor has no other motion."""
    motion = rng.normal(size=(5, 6))
    u = robot().elastic_inverse_dynamics(*motion)
    spins = [joint.rotor_velocity(ELL, x, np.eye(6), np.zeros(6))[5] for x in u.theta_dot]
    return [(robot().to_rotor(angle=u.theta_dot), spins)]


@equations("(21)", "(26)")
def torque_on_the_output_link(rng):
    """The joint's torque is the spring's less the link's friction."""
    motion = rng.normal(size=(5, 6))
    u = robot().elastic_inverse_dynamics(*motion)
    tau_t = robot().to_rotor(torque=robot().drive_torque(u.theta, motion[0]))
    xi = robot().friction_torques(motion[1])
    axial = [joint.required_output_axis_torque(ELL, t, 0.0, 0.0, 0.0, x) for t, x in zip(tau_t, xi, strict=True)]
    wrenches = np.eye(6)[5] * u.joint_torque[:, None]
    back = [joint.drive_torque(ELL, F, x, 0.0, 0.0, 0.0) for F, x in zip(wrenches, xi, strict=True)]
    return [(u.joint_torque, axial), (tau_t, back)]


@equations("(22)", "(27)", "(28)", "(56)")
def torque_on_the_rotor(rng):
    """Ours stands at the joint's side: the paper's is 1 / ell of it."""
    drive, (theta, q, speed, u) = random_drive(rng), rng.normal(size=4)
    tau_f = spring_torque(drive, q + 1e-3 * theta, q)
    xi = friction_torque(drive.motor_friction, speed)
    acceleration = (u - load_on_motor(drive, tau_f, theta, speed)) / drive.reflected_inertia
    spin = simulation.rotor_inertia_torque(data.I_M, acceleration)
    F = np.array([0, 0, 0, 0, 0, spin])
    return [
        (drive.reflected_inertia * acceleration / ELL, spin),
        (spin, joint.required_rotor_axis_torque(u / ELL, tau_f / ELL, 0.0, 0.0, 0.0, xi / ELL)),
        (u / ELL, joint.control_torque(tau_f / ELL, 0.0, 0.0, 0.0, xi / ELL, F)),
        (u / ELL, joint.motor_torque(data.I_M, acceleration, tau_f, ELL, xi / ELL)),
    ]


@equations("(54)")
def friction_of_the_link(rng):
    law, speed = Stribeck(*rng.uniform(0.1, 2.0, 5)), rng.normal()
    numbers = (law.coulomb, law.static, law.viscous, law.stribeck_velocity, law.smoothing)
    return [(law.torque(speed), simulation.link_friction(speed, *numbers))]


@equations("(55)")
def friction_of_the_motor(rng):
    f_ck, speed = rng.uniform(0.1, 2.0), rng.normal()
    law = Coulomb(ELL * f_ck, 0.0, smoothing=1e-9)
    return [(law.torque(speed) / ELL, simulation.motor_friction(speed, f_ck))]


@equations("(57)")
def reference(rng):
    t = rng.uniform(0.0, data.T_END)
    theirs = [simulation.trajectory(t, data.Q_D, data.T_END, order) for order in range(5)]
    return [(cycloid(data.Q_D, data.T_END)(t), theirs)]


@equations("(58)")
def feedback(rng):
    """On either side: the gains act on the angles of that side."""
    kp, kd, *x = rng.uniform(0.1, 3.0, (10, 6))
    m, r = Measurement(0.0, 1e-3, *x[:4]), Reference(x[4], x[5], 0, 0, 0, x[6], x[7])
    link, motor = (PD(kp, kd, side=side).step((), m, r)[1].torque for side in ("link", "motor"))
    return [
        (link, simulation.feedback(np.diag(kd), np.diag(kp), r.q, m.q, r.v, m.v)),
        (motor, simulation.feedback(np.diag(kd), np.diag(kp), r.theta, m.theta, r.theta_dot, m.theta_dot)),
    ]

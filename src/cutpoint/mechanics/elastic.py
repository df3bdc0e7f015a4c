"""Robots whose joints bend: motor torques of a motion, and accelerations under motor torques.

Reduced model (Spong 1987): a rotor's kinetic energy is that of its own spin.  Xia (2019) eqs. (21)-(28), (56), with the
motor torque as the errata read it: tau_m = I_m theta'' + tau_f + xi, all at the joint's side.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from cutpoint.mechanics.forward_dynamics import forward_dynamics
from cutpoint.mechanics.harmonic_drive import friction_torque, rotor_acceleration, spring_torque
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics
from cutpoint.mechanics.system import System
from cutpoint.model.drive import Drive
from cutpoint.scalars import Jet, Scalar

Scalars = Sequence[Scalar]


@dataclass(frozen=True)
class Driven:
    """A drive and the speed (and coordinate) it drives."""

    drive: Drive
    q: int
    v: int


class ElasticMotion(NamedTuple):
    """What motors must do for a motion, one entry a drive; joint_torque has one for each speed.

    motor_torque (N m), theta (rad), theta_dot (rad/s), theta_ddot (rad/s2), joint_torque (N m): at the joint's side.
    """

    motor_torque: list[Any]
    theta: list[Any]
    theta_dot: list[Any]
    theta_ddot: list[Any]
    joint_torque: list[Any]


class ElasticAccelerations(NamedTuple):
    """Accelerations of the links' coordinates (one a speed) and of the motors (one a drive)."""

    a: list[Any]
    theta_ddot: list[Any]


def elastic_inverse_dynamics(
    system: System,
    drives: Sequence[Driven],
    q: Scalars,
    v: Scalars,
    a: Scalars,
    jerk: Scalars,
    snap: Scalars,
    friction_rates: bool = False,
) -> ElasticMotion:
    """Motor torques and motor motion of a motion with four derivatives, exact in all of them.

    Xia (2019) eqs. (2), (13)-(28).

    Every coordinate carries two time derivatives through the recursion, so joint torques come out with theirs.
    Friction enters by value; friction_rates=True lets its derivatives through the spring too (they spike where it is
    smoothed sharply).  A damped spring's rate of deflection is that of the undamped law: the result then still makes
    `elastic_forward_dynamics` return a and theta_ddot exactly, but theta_dot is off d theta/dt by the order of damping.
    """
    v_t = [Jet(*x) for x in zip(v, a, jerk, strict=True)]
    a_t = [Jet(*x) for x in zip(a, jerk, snap, strict=True)]
    tau = [_as_jet(t) for t in inverse_dynamics(system, coordinate_jets(system, q, v_t), v_t, a_t)]
    motors = [_motor_motion(d, tau[d.v], q[d.q], v_t[d.v], friction_rates) for d in drives]
    torque, theta, theta_dot, theta_ddot = ([motor[k] for motor in motors] for k in range(4))
    return ElasticMotion(torque, theta, theta_dot, theta_ddot, [t.derivative(0) for t in tau])


def coordinate_jets(system: System, q: Scalars, v: Sequence[Jet]) -> list[Jet]:
    """Coordinates with as many time derivatives as the speeds have values, from q' = rates(q, v) order by order."""
    jets = [Jet(x) for x in q]
    for body in system.segments:
        if body.follower:
            continue
        own = [Jet(x) for x in q[body.q]]
        for k in range(len(v[body.v.start].c) - 1):
            rates = body.joint.rates(own, [Jet.of_taylor(v_i.c[: k + 1]) for v_i in v[body.v]])
            own = [Jet.of_taylor([*x.c, rate.c[k] / (k + 1)]) for x, rate in zip(own, rates, strict=True)]
        jets[body.q] = own
    return jets


def _motor_motion(driven: Driven, tau: Jet, q: Scalar, v: Jet, friction_rates: bool) -> tuple[Scalar, ...]:
    """Motor torque, and motor position, speed and acceleration over ratio, for a joint torque with its derivatives."""
    drive, (v_0, a_0) = driven.drive, (v.derivative(0), v.derivative(1))
    xi = friction_torque(drive.link_friction, v if friction_rates else v_0)
    tau_f = tau + xi
    if drive.compliance is None:
        return tau_f.derivative(0) + friction_torque(drive.motor_friction, v_0), q, v_0, a_0
    # how far, and how fast, the motor must lead the link
    lead = drive.compliance.deflection(tau_f)
    lead_by = lead.derivative(0)
    if drive.damping is not None:
        lead_by = drive.compliance.deflection(tau_f.derivative(0) - drive.damping * lead.derivative(1))
    theta_dot, theta_ddot = v_0 + lead.derivative(1), a_0 + lead.derivative(2)
    # what the rotor's own inertia and friction ask beside
    xi_motor = friction_torque(drive.motor_friction, theta_dot)
    return drive.reflected_inertia * theta_ddot + tau_f.derivative(0) + xi_motor, q + lead_by, theta_dot, theta_ddot


def _as_jet(x: Any) -> Jet:
    """A torque that no motion enters (a joint without mass beyond it) comes out as a plain number."""
    return x if isinstance(x, Jet) else Jet(x, 0, 0)


def elastic_forward_dynamics(
    system: System,
    drives: Sequence[Driven],
    q: Scalars,
    v: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
    motor_torque: Scalars,
    disturbance: Scalars | None = None,
) -> ElasticAccelerations:
    """Accelerations of links and motors under motor torques.  Spong (1987); Xia (2019) eqs. (5), (21)-(22).

    A rigid drive's motor moves with its link: its theta and theta_dot are not read.  disturbance: torques on the links'
    coordinates, one a speed.
    """
    driving = driving_torques(drives, q, v, theta, theta_dot, motor_torque)
    tau = [*disturbance] if disturbance is not None else [0] * system.nv
    for d, tau_d in zip(drives, driving, strict=True):
        tau[d.v] = tau[d.v] + tau_d - friction_torque(d.drive.link_friction, v[d.v])
    a = forward_dynamics(system, q, v, tau)
    alpha = [
        rotor_acceleration(d.drive, u, tau_d, w) if d.drive.is_elastic else a[d.v]
        for d, u, tau_d, w in zip(drives, motor_torque, driving, theta_dot, strict=True)
    ]
    return ElasticAccelerations(a, alpha)


def driving_torques(
    drives: Sequence[Driven], q: Scalars, v: Scalars, theta: Scalars, theta_dot: Scalars, motor_torque: Scalars
) -> list[Scalar]:
    """What each drive exerts on its link, N m: the spring's torque, or a rigid drive's motor less its own friction."""
    return [
        spring_torque(d.drive, theta_d, q[d.q], omega_d, v[d.v])
        if d.drive.is_elastic
        else u - friction_torque(d.drive.motor_friction, v[d.v])
        for d, theta_d, omega_d, u in zip(drives, theta, theta_dot, motor_torque, strict=True)
    ]


def elastic_energy(drives: Sequence[Driven], q: Scalars, theta: Scalars, theta_dot: Scalars) -> Scalar:
    """Energy in springs and spinning rotors of the elastic drives, J."""
    total: Scalar = 0
    for d, theta_k, theta_dot_k in zip(drives, theta, theta_dot, strict=True):
        if d.drive.compliance is not None:
            spin = d.drive.reflected_inertia * theta_dot_k * theta_dot_k / 2
            total = total + d.drive.compliance.energy(theta_k - q[d.q]) + spin
    return total


def link_friction(system: System, drives: Sequence[Driven], v: Scalars) -> list[Scalar]:
    """What link-side friction takes from each speed, N m.  Xia (2019) eq. (54)."""
    xi: list[Scalar] = [0] * system.nv
    for d in drives:
        xi[d.v] = friction_torque(d.drive.link_friction, v[d.v])
    return xi

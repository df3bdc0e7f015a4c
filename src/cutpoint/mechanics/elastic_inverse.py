"""Inverse dynamics of robots with elastic joints: motor torques of a motion.  Forward dynamics is in `elastic_forward`.

Reduced coupling (Spong 1987): a rotor's kinetic energy is that of its own spin.  Full coupling: it is a body, see
`rotors`.  Xia (2019) eqs. (4)-(11), (21)-(28), (56), with the motor torque read as tau_m = I_m theta'' + tau_f + xi,
all at the joint's side.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

from cutpoint.mechanics.bodies.rotors import Spin
from cutpoint.mechanics.bodies.spatial import Wrench
from cutpoint.mechanics.drives.motor_motion import MotorMotion, motor_motion, motor_torque
from cutpoint.mechanics.drives.strains import Strains, or_unknown
from cutpoint.mechanics.inverse_dynamics import BodyMotion, motions, net_wrenches, rotor_efforts
from cutpoint.mechanics.kinematics import coordinate_jets
from cutpoint.mechanics.system import Driven, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Jet, Scalar, value_of

Scalars = Sequence[Scalar]
Entries = TypeVar("Entries")


@dataclass(frozen=True)
class Options:
    """How elastic inverse dynamics treats non-smooth or costly terms.

    friction_rates: include friction's derivatives in the spring's motion, not its value only (they spike where it is
    smoothed sharply).  quasi_rigid: rotors with full coupling act on their carriers as if their drives were rigid,
    which takes four derivatives for any number of them.
    """

    friction_rates: bool = False
    quasi_rigid: bool = False


DEFAULT = Options()


class ElasticTorques(NamedTuple, Generic[Entries]):
    """Motor torques and motion for a motion; at the joint's side, one entry per drive (joint_torque: per speed).

    motor_torque (N m), theta (rad), theta_dot (rad/s), theta_ddot (rad/s2), joint_torque (N m).
    """

    motor_torque: Entries
    theta: Entries
    theta_dot: Entries
    theta_ddot: Entries
    joint_torque: Entries


def elastic_inverse_dynamics(
    system: System,
    drives: Sequence[Driven],
    q: Scalars,
    *rates: Scalars,
    options: Options = DEFAULT,
    strains: Sequence[Strains] | None = None,
) -> ElasticTorques[list[Any]]:
    """Motor torques and motor motion of a motion, exact in its derivatives.  Xia (2019) eqs. (2), (4)-(11), (21)-(28).

    rates: v, a, jerk, snap and, where a rotor with full coupling rides on a joint that bends, as many more as
    `derivatives_needed` says.  Every coordinate carries its derivatives through the recursion as a time jet, so joint
    torques come out with theirs.  A damped spring's rate of deflection is that of the undamped law: the result then
    still makes `elastic_forward_dynamics` return a and theta_ddot exactly, but theta_dot is off d theta/dt by the order
    of damping.  strains: of the drives; their torques enter by value, as friction does.
    """
    # only springs need the torques' derivatives
    needed = rates if any(d.drive.is_elastic for d in drives) else rates[:2]
    v = [Jet(*x) for x in zip(*needed, strict=True)]
    a = [x.rate() for x in v]
    # outward: the motion of each body, and the wrench and torques that it takes, with their derivatives
    moved = motions(system, coordinate_jets(system, q, v), v, None)
    F = net_wrenches(system, moved, v, a)
    tau: list[Jet] = [_as_jet(x) for x in rotor_efforts(system, moved, a)]
    whole_at = _whole_at(system, drives)
    motors: dict[int, MotorMotion] = {}
    spins = {spin.joint: spin for spin in system.spins if spin.elastic}
    strained = {d.segment: s for d, s in zip(drives, or_unknown(strains, drives), strict=True)}
    # inward: each joint's torque, its motor's motion, and the wrenches of rotor and body on the carrier
    for i, segment in reversed([*enumerate(system.segments)]):
        for k, effort in enumerate(segment.joint.effort(F[i]), segment.v.start):
            tau[k] = tau[k] + segment.gain * effort
        if i in whole_at:
            driven = whole_at[i]
            held = strained[driven.segment]
            at = tau[driven.v], q[driven.q], v[driven.v]
            motors[driven.segment] = motor_motion(driven.drive, *at, held, friction_rates=options.friction_rates)
        if i in spins:
            F[spins[i].carrier] = F[spins[i].carrier] + _spin_wrench(spins[i], moved, motors[i], v, a, system, options)
        if segment.parent != WORLD:
            F[segment.parent] = F[segment.parent] + moved[i].X.inward(F[i])
    torques = [motor_torque(d.drive, motors[d.segment], strained[d.segment].motor) for d in drives]
    # a rotor with full coupling also turns with its carrier
    for k, spin in enumerate(spins.get(d.segment) for d in drives):
        if spin:
            torques[k] = torques[k] + value_of(spin.along(moved[spin.carrier].A.angular))
    theta, theta_dot, theta_ddot = ([motors[d.segment].theta.derivative(k) for d in drives] for k in range(3))
    return ElasticTorques(torques, theta, theta_dot, theta_ddot, [t.derivative(0) for t in tau])


def derivatives_needed(system: System, drives: Sequence[Driven]) -> int:
    """How many time derivatives of the position an exact elastic inverse dynamics takes.  Buondonno and De Luca (2015).

    4 with a spring; 2 more for each rotor with full coupling behind a spring that itself rides on a joint that bends,
    along the arm that has most of them.
    """
    depth = [0] * len(system.segments)
    elastic = {d.segment for d in drives if d.drive.is_elastic}
    carried = {spin.joint: spin.carrier for spin in system.spins if spin.elastic}
    # inward: how many derivatives of a body's wrench the motors beyond it use up
    for i, segment in reversed([*enumerate(system.segments)]):
        if i in carried:
            depth[carried[i]] = max(depth[carried[i]], depth[i] + 2)
        if segment.parent != WORLD:
            depth[segment.parent] = max(depth[segment.parent], depth[i])
    return 2 + max((depth[i] + 2 for i in elastic), default=0)


def _whole_at(system: System, drives: Sequence[Driven]) -> dict[int, Driven]:
    """The drive whose joint's torque is complete at a segment, inward: a leader's at its innermost follower."""
    innermost = {segment.v.start: i for i, segment in reversed([*enumerate(system.segments)])}
    return {innermost[d.v]: d for d in drives}


def _spin_wrench(
    spin: Spin, moved: Sequence[BodyMotion], motor: MotorMotion, v: Any, a: Any, system: System, options: Options
) -> Wrench:
    """Wrench of an elastic drive's rotor on its carrier, with as many derivatives as available."""
    own = system.segments[spin.joint]
    speed, acceleration = own.speeds(v)[0], own.speeds(a)[0]
    if not options.quasi_rigid:
        speed = motor.theta.rate()
        acceleration = speed.rate()
    return spin.reaction(moved[spin.carrier].V.angular, speed, acceleration)


def _as_jet(x: Any) -> Jet:
    """The torque as a jet; one that does not depend on motion (no mass beyond the joint) comes as a plain number."""
    return x if isinstance(x, Jet) else Jet(x, 0, 0)

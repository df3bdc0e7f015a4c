"""Forward dynamics of robots with elastic joints: accelerations under motor torques, one step per drive.

All quantities at the joint's side.  Spong (1987); Xia (2019) eqs. (4)-(11), (21)-(22).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Generic, NamedTuple, TypeVar

from cutpoint.mechanics.drives.harmonic_drive import (
    DriveState,
    friction_torque,
    load_on_motor,
    rigidly_transmitted,
    transmitted_torque,
)
from cutpoint.mechanics.drives.strains import Strains, or_unknown
from cutpoint.mechanics.forward_dynamics import (
    FreeRotor,
    articulated_accelerations,
    is_shallow,
    through_mass_matrix,
)
from cutpoint.mechanics.system import Driven, System
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]
Entries = TypeVar("Entries")


class ElasticAccelerations(NamedTuple, Generic[Entries]):
    """Accelerations of the links' coordinates, one per speed, and of the motors, one per drive; rad/s2 (m/s2)."""

    a: Entries
    theta_ddot: Entries


class DriveEffort(NamedTuple):
    """Torques of one drive on its link and on its rotor.

    on_link: N m on its link, friction deducted; transmitted: N m through the drive, before the link's friction.
    net: torque on an elastic drive's rotor, N m; mobility: the rotor's acceleration per unit of it, 1/(kg m2).
    inertia: kg m2, added to the link's own.  follows: the share of the link's acceleration that an elastic drive's
    rotor takes on.
    """

    on_link: Any
    net: Any
    transmitted: Any
    mobility: Any = 0
    inertia: Any = 0
    follows: Any = 0

    @property
    def alpha(self) -> Any:
        """The rotor's acceleration while carrier and link do not accelerate, rad/s2."""
        return self.net * self.mobility


def drive_effort(drive: Drive, at: DriveState, motor_torque: Scalar, strains: Strains) -> DriveEffort:
    """The joint's step: torques of motor and friction on link and rotor.  Xia (2019) eqs. (21)-(22), (54)-(55)."""
    xi = friction_torque(drive.link_friction, at.v, strain=strains.link)
    if not drive.is_elastic:
        tau = rigidly_transmitted(drive, motor_torque, at.v, strains.motor)
        return DriveEffort(tau - xi, 0, tau)
    tau_f = transmitted_torque(drive, at, strains.spring)
    net = motor_torque - load_on_motor(drive, tau_f, at.theta, at.theta_dot, strains.motor)
    return DriveEffort(tau_f - xi, net, tau_f, 1 / drive.reflected_inertia)


def drive_states(
    drives: Sequence[Driven], q: Scalars, v: Scalars, theta: Scalars, theta_dot: Scalars
) -> list[DriveState]:
    """The state of each drive, from the robot's q and v and the motors' theta and theta_dot."""
    return [DriveState(q[d.q], v[d.v], x, w) for d, x, w in zip(drives, theta, theta_dot, strict=True)]


def elastic_forward_dynamics(
    system: System,
    drives: Sequence[Driven],
    q: Scalars,
    v: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
    motor_torque: Scalars,
    strains: Sequence[Strains] | None = None,
) -> ElasticAccelerations[list[Any]]:
    """Accelerations of links and motors under motor torques; for long trees in time linear in the number of bodies.

    Spong (1987); Xia (2019) eqs. (4)-(11), (21)-(22).  A rigid drive's motor moves with its link: its theta and
    theta_dot are not read.  strains: of the drives; where they are not known, friction is as in steady sliding and
    springs have no hysteresis.
    """
    states = drive_states(drives, q, v, theta, theta_dot)
    each = zip(drives, states, motor_torque, or_unknown(strains, drives), strict=True)
    efforts = [drive_effort(d.drive, at, u, s) for d, at, u, s in each]
    return driven_accelerations(system, drives, q, v, theta_dot, efforts)


def driven_accelerations(
    system: System,
    drives: Sequence[Driven],
    q: Scalars,
    v: Scalars,
    theta_dot: Scalars,
    efforts: Sequence[DriveEffort],
    disturbance: Scalars | None = None,
) -> ElasticAccelerations[list[Any]]:
    """Accelerations of links and motors under their drives' torques.  disturbance: N m on the links, one per speed."""
    # drives: torques on their links, and inertia that their damping adds
    tau = [*disturbance] if disturbance is not None else [0] * system.nv
    inertia = [*system.armature]
    for d, effort in zip(drives, efforts, strict=True):
        tau[d.v], inertia[d.v] = tau[d.v] + effort.on_link, inertia[d.v] + effort.inertia
    system = replace(system, armature=tuple(inertia))
    # links; with undriven joints by the recursion, which preserves symmetries exactly, as linear models need
    solves = system.has_followers or (system.nv == len(drives) and is_shallow(system))
    motors = zip(drives, efforts, theta_dot, strict=True)
    rotors = {d.segment: FreeRotor(w, e.alpha, e.mobility, e.follows) for d, e, w in motors if d.drive.is_elastic}
    if system.has_sprung_rotors or not solves:
        a, A = articulated_accelerations(system, q, v, tau, {}, rotors)
    else:
        a, A = through_mass_matrix(system, q, v, tau), []
    # motors: with their links or on their own, relative to what carries them
    alpha = {d.segment: rotors[d.segment].acceleration(a[d.v]) if d.segment in rotors else a[d.v] for d in drives}
    for spin in system.spins:
        if spin.elastic:
            turned = spin.along(A[spin.carrier].angular) * rotors[spin.joint].mobility
            alpha[spin.joint] = alpha[spin.joint] - turned
    return ElasticAccelerations(a, [alpha[d.segment] for d in drives])

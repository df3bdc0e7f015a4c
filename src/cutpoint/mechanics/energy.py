"""Energies and momentum of all bodies, and of all drives, together."""

from collections.abc import Mapping, Sequence

from cutpoint.mechanics.bodies import rigid_body
from cutpoint.mechanics.bodies.spatial import NO_WRENCH, ZERO, Wrench
from cutpoint.mechanics.drives.harmonic_drive import deflection
from cutpoint.mechanics.drives.strains import Strains, or_unknown, strain_energy
from cutpoint.mechanics.kinematics import body_velocities, world_poses
from cutpoint.mechanics.system import Driven, System
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def kinetic_energy(system: System, q: Scalars, v: Scalars) -> Scalar:
    """Kinetic energy of links and rigidly geared rotors, J."""
    total: Scalar = 0
    V = body_velocities(system, q, v)
    for body, V_i in zip(system.segments, V, strict=True):
        total = total + rigid_body.kinetic_energy(body.inertia, V_i)
    for I_m, v_i in zip(system.armature, v, strict=True):
        total = total + I_m * v_i * v_i / 2
    for spin in system.spins:
        if not spin.elastic:
            total = total + spin.along(V[spin.carrier].angular) * system.segments[spin.joint].speeds(v)[0]
    return total


def potential_energy(system: System, q: Scalars) -> Scalar:
    """Gravitational potential energy, J; zero with every centre of mass at the world's origin."""
    total: Scalar = 0
    for body, X in zip(system.segments, world_poses(system, q), strict=True):
        weighed = X.position * body.inertia.mass + X.rotation @ body.inertia.first_moment
        total = total - system.gravity.dot(weighed)
    return total


def carried_energy(system: System, q: Scalars, v: Scalars, rotors: Mapping[int, Scalar]) -> Scalar:
    """Kinetic energy due to the spin of elastic drives' fully coupled rotors on turning carriers, J.

    rotors: their speeds over ratio, by the segment that they drive.
    """
    V = body_velocities(system, q, v)
    turned = (spin.along(V[spin.carrier].angular) * rotors[spin.joint] for spin in system.spins if spin.elastic)
    return sum(turned, 0)


def momentum(system: System, q: Scalars, v: Scalars, rotors: Mapping[int, Scalar]) -> Wrench:
    """Linear and angular momentum of all bodies about the world's origin, along its axes, kg m/s and kg m2/s.

    rotors: speeds over ratio of those that elastic drives turn, by the segment; they count with full coupling.
    """
    total = NO_WRENCH
    X, V = world_poses(system, q), body_velocities(system, q, v)
    for body, X_i, V_i in zip(system.segments, X, V, strict=True):
        total = total + X_i.inward(body.inertia * V_i)
    for spin in system.spins:
        speed = rotors[spin.joint] if spin.elastic else system.segments[spin.joint].speeds(v)[0]
        total = total + X[spin.carrier].inward(Wrench(ZERO, spin.axis * (spin.geared * speed)))
    return total


def elastic_energy(
    drives: Sequence[Driven],
    q: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
    strains: Sequence[Strains] | None = None,
) -> Scalar:
    """Energy in springs and spinning rotors of the elastic drives, and in all strained elements, J."""
    total: Scalar = 0
    for d, theta_k, theta_dot_k, s in zip(drives, theta, theta_dot, or_unknown(strains, drives), strict=True):
        total = total + strain_energy(d.drive, s)
        if d.drive.compliance is not None:
            spin = d.drive.reflected_inertia * theta_dot_k * theta_dot_k / 2
            total = total + d.drive.compliance.energy(deflection(d.drive, theta_k, q[d.q])) + spin
    return total

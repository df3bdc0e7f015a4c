"""Mass matrix, energies and momentum."""

from collections.abc import Mapping, Sequence

from cutpoint.mechanics.kinematics import body_velocities, joint_poses, velocity_columns, world_poses
from cutpoint.mechanics.rigid_body import kinetic_energy
from cutpoint.mechanics.spatial import NO_WRENCH, ZERO, Inertia, Pose, Wrench
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def mass_matrix(system: System, q: Scalars) -> list[list[Scalar]]:
    """M(q), nv x nv, with rigidly geared rotors as armature.  Featherstone (2008) section 6.2."""
    X = joint_poses(system, q)
    M = [[I_m if j == k else 0 for k in range(system.nv)] for j, I_m in enumerate(system.armature)]
    # inward: each body as it would be with all it carries frozen to it
    composite: list[Inertia] = [body.inertia for body in system.segments]
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            composite[body.parent] = composite[body.parent] + composite[i].seen_from_parent(X[i])
    for i in range(len(composite)):
        _add_row(system, X, composite[i], i, M)
    if any(not spin.elastic for spin in system.spins):
        _add_spins(system, X, M)
    return M


def _add_spins(system: System, X: list[Pose], M: list[list[Scalar]]) -> None:
    """What a rigidly geared rotor's acceleration asks of each joint that turns its carrier, and the other way round."""
    columns = velocity_columns(system, X)
    for spin in system.spins:
        k = system.segments[spin.joint].v.start
        for j, V in ({} if spin.elastic else columns[spin.carrier]).items():
            M[k][j] = M[k][j] + spin.torque(V.angular)
            M[j][k] = M[j][k] + spin.torque(V.angular)


def _add_row(system: System, X: list[Pose], composite: Inertia, i: int, M: list[list[Scalar]]) -> None:
    """What accelerating joint i alone costs it and every joint that carries it."""
    body = system.segments[i]
    for v, z in body.columns():
        F, carrier = composite * z, i
        while carrier != WORLD:
            own = system.segments[carrier]
            for j, effort in enumerate(own.joint.effort(F), own.v.start):
                if carrier == i and j > v:
                    continue  # pairs of one joint's own axes are computed once, so that M is symmetric to the last bit
                M[v][j] = M[v][j] + own.gain * effort
                if carrier != i or j < v:
                    M[j][v] = M[j][v] + own.gain * effort
            F, carrier = X[carrier].inward(F), own.parent


def kinetic_energy_of(system: System, q: Scalars, v: Scalars) -> Scalar:
    """Kinetic energy of links and rigidly geared rotors, J."""
    total: Scalar = 0
    V = body_velocities(system, q, v)
    for body, V_i in zip(system.segments, V, strict=True):
        total = total + kinetic_energy(body.inertia, V_i)
    for I_m, v_i in zip(system.armature, v, strict=True):
        total = total + I_m * v_i * v_i / 2
    for spin in system.spins:
        if not spin.elastic:
            total = total + spin.torque(V[spin.carrier].angular) * system.segments[spin.joint].speeds(v)[0]
    return total


def potential_energy_of(system: System, q: Scalars) -> Scalar:
    """Potential energy of the weight, J; zero with every centre of mass at the world's origin."""
    total: Scalar = 0
    for body, X in zip(system.segments, world_poses(system, q), strict=True):
        weighed = X.position * body.inertia.mass + X.rotation @ body.inertia.first_moment
        total = total - system.gravity.dot(weighed)
    return total


def carried_energy_of(system: System, q: Scalars, v: Scalars, rotors: Mapping[int, Scalar]) -> Scalar:
    """Energy that elastic drives' rotors with full coupling have because they spin on carriers that turn, J.

    rotors: their speeds over ratio, by the segment that they drive.
    """
    V = body_velocities(system, q, v)
    turned = (spin.torque(V[spin.carrier].angular) * rotors[spin.joint] for spin in system.spins if spin.elastic)
    return sum(turned, 0)


def momentum_of(system: System, q: Scalars, v: Scalars, rotors: Mapping[int, Scalar]) -> Wrench:
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

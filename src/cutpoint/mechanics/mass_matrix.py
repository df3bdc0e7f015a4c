"""Mass matrix, energies and momentum."""

from collections.abc import Sequence

from cutpoint.mechanics.kinematics import body_velocities, joint_poses, world_poses
from cutpoint.mechanics.rigid_body import kinetic_energy
from cutpoint.mechanics.spatial import NO_WRENCH, Inertia, Wrench
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
    return M


def _add_row(system: System, X: list, composite: Inertia, i: int, M: list[list[Scalar]]) -> None:
    """What accelerating joint i alone costs it and every joint that carries it."""
    body = system.segments[i]
    gain = body.follower.multiplier if body.follower else 1
    for k in range(len(body.joint.free)):
        v = body.v.start + k
        F = composite * body.joint.motion([gain * int(j == k) for j in range(len(body.joint.free))])
        carrier = i
        while carrier != WORLD:
            own = system.segments[carrier]
            felt = own.follower.multiplier if own.follower else 1
            for j, effort in enumerate(own.joint.effort(F), own.v.start):
                if carrier == i and j > v:
                    continue  # a floating joint's own pairs: once each, so that M is symmetric to the last bit
                M[v][j] = M[v][j] + felt * effort
                if carrier != i or j < v:
                    M[j][v] = M[j][v] + felt * effort
            F, carrier = X[carrier].inward(F), own.parent


def kinetic_energy_of(system: System, q: Scalars, v: Scalars) -> Scalar:
    """Kinetic energy of links and rigidly geared rotors, J."""
    total: Scalar = 0
    for body, V in zip(system.segments, body_velocities(system, q, v), strict=True):
        total = total + kinetic_energy(body.inertia, V)
    for I_m, v_i in zip(system.armature, v, strict=True):
        total = total + I_m * v_i * v_i / 2
    return total


def potential_energy_of(system: System, q: Scalars) -> Scalar:
    """Potential energy of the weight, J; zero with every centre of mass at the world's origin."""
    total: Scalar = 0
    for body, X in zip(system.segments, world_poses(system, q), strict=True):
        weighed = X.position * body.inertia.mass + X.rotation @ body.inertia.first_moment
        total = total - system.gravity.dot(weighed)
    return total


def momentum_of(system: System, q: Scalars, v: Scalars) -> Wrench:
    """Linear and angular momentum of all bodies about the world's origin, along its axes, kg m/s and kg m2/s."""
    total = NO_WRENCH
    X, V = world_poses(system, q), body_velocities(system, q, v)
    for body, X_i, V_i in zip(system.segments, X, V, strict=True):
        total = total + X_i.inward(body.inertia * V_i)
    return total

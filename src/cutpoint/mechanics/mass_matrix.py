"""The mass matrix, by composite bodies."""

from collections.abc import Sequence

from cutpoint.mechanics.bodies.spatial import Inertia, Pose
from cutpoint.mechanics.kinematics import joint_poses, velocity_columns
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def mass_matrix(system: System, q: Scalars) -> list[list[Scalar]]:
    """M(q), nv x nv, with rigidly geared rotors as armature.  Featherstone (2008) section 6.2."""
    X = joint_poses(system, q)
    M = [[I_m if j == k else 0 for k in range(system.nv)] for j, I_m in enumerate(system.armature)]
    for i, composite in enumerate(composite_inertias(system, X)):
        _add_row(system, X, composite, i, M)
    if any(not spin.elastic for spin in system.spins):
        _add_spins(system, X, M)
    return M


def composite_inertias(system: System, X: Sequence[Pose]) -> list[Inertia]:
    """Inertia of each body with all that it carries, in its own frame; X: its pose in its parent."""
    composite: list[Inertia] = [body.inertia for body in system.segments]
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            composite[body.parent] = composite[body.parent] + composite[i].seen_from_parent(X[i])
    return composite


def _add_spins(system: System, X: list[Pose], M: list[list[Scalar]]) -> None:
    """Adds the inertial coupling between rigidly geared rotors and the joints that turn their carriers."""
    columns = velocity_columns(system, X)
    for spin in system.spins:
        if spin.elastic:
            continue
        k = system.segments[spin.joint].v.start
        for j, V in columns[spin.carrier].items():
            _add(M, k, j, spin.along(V.angular))


def _add_row(system: System, X: list[Pose], composite: Inertia, i: int, M: list[list[Scalar]]) -> None:
    """Torques at joint i, and at every joint that carries it, when joint i alone accelerates."""
    body = system.segments[i]
    for v, z in body.columns():
        F = composite * z
        # the joint's own axes: each pair is computed once, so that M is symmetric to the last bit
        own_efforts = [*enumerate(body.joint.effort(F), body.v.start)]
        for j, effort in own_efforts[: v - body.v.start]:
            _add(M, v, j, body.gain * effort)
        M[v][v] = M[v][v] + body.gain * own_efforts[v - body.v.start][1]
        # inward: the joints that carry it; followers among them may share its coordinate, which then gets both terms
        F, carrier = X[i].inward(F), body.parent
        while carrier != WORLD:
            own = system.segments[carrier]
            for j, effort in enumerate(own.joint.effort(F), own.v.start):
                _add(M, v, j, own.gain * effort)
            F, carrier = X[carrier].inward(F), own.parent


def _add(M: list[list[Scalar]], j: int, k: int, coupling: Scalar) -> None:
    """Adds a coupling of two coordinates at both of its places."""
    M[j][k] = M[j][k] + coupling
    M[k][j] = M[k][j] + coupling

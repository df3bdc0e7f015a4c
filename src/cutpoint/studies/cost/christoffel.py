"""The Lagrangian formulation by Christoffel symbols, each formed from derivatives of the mass matrix: n^3 of them.

Spong, Hutchinson and Vidyasagar (2005), "Robot Modeling and Control", chapter on dynamics.  Mass matrix from composite
bodies in world axes, Featherstone (2008) section 6.2; its derivatives in closed form, since a joint turns all beyond it
as one piece.
"""

from dataclasses import dataclass

from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, ZERO, Inertia, Motion, Vec3, Wrench
from cutpoint.mechanics.system import System
from cutpoint.scalars import Scalar
from cutpoint.studies.cost.bodies import Z

Scalars = list[Scalar]


@dataclass(frozen=True, eq=False)
class _InWorld:
    """axes: each joint's motion at unit speed.  composites: each body with all it carries.  needs: composite * axis."""

    axes: list[Motion]
    composites: list[Inertia]
    needs: list[Wrench]


def torques(system: System, q: Scalars, v: Scalars, a: Scalars) -> Scalars:
    """Joint torques, N m, of a chain of revolute joints: M a + sum of c_ijk v_j v_k + g."""
    world, n = _in_world(system, q), range(system.nv)
    weight = Motion(-system.gravity, ZERO)
    M = [[world.axes[min(i, j)].power(world.needs[max(i, j)]) for j in n] for i in n]
    dM = _derivatives(world)
    tau: Scalars = []
    for i in n:
        total = world.axes[i].power(world.composites[i] * weight)
        for j in n:
            total = total + M[i][j] * a[j]
        for j in n:
            for k in range(j + 1):
                symbol = (dM[i][j][k] + dM[i][k][j] - dM[j][k][i]) / 2
                total = total + symbol * (v[j] * v[k] * (1 if j == k else 2))
        tau.append(total)
    return tau


def _in_world(system: System, q: Scalars) -> _InWorld:
    X, axes, composites = AT_ORIGIN, [], []
    for body, q_i in zip(system.segments, q, strict=True):
        X = X @ body.placement @ body.joint.pose([q_i])
        axis: Vec3 = X.rotation @ Z
        axes.append(Motion(X.position.cross(axis), axis))
        composites.append(body.inertia.seen_from_parent(X))
    for i in reversed(range(len(composites) - 1)):
        composites[i] = composites[i] + composites[i + 1]
    return _InWorld(axes, composites, [I * S for I, S in zip(composites, axes, strict=True)])


def _derivatives(world: _InWorld) -> list[list[Scalars]]:
    """dM_ij / dq_k, indexed i, j, k."""
    n = range(len(world.axes))
    dM: list[list[Scalars]] = [[[0 for _ in n] for _ in n] for _ in n]
    for k, S_k in enumerate(world.axes):
        # joint k turns every body from k on with its need: what an earlier axis sees of it changes
        for i in range(k):
            seen = world.axes[i].cross(S_k)
            for j in range(k, len(n)):
                dM[i][j][k] = dM[j][i][k] = seen.power(world.needs[j])
        # and for two joints before it, it moves what both carry
        for j in range(k):
            change = _turned(world.composites[k], S_k, world.axes[j])
            for i in range(j + 1):
                dM[i][j][k] = dM[j][i][k] = world.axes[i].power(change)
    return dM


def _turned(composite: Inertia, S_k: Motion, S_j: Motion) -> Wrench:
    """(d composite / dq_k) S_j: S_k x* I S_j - I (S_k x S_j)."""
    return S_k.cross_wrench(composite * S_j) - composite * S_k.cross(S_j)

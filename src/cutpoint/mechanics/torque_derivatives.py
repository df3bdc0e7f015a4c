"""Derivatives of the torques of a motion with respect to it, in closed form, for joints of one axis each.

The results are those of Carpentier and Mansard (2018), RSS; here a body is a cloud of mass, as in `rigid_body`.  Let
the acceleration of a frame's origin change by delta a, its angular velocity by delta omega, and let everything that it
carries move relative to it as before.  Then the acceleration of a point at r with the velocity u, both relative to the
origin, changes by

    delta a + beta x r + 2 delta omega x u,    beta = delta alpha + omega x delta omega.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import Any, NamedTuple

from cutpoint.mechanics.bodies.spatial import ZERO, Inertia, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.inverse_dynamics import BodyMotion, motions, net_wrenches, transmitted_wrenches
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]
Matrix = list[list[Scalar]]


class Change(NamedTuple):
    """Change of a frame's motion: delta a and beta, as above, then delta omega."""

    A: Motion
    omega: Vec3


@dataclass(slots=True, eq=False)
class Cloud:
    """A body with all that it carries: the change of its wrench with its frame's motion, in its axes.

    twice_momentum: the sum of 2 u dm.  drift: that of 2 u r^T dm.
    """

    inertia: Inertia
    twice_momentum: Vec3
    drift: Mat3

    @staticmethod
    def of(inertia: Inertia, omega: Vec3) -> "Cloud":
        """One body: u = omega x r."""
        twice = omega * 2
        return Cloud(inertia, twice.cross(inertia.first_moment), twice.skew() @ inertia.second_moment)

    def __add__(self, other: "Cloud") -> "Cloud":
        return Cloud(self.inertia + other.inertia, self.twice_momentum + other.twice_momentum, self.drift + other.drift)

    def seen_from_parent(self, X: Pose, u: Vec3) -> "Cloud":
        """The same in the parent's frame, in which this one's origin has the velocity u."""
        R, r, inertia, twice = X.rotation, X.position, self.inertia.seen_from_parent(X), u * 2
        momentum = R @ self.twice_momentum
        drift = R.congruence(self.drift) + _outer(twice, inertia.first_moment) + _outer(momentum, r)
        return Cloud(inertia, momentum + twice * inertia.mass, drift)

    def wrench(self, change: Change) -> Wrench:
        """Change of the wrench."""
        inert, omega = self.inertia * change.A, change.omega
        moment = omega * _trace(self.drift) - self.drift @ omega
        return inert + Wrench(omega.cross(self.twice_momentum), moment)

    def effort(self, S: Motion) -> "Effort":
        """Change of the wrench along S."""
        turning = S.angular * _trace(self.drift) - self.drift.T @ S.angular
        return Effort(self.inertia * S, self.twice_momentum.cross(S.linear) + turning)


class Effort(NamedTuple):
    """A number that is linear in a change: by its A, then by its omega."""

    F: Wrench
    moment: Vec3

    def of(self, change: Change) -> Scalar:
        return change.A.power(self.F) + change.omega.dot(self.moment)

    def seen_from_parent(self, X: Pose, u: Vec3) -> "Effort":
        """The same number, for a change of the parent's motion."""
        F = X.inward(self.F)
        return Effort(F, X.rotation @ self.moment + (u * 2).cross(F.force))


def torque_derivatives(system: System, q: Scalars, v: Scalars, a: Scalars) -> tuple[Matrix, Matrix, Matrix]:
    """d torque / d (q, v, a), N m (N) for each rad (m) and its rates, a row for each torque.

    Of joints of one axis each, without followers and rigidly geared rotors with full coupling: see `suits`.
    """
    moved, n = motions(system, q, v, a), system.nv
    X, S = [m.X for m in moved], [body.joint.motion([1]) for body in system.segments]
    F = transmitted_wrenches(system, X, net_wrenches(system, moved, v, a), {})
    u = _origin_velocities(system, moved, v)
    clouds = _clouds(system, moved, u)
    by_q, by_v = ([rule(m, s) for m, s in zip(moved, S, strict=True)] for rule in (_by_position, _by_speed))
    d_q, d_v, d_a = ([[0] * n for _ in range(n)] for _ in range(3))
    for i, cloud in enumerate(clouds):
        # effect here of changes at inner joints, and effect there of a change here
        effort = cloud.effort(S[i])
        felt_q, felt_v = cloud.wrench(by_q[i]) + S[i].cross_wrench(F[i]), cloud.wrench(by_v[i])
        row, at = system.segments[i].v.start, i
        while at != WORLD:
            column = system.segments[at].v.start
            if at != i:
                d_q[column][row], d_v[column][row] = S[at].power(felt_q), S[at].power(felt_v)
            d_q[row][column], d_v[row][column] = effort.of(by_q[at]), effort.of(by_v[at])
            d_a[row][column] = d_a[column][row] = S[at].power(effort.F)
            effort = effort.seen_from_parent(X[at], u[at])
            felt_q, felt_v, at = X[at].inward(felt_q), X[at].inward(felt_v), system.segments[at].parent
    for k, I_m in enumerate(system.armature):
        d_a[k][k] = d_a[k][k] + I_m
    return d_q, d_v, d_a


def along_motion(by: Sequence[Sequence[Any]], k: int, rate: int) -> Any:
    """Derivative of the k-th time derivative of a torque with respect to a rate of the position, by Leibniz' rule.

    by: derivatives of the torque by position, speed and acceleration, each with k time derivatives along the motion.
    rate: 0 is the position, 1 the speed and so on.
    """
    lags = (rate - p for p in range(len(by)))
    terms = (comb(k, lag) * by[p][k - lag] for p, lag in enumerate(lags) if 0 <= lag <= k)
    return sum(terms, 0)


def suits(system: System) -> bool:
    """Whether all joints have one axis, none follows another, and no rigidly geared rotor has full coupling."""
    single = all(len(body.joint.axes) == 1 for body in system.segments)
    return single and not system.has_followers and all(spin.elastic for spin in system.spins)


def _by_position(m: BodyMotion, S: Motion) -> Change:
    """Change of a motion by its joint's position: the carrier turns and shifts relative to the joint."""
    linear = m.A.linear.cross(S.angular) + m.U @ S.linear
    return Change(Motion(linear, m.U @ S.angular), m.V.angular.cross(S.angular))


def _by_speed(m: BodyMotion, S: Motion) -> Change:
    twice = m.V.angular * 2
    return Change(Motion(twice.cross(S.linear), twice.cross(S.angular)), S.angular)


def _origin_velocities(system: System, moved: Sequence[BodyMotion], v: Scalars) -> list[Vec3]:
    """Velocity of each body's origin relative to its parent's, along the parent's axes."""
    found: list[Vec3] = []
    for body, m in zip(system.segments, moved, strict=True):
        omega = ZERO if body.parent == WORLD else moved[body.parent].V.angular
        sliding = m.X.rotation @ body.motion(v).linear
        found.append(omega.cross(m.X.position) + sliding)
    return found


def _clouds(system: System, moved: Sequence[BodyMotion], u: Sequence[Vec3]) -> list[Cloud]:
    """Each body with all that it carries, computed inward."""
    clouds = [Cloud.of(body.inertia, m.V.angular) for body, m in zip(system.segments, moved, strict=True)]
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            clouds[body.parent] = clouds[body.parent] + clouds[i].seen_from_parent(moved[i].X, u[i])
    return clouds


def _outer(a: Vec3, b: Vec3) -> Mat3:
    return Mat3(*(b * x for x in a))


def _trace(A: Mat3) -> Scalar:
    (xx, _, _), (_, yy, _), (_, _, zz) = A
    return xx + yy + zz

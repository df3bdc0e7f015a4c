"""The virtual-decomposition recursion: joint torques of a motion.  Xia (2019) eqs. (29)-(31), (44)-(53).

`inverse_dynamics` calls three sweeps over the bodies, which follow it in this order; these call the steps of one body.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cutpoint.mechanics.bodies.rigid_body import acceleration_gradient, gradient_beside, net_wrench
from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, NO_GRADIENT, STILL, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


@dataclass(slots=True, eq=False)
class BodyMotion:
    """A body's pose in its parent, and its motion in its own frame.

    V = [v; omega].  A: acceleration of the frame's origin, gravity included, and angular acceleration; it is the
    derivative V' of the paper plus [omega x v; 0].  U: gradient of acceleration, see `rigid_body`.
    """

    X: Pose
    V: Motion
    A: Motion
    U: Mat3


def inverse_dynamics(
    system: System, q: Scalars, v: Scalars, a: Scalars, contact: Mapping[str, Wrench] | None = None
) -> list[Scalar]:
    """Joint torques of a motion, N m (N).  Xia (2019) eqs. (29)-(31), (44)-(47).

    contact: F_e by frame name, the wrench that the robot exerts on the environment there, in that frame's axes.
    """
    # outward: each body moves as its parent does, and with its own joint
    moved = motions(system, q, v, a)
    # each body by itself: the wrench that its motion takes
    F = net_wrenches(system, moved, v, a)
    # inward: each joint also transmits what the bodies beyond it take
    F = transmitted_wrenches(system, [m.X for m in moved], F, contact or {})
    return [rotor + link for rotor, link in zip(rotor_efforts(system, moved, a), joint_efforts(system, F), strict=True)]


def motions(system: System, q: Scalars, v: Scalars, a: Scalars | None) -> list[BodyMotion]:
    """Every body's motion, outward from the base.  Xia (2019) eqs. (29)-(31).

    a: None if v are time jets, which have it as their rates: that takes fewer operations.
    """
    moved: list[BodyMotion] = []
    for body in system.segments:
        X, zv, za = body.pose(q), body.motion(v), None if a is None else body.motion(a)
        parent = at_rest(system) if body.parent == WORLD else moved[body.parent]
        if body.turns_about_parent_axis:
            moved.append(turn(X, body.placement.rotation.T.rows[2], zv, parent, za))
        else:
            omega = X.outward(parent.V).angular + zv.angular
            moved.append(move(X, omega, zv, parent, zv, za))
    return moved


def net_wrenches(
    system: System, moved: Sequence[BodyMotion], v: Scalars, a: Scalars, actual: Sequence[BodyMotion] | None = None
) -> list[Wrench]:
    """Net wrench of each body's motion, with the rigidly geared rotors that it carries.  Xia (2019) eqs. (47), (50).

    actual: how the bodies do move, where `moved` is a required motion.
    """
    F = [net_wrench(body.inertia, m.A, m.U) for body, m in zip(system.segments, moved, strict=True)]
    for spin in system.spins:
        if not spin.elastic:
            own, omega = system.segments[spin.joint], (actual or moved)[spin.carrier].V.angular
            F[spin.carrier] = F[spin.carrier] + spin.reaction(omega, own.speeds(v)[0], own.speeds(a)[0])
    return F


def transmitted_wrenches(
    system: System, X: Sequence[Pose], F: Sequence[Wrench], contact: Mapping[str, Wrench]
) -> list[Wrench]:
    """The wrench on each body through its joint, from net wrenches F*.

    Xia (2019) eqs. (9), (11), (44)-(46), (51)-(53).
    """
    F = [*F]
    for i, F_e in contact_wrenches(system, contact):
        F[i] = F[i] + F_e
    # inward: the wrench of each body acts on its parent
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            F[body.parent] = F[body.parent] + X[i].inward(F[i])
    return F


def joint_efforts(system: System, F: Sequence[Wrench]) -> list[Scalar]:
    """z^T F at each joint.  Xia (2019) eq. (21)."""
    tau: list[Scalar] = [0] * system.nv
    for body, F_i in zip(system.segments, F, strict=True):
        for k, effort in enumerate(body.joint.effort(F_i), body.v.start):
            tau[k] = tau[k] + body.gain * effort
    return tau


def rotor_efforts(
    system: System, moved: Sequence[BodyMotion], a: Scalars, actual: Sequence[BodyMotion] | None = None
) -> list[Scalar]:
    """Torques of rigidly geared rotors at each joint.  Xia (2019) eqs. (4), (56).

    actual: how the bodies do move, where `moved` is a required motion; its axes turn with them.
    """
    tau: list[Scalar] = [I_m * a_i for I_m, a_i in zip(system.armature, a, strict=True)]
    for spin in system.spins:
        if not spin.elastic:
            k, carrier = system.segments[spin.joint].v.start, moved[spin.carrier]
            alpha = carrier.A.angular
            if actual is not None:
                alpha = alpha + actual[spin.carrier].V.angular.cross(carrier.V.angular)
            tau[k] = tau[k] + spin.along(alpha)
    return tau


# the steps of one body


def move(X: Pose, omega: Vec3, zv: Motion, parent: BodyMotion, zv_r: Motion, za_r: Motion | None) -> BodyMotion:
    """A body's required motion: that of its parent, plus that of its own joint.  Xia (2019) eqs. (5), (14), (31), (49).

    X and zv are the joint's actual pose and velocity, omega the body's actual angular velocity.  The derivative of (31)
    needs that of U^T too, which turns with the joint: the terms with zv.  za_r: None if velocities are time jets, which
    have accelerations as their rates: angular ones need no sum then.
    """
    carried, R_T = X.outward(parent.V), X.rotation.T
    V = carried + zv_r
    if za_r is None:
        own, angular = zv_r.linear.rate(), V.angular.rate()
    else:
        own = za_r.linear
        angular = R_T @ parent.A.angular + za_r.angular + carried.angular.cross(zv.angular)
    linear = _origin(X, parent) + own + carried.angular.cross(zv.linear) + omega.cross(zv_r.linear)
    return BodyMotion(X, V, Motion(linear, angular), acceleration_gradient(angular, omega, V.angular))


def turn(X: Pose, axis: Vec3, zv: Motion, parent: BodyMotion, za: Motion | None) -> BodyMotion:
    """The motion of a body that turns about its z axis, `axis` in its parent.  Xia (2019) eqs. (5), (31).

    The result of `move`, in fewer operations where the axis is one of the parent's frame.  Points on the axis belong to
    both bodies and have the same acceleration: U z is the parent's U times `axis`.
    """
    carried, along = X.outward(parent.V), parent.U @ axis
    V = carried + zv
    omega = V.angular
    # U from its last column; alpha from U, apart from the joint's own contribution
    if za is None:
        own, angular = zv.linear.rate(), omega.rate()
        U = acceleration_gradient(angular, omega, omega, axis.dot(along))
    else:
        own, alpha_z = za.linear, axis.dot(parent.A.angular) + za.angular.z
        U = gradient_beside(X.rotation.T @ along, alpha_z, omega)
        angular = Vec3(omega.y * omega.z - U.rows[1].z, U.rows[0].z - omega.x * omega.z, alpha_z)
    linear = _origin(X, parent) + own + (carried.angular + omega).cross(zv.linear)
    return BodyMotion(X, V, Motion(linear, angular), U)


def _origin(X: Pose, parent: BodyMotion) -> Vec3:
    """Acceleration of the parent's point at the body's origin, along the body's axes."""
    return X.rotation.T @ (parent.A.linear + parent.U @ X.position)


def at_rest(system: System) -> BodyMotion:
    """The world: at rest, and accelerating upward to account for gravity."""
    return BodyMotion(AT_ORIGIN, STILL, system.base_acceleration, NO_GRADIENT)


def contact_wrenches(system: System, contact: Mapping[str, Wrench]) -> Iterator[tuple[int, Wrench]]:
    """Wrenches of the bodies on the environment: the body's index, the wrench in its frame.

    contact: in N and N m; in the system's unit of length N m keep their value.
    """
    for name, F_e in contact.items():
        place = system.frames[name]
        if place.body != WORLD:
            yield place.body, place.pose.inward(Wrench(F_e.force * system.length, F_e.moment))

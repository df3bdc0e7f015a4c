"""The virtual-decomposition recursion: joint torques of a motion.  Xia (2019) eqs. (29)-(31), (44)-(53).

A subsystem offers its steps: how it moves given how its parent moves, and what its joint and its parent must bear.  The
recursion calls them outward and inward, and nothing else.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cutpoint.mechanics.rigid_body import net_wrench
from cutpoint.mechanics.spatial import STILL, Motion, Pose, Wrench
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


@dataclass(slots=True, eq=False)
class BodyMotion:
    """Where a body is in its parent, and its velocity and acceleration (gravity included), in its own frame."""

    X: Pose
    V: Motion
    A: Motion


def move(body: Segment, parent: BodyMotion, q: Scalars, v: Scalars, a: Scalars) -> BodyMotion:
    """A body moves as its parent does, plus its own joint.  Xia (2019) eqs. (5), (31).

    The derivative of (31) needs that of U too: A = z a + U^T A_p - (z v) x (U^T V_p).
    """
    X, zv = body.placement @ body.joint.pose(body.coordinates(q)), body.joint.motion(body.speeds(v))
    V = X.outward(parent.V) + zv
    return BodyMotion(X, V, X.outward(parent.A) + body.joint.motion(body.speeds(a)) + V.cross(zv))


def motions(system: System, q: Scalars, v: Scalars, a: Scalars) -> list[BodyMotion]:
    """Every body's motion, outward from the base.  Xia (2019) eqs. (29)-(31)."""
    moved: list[BodyMotion] = []
    base = BodyMotion(system.base_pose, STILL, system.base_acceleration)
    for body in system.segments:
        moved.append(move(body, base if body.parent == WORLD else moved[body.parent], q, v, a))
    return moved


def bear(system: System, X: Sequence[Pose], F: list[Wrench], contact: Mapping[str, Wrench]) -> list[Wrench]:
    """The wrench that each body receives through its joint, from net wrenches F*.  Xia (2019) eqs. (44)-(46)."""
    F = [*F]
    # at the contacts: what a body hands on to the environment, it must receive
    for name, F_e in contact.items():
        place = system.frames[name]
        if place.body != WORLD:
            F[place.body] = F[place.body] + place.pose.inward(F_e)
    # inward: each body also bears its children
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            F[body.parent] = F[body.parent] + X[i].inward(F[i])
    return F


def joint_efforts(system: System, F: Sequence[Wrench], a: Scalars) -> list[Scalar]:
    """z^T F at each joint, and what rigidly geared rotors add.  Xia (2019) eqs. (21), (56)."""
    tau: list[Scalar] = [I_m * a_i for I_m, a_i in zip(system.armature, a, strict=True)]
    for body, F_i in zip(system.segments, F, strict=True):
        gain = body.follower.multiplier if body.follower else 1
        for k, effort in enumerate(body.joint.effort(F_i), body.v.start):
            tau[k] = tau[k] + gain * effort
    return tau


def inverse_dynamics(
    system: System, q: Scalars, v: Scalars, a: Scalars, contact: Mapping[str, Wrench] | None = None
) -> list[Scalar]:
    """Joint torques of a motion, N m (N).  Xia (2019) eqs. (29)-(31), (44)-(47).

    contact: F_e by frame name, the wrench that the robot exerts on the environment there, in that frame's axes.
    """
    moved = motions(system, q, v, a)
    F = [net_wrench(body.inertia, m.V.angular, m.V, m.A) for body, m in zip(system.segments, moved, strict=True)]
    return joint_efforts(system, bear(system, [m.X for m in moved], F, contact or {}), a)


def required_inverse_dynamics(system: System, q: Scalars, v: Scalars, v_r: Scalars, a_r: Scalars) -> list[Scalar]:
    """Joint torques that a required motion asks of a robot that moves with v: M a_r + C(q, v) v_r + g.

    Xia (2019) eqs. (48)-(53) without their gains K; the C it implies is that of eq. (61), summed over the bodies.
    """
    moved = motions(system, q, v, [0] * system.nv)
    required: list[BodyMotion] = []
    base = BodyMotion(system.base_pose, STILL, system.base_acceleration)
    # outward: required velocities, and their rates in frames that turn as the robot does
    for body, m in zip(system.segments, moved, strict=True):
        parent = base if body.parent == WORLD else required[body.parent]
        carried, zv = m.X.outward(parent.V), body.joint.motion(body.speeds(v))
        V_r = carried + body.joint.motion(body.speeds(v_r))
        A_r = m.X.outward(parent.A) + body.joint.motion(body.speeds(a_r)) + carried.cross(zv)
        required.append(BodyMotion(m.X, V_r, A_r))
    F_r = [
        net_wrench(body.inertia, m.V.angular, r.V, r.A)
        for body, m, r in zip(system.segments, moved, required, strict=True)
    ]
    return joint_efforts(system, bear(system, [m.X for m in moved], F_r, {}), a_r)

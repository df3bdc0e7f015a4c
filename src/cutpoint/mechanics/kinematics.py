"""Poses, velocities and Jacobians of frames.  Xia (2019) eqs. (29)-(43)."""

from collections.abc import Sequence
from typing import Literal

from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, STILL, Motion, Pose, Vec3
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Jet, Scalar, rate_of, value_of

Scalars = Sequence[Scalar]
ExpressedIn = Literal["local", "world", "local_world_aligned"]


def joint_poses(system: System, q: Scalars) -> list[Pose]:
    """Each body's frame in its parent's.  Xia (2019) eqs. (33)-(36)."""
    return [body.pose(q) for body in system.segments]


def frame_pose(system: System, q: Scalars, frame: str) -> Pose:
    """A named frame in the world."""
    place = system.frames[frame]
    X, poses = AT_ORIGIN, joint_poses(system, q)
    for i in system.chain_to(place.body):
        X = X @ poses[i]
    return X @ place.pose


def jacobian(system: System, q: Scalars, frame: str, expressed_in: ExpressedIn = "local") -> list[Motion]:
    """Columns of the frame's Jacobian, one for each speed: J_q = [U_O^T z ...].  Xia (2019) eqs. (37)-(38).

    "local": the velocity of the frame in its own axes.  "local_world_aligned": the same along the world's axes.
    "world": the velocity, along the world's axes, of the body-fixed point that coincides with the world's origin.
    """
    place = system.frames[frame]
    columns = [STILL] * system.nv
    X, poses = place.pose, joint_poses(system, q)
    # inward: the frame's velocity at unit speed of each joint
    for i in reversed(system.chain_to(place.body)):
        for v, z in system.segments[i].columns():
            columns[v] = columns[v] + X.outward(z)
        X = poses[i] @ X
    return [_expressed(column, X, expressed_in) for column in columns]


def frame_velocity(system: System, q: Scalars, v: Scalars, frame: str, expressed_in: ExpressedIn) -> Motion:
    """The velocity J v of a frame.  Xia (2019) eqs. (29)-(31)."""
    place = system.frames[frame]
    V, X, poses = STILL, AT_ORIGIN, joint_poses(system, q)
    # outward: each body moves as its parent does, and with its own joint
    for i in system.chain_to(place.body):
        V, X = poses[i].outward(V) + system.segments[i].motion(v), X @ poses[i]
    return _expressed(place.pose.outward(V), X @ place.pose, expressed_in)


def frame_acceleration(
    system: System, q: Scalars, v: Scalars, a: Scalars, frame: str, expressed_in: ExpressedIn
) -> Motion:
    """The time derivative of a frame's velocity, J a + J' v: what the velocity's time jet has beside its value."""
    speeds = [Jet(*x) for x in zip(v, a, strict=True)]
    V = frame_velocity(system, coordinate_jets(system, q, speeds), speeds, frame, expressed_in)
    rates = [value_of(rate_of(x)) for x in V]
    return Motion(Vec3(*rates[:3]), Vec3(*rates[3:]))


def _expressed(V: Motion, X: Pose, expressed_in: ExpressedIn) -> Motion:
    if expressed_in == "local":
        return V
    if expressed_in == "world":
        return V.seen_from_parent(X)
    return Motion(X.rotation @ V.linear, X.rotation @ V.angular)


def world_poses(system: System, q: Scalars) -> list[Pose]:
    """Every body's frame in the world."""
    X: list[Pose] = []
    for body, X_i in zip(system.segments, joint_poses(system, q), strict=True):
        X.append(X_i if body.parent == WORLD else X[body.parent] @ X_i)
    return X


def body_velocities(system: System, q: Scalars, v: Scalars) -> list[Motion]:
    """Every body's velocity in its own frame.  Xia (2019) eqs. (29)-(31), (40)."""
    V: list[Motion] = []
    for body, X in zip(system.segments, joint_poses(system, q), strict=True):
        parent = STILL if body.parent == WORLD else V[body.parent]
        V.append(X.outward(parent) + body.motion(v))
    return V


def velocity_columns(system: System, X: Sequence[Pose]) -> list[dict[int, Motion]]:
    """For each body, its velocity at unit speed of each coordinate that moves it.  Xia (2019) eqs. (31), (37)-(38)."""
    columns: list[dict[int, Motion]] = []
    for segment, X_i in zip(system.segments, X, strict=True):
        carried = {} if segment.parent == WORLD else columns[segment.parent]
        own = {j: X_i.outward(V) for j, V in carried.items()}
        for j, z in segment.columns():
            own[j] = own[j] + z if j in own else z
        columns.append(own)
    return columns


def velocity_map(system: System, q: Scalars) -> list[list[Motion]]:
    """J_ba without its first rows: for each body, how its velocity depends on each speed.  Xia (2019) eqs. (39)-(43).

    With the frame's Jacobian on top it is the paper's J_ba; with the speeds' unit rows between them, its J_e J_a^-1.
    """
    columns = velocity_columns(system, joint_poses(system, q))
    return [[column.get(j, STILL) for j in range(system.nv)] for column in columns]


def coordinate_rates(system: System, q: Scalars, v: Scalars) -> list[Scalar]:
    """Time derivatives of the coordinates, given the speeds."""
    rates: list[Scalar] = [0] * system.nq
    for segment in system.segments:
        if not segment.follower:
            rates[segment.q] = segment.joint.rates([*q[segment.q]], [*v[segment.v]])
    return rates


def coordinate_jets(system: System, q: Scalars, v: Sequence[Jet]) -> list[Jet]:
    """Coordinates with as many time derivatives as the speeds have values, from q' = rates(q, v) order by order."""
    jets = [Jet(x) for x in q]
    for body in system.segments:
        if body.follower:
            continue
        own = [Jet(x) for x in q[body.q]]
        for k in range(len(v[body.v.start].derivatives)):
            rates = body.joint.rates(own, [Jet(*v_i.derivatives[: k + 1]) for v_i in v[body.v]])
            own = [Jet(*x.derivatives, rate.derivatives[k]) for x, rate in zip(own, rates, strict=True)]
        jets[body.q] = own
    return jets


def of_unit_length(system: System, q: Scalars) -> list[Scalar]:
    """The same configuration with normalised quaternions."""
    same = [*q]
    for segment in system.segments:
        if not segment.follower:
            same[segment.q] = segment.joint.of_unit_length([*q[segment.q]])
    return same


def integrate(system: System, q: Scalars, step: Scalars) -> list[Scalar]:
    """Coordinates after moving for a unit of time with constant speeds `step`, each joint in its moving frame."""
    moved: list[Scalar] = [0] * system.nq
    for segment in system.segments:
        if not segment.follower:
            moved[segment.q] = segment.joint.integrated([*q[segment.q]], [*step[segment.v]])
    return moved


def difference(system: System, q: Scalars, other: Scalars) -> list[Scalar]:
    """The step with which `integrate` goes from q to the other coordinates."""
    step: list[Scalar] = [0] * system.nv
    for segment in system.segments:
        if not segment.follower:
            step[segment.v] = segment.joint.difference([*q[segment.q]], [*other[segment.q]])
    return step

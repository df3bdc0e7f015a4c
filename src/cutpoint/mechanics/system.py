"""A mechanism as the recursions want it: every joint along its own z axis, every number a scalar.

`system_of` turns each body's frame so that its joint's axis is z; frames and drives follow.  No recursion below ever
sees an axis again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.mechanics.joints import Floating, JointKind, Prismatic, Revolute
from cutpoint.mechanics.spatial import ZERO, Inertia, Mat3, Motion, Pose, Vec3
from cutpoint.model.mechanism import WORLD, Array, Body, Mechanism
from cutpoint.scalars import Scalar

KINDS: dict[str, JointKind] = {
    "revolute": Revolute(), "continuous": Revolute(), "prismatic": Prismatic(), "floating": Floating(),
}  # fmt: skip


@dataclass(frozen=True)
class Follower:
    """A coordinate that follows a leader's: q = multiplier q_leader + offset."""

    multiplier: Scalar
    offset: Scalar


@dataclass(frozen=True)
class Segment:
    """A body and the joint that carries it.

    parent: index of the carrying body, or WORLD.  placement: the joint's frame in the parent's, at coordinate zero.
    q and v: where its coordinates and speeds stand in the robot's; a follower shares its leader's.
    turn: this frame, along the joint's axis, in the body's frame as the user knows it.
    """

    name: str
    parent: int
    placement: Pose
    joint: JointKind
    inertia: Inertia
    q: slice
    v: slice
    turn: Mat3
    follower: Follower | None = None

    def coordinates(self, q: Sequence[Scalar]) -> list[Scalar]:
        """Its own coordinates out of the robot's."""
        own = [*q[self.q]]
        return [self.follower.multiplier * own[0] + self.follower.offset] if self.follower else own

    def speeds(self, v: Sequence[Scalar]) -> list[Scalar]:
        """Its own speeds (or accelerations) out of the robot's."""
        own = [*v[self.v]]
        return [self.follower.multiplier * own[0]] if self.follower else own


@dataclass(frozen=True)
class Place:
    """A frame fixed to a body (or the world)."""

    body: int
    pose: Pose


@dataclass(frozen=True)
class System:
    """Segments, parents before children; gravity in the world's frame, m/s2; frames by name.

    armature: inertia of rigidly geared rotors, one for each speed, kg m2 (kg) at the joint; 0 where there is none.
    """

    segments: tuple[Segment, ...]
    gravity: Vec3
    frames: Mapping[str, Place]
    nq: int
    nv: int
    armature: tuple[Scalar, ...]

    @property
    def base_acceleration(self) -> Motion:
        """Gravity as the world's acceleration upward: every body's weight comes by itself.  Xia (2019) eq. (62)."""
        return Motion(-self.gravity, ZERO)

    @property
    def has_followers(self) -> bool:
        """Whether some coordinate drives several joints."""
        return any(s.follower for s in self.segments)

    def chain_to(self, body: int) -> list[int]:
        """Indices of the bodies from the world outward to this one."""
        chain = []
        while body != WORLD:
            chain.append(body)
            body = self.segments[body].parent
        return chain[::-1]


def system_of(mechanism: Mechanism, armature: Mapping[str, Scalar] | None = None) -> System:
    """The mechanism with every joint along z.  armature: reflected inertia of rigidly geared rotors by joint name."""
    turns = [_turn_to_z(body) for body in mechanism.bodies]
    segments: list[Segment] = []
    leaders: dict[str, tuple[slice, slice]] = {}
    nq = nv = 0
    for body, turn in zip(mechanism.bodies, turns, strict=True):
        kind, mimic = KINDS[body.joint.kind], body.joint.mimic if mechanism.coupled else None
        if mimic:
            (q, v), follower = leaders[mimic.joint], Follower(number(mimic.multiplier), number(mimic.offset))
        else:
            q, v, follower = slice(nq, nq + kind.coordinates), slice(nv, nv + len(kind.free)), None
            nq, nv = q.stop, v.stop
        leaders[body.joint.name] = (q, v)
        placement = _turned(turns, body.parent, body.placement @ turn)
        axes = mat3(turn[:3, :3])
        segments.append(Segment(body.name, body.parent, placement, kind, _inertia_of(body, turn), q, v, axes, follower))
    frames = {f.name: Place(f.body, _turned(turns, f.body, f.placement)) for f in mechanism.frames.values()}
    rotors = _armatures(mechanism, leaders, nv, armature or {})
    return System(tuple(segments), vec3(mechanism.gravity), frames, nq, nv, rotors)


def _turned(turns: Sequence[Array], body: int, placement: Array) -> Pose:
    """A placement on a body, seen from the body's turned frame."""
    return pose_of(placement if body == WORLD else turns[body].T @ placement)


def _armatures(mechanism: Mechanism, places: Any, nv: int, armature: Mapping[str, Scalar]) -> tuple[Scalar, ...]:
    """One armature for each speed; a follower's rotor is felt through its multiplier."""
    felt: list[Scalar] = [0] * nv
    for body in mechanism.bodies:
        if body.joint.name in armature:
            mimic = body.joint.mimic if mechanism.coupled else None
            gain = mimic.multiplier**2 if mimic else 1
            v = places[body.joint.name][1].start
            felt[v] = felt[v] + gain * armature[body.joint.name]
    return tuple(felt)


def _turn_to_z(body: Body) -> Array:
    """Rotation (4, 4) whose z axis is the joint's axis; exact where the axis is one of x, y, z."""
    turn = np.eye(4)
    if body.joint.kind == "floating":
        return turn
    z = np.asarray(body.joint.axis, float)
    k = int(np.argmax(np.abs(z)))
    x = np.zeros(3)
    x[(k + 1) % 3] = 1.0
    if np.count_nonzero(z) > 1:
        x = x - z * (z @ x)
        x = x / np.linalg.norm(x)
    turn[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    return turn


def _inertia_of(body: Body, turn: Array) -> Inertia:
    """The body's inertia about its frame's origin, along the turned axes.  Xia (2019) eq. (60)."""
    R = turn[:3, :3]
    com = R.T @ body.com
    tensor = R.T @ body.inertia @ R + body.mass * (com @ com * np.eye(3) - np.outer(com, com))
    return Inertia(number(body.mass), vec3(body.mass * com), mat3((tensor + tensor.T) / 2))


def number(x: float) -> Scalar:
    """A float, or a whole number where it is 0, 1 or -1, so that it vanishes when traced and stays exact."""
    return int(x) if x in (-1.0, 0.0, 1.0) else float(x)


def vec3(v: Array) -> Vec3:
    return Vec3(*(number(x) for x in v))


def mat3(A: Array) -> Mat3:
    return Mat3(*(vec3(row) for row in A))


def pose_of(matrix: Array) -> Pose:
    """A (4, 4) pose as scalars."""
    return Pose(mat3(matrix[:3, :3]), vec3(matrix[:3, 3]))

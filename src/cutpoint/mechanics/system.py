"""A robot in the form that the recursions take: every joint along its own z axis, every number a scalar.

`assembly.system_of` makes it, so that no recursion deals with other axes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from cutpoint.mechanics.bodies.joints import JointMotion
from cutpoint.mechanics.bodies.rotors import Spin
from cutpoint.mechanics.bodies.spatial import ZERO, Inertia, Mat3, Motion, Pose, Vec3
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar, is_plain_zero


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
    to_user_axes: this frame, along the joint's axis, in the body's frame as the user knows it.
    """

    name: str
    parent: int
    placement: Pose
    joint: JointMotion
    inertia: Inertia
    q: slice
    v: slice
    to_user_axes: Mat3
    follower: Follower | None = None

    @property
    def gain(self) -> Scalar:
        """Ratio of its own speeds to the robot's: 1 unless it follows a leader."""
        return self.follower.multiplier if self.follower else 1

    def coordinates(self, q: Sequence[Scalar]) -> list[Scalar]:
        """Its own coordinates, from the robot's."""
        own = [*q[self.q]]
        return [self.follower.multiplier * own[0] + self.follower.offset] if self.follower else own

    def speeds(self, v: Sequence[Scalar]) -> list[Scalar]:
        """Its own speeds (or accelerations), from the robot's."""
        own = [*v[self.v]]
        return [self.follower.multiplier * own[0]] if self.follower else own

    def pose(self, q: Sequence[Scalar]) -> Pose:
        """Its frame in its parent's.  Xia (2019) eqs. (33)-(36)."""
        return self.placement @ self.joint.pose(self.coordinates(q))

    @property
    def turns_about_parent_axis(self) -> bool:
        """Whether it turns about one axis of its parent's frame, apart from a displacement."""
        return self.joint.turns_about_z and sum(map(is_plain_zero, self.placement.rotation.T.rows[2])) == 2

    def motion(self, v: Sequence[Scalar]) -> Motion:
        """Its joint's own velocity z v, or acceleration, from the robot's speeds or accelerations.

        Xia (2019) eqs. (29)-(31).
        """
        return self.joint.motion(self.speeds(v))

    def columns(self) -> Iterator[tuple[int, Motion]]:
        """Its joint's motion per unit of each of the robot's speeds that drive it, with that speed's index."""
        axes = range(len(self.joint.axes))
        for k in axes:
            yield self.v.start + k, self.joint.motion([self.gain * int(j == k) for j in axes])

    def in_own_axes(self, V: Motion) -> Motion:
        """A motion of this frame in the axes of the body as the user knows it."""
        return Motion(self.to_user_axes @ V.linear, self.to_user_axes @ V.angular)


@dataclass(frozen=True)
class Place:
    """A frame fixed to a body (or the world)."""

    body: int
    pose: Pose


@dataclass(frozen=True)
class System:
    """Segments, parents before children; gravity in the world's frame, m/s2; frames by name.

    armature: inertia of rigidly geared rotors, one for each speed, kg m2 (kg) at the joint; 0 where there is none.
    spins: rotors with full coupling.  length: the unit of all lengths, m; see `units`.
    """

    segments: tuple[Segment, ...]
    gravity: Vec3
    frames: Mapping[str, Place]
    nq: int
    nv: int
    armature: tuple[Scalar, ...]
    spins: tuple[Spin, ...] = ()
    length: Scalar = 1

    @property
    def base_acceleration(self) -> Motion:
        """Gravity as an upward acceleration of the world, which gives every body its weight.  Xia (2019) eq. (62)."""
        return Motion(-self.gravity, ZERO)

    @property
    def has_followers(self) -> bool:
        """Whether some coordinate drives several joints."""
        return any(s.follower for s in self.segments)

    @cached_property
    def has_sprung_rotors(self) -> bool:
        """Whether some rotor behind a spring feels its carrier: full coupling."""
        return any(spin.elastic for spin in self.spins)

    @property
    def depths(self) -> list[int]:
        """For each body, the number of speeds that move it, its own joint's included."""
        depths: list[int] = []
        for body in self.segments:
            depths.append(len(body.joint.axes) + (0 if body.parent == WORLD else depths[body.parent]))
        return depths

    def chain_to(self, body: int) -> list[int]:
        """Indices of the bodies from the world outward to this one."""
        chain = []
        while body != WORLD:
            chain.append(body)
            body = self.segments[body].parent
        return chain[::-1]


@dataclass(frozen=True)
class Driven:
    """A drive, and the indices of the segment, coordinate and speed that it drives."""

    drive: Drive
    segment: int
    q: int
    v: int

"""Joint kinds.  Each says along which axes of its own frame it is free, and which pose its coordinates give.

Axes are columns z of a motion, linear then angular, in the moved frame, so that a joint's velocity is z v and its
torque under a wrench is z^T F.  Their entries are mostly 0 and 1 and vanish when traced.  Every kind offers what
`JointMotion` declares, in its order.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from cutpoint.mechanics.bodies.rotations import (
    exponential,
    logarithm,
    product,
    quaternion_rates,
    rotation_of,
    turned_back,
    with_unit_length,
)
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.bodies.turning import about_z, turned
from cutpoint.scalars import Scalar, is_plain_zero

Scalars = Sequence[Scalar]
Axis = tuple[Scalar, ...]

X, Y, Z, TURN_X, TURN_Y, TURN_Z = (tuple(int(j == k) for j in range(6)) for k in range(6))


@dataclass(frozen=True)
class JointMotion:
    """How a kind of joint moves; the defaults are for coordinates that are integrals of the speeds."""

    coordinates: ClassVar[int] = 1
    fixed_axes: ClassVar[tuple[Axis, ...]] = ()

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The columns z, one per speed."""
        return self.fixed_axes

    @property
    def turns_about_z(self) -> bool:
        """Whether the joint only turns about z."""
        return [axis[3:] for axis in self.axes if any(axis[3:])] == [TURN_Z[3:]]

    @property
    def neutral(self) -> list[float]:
        """Coordinates of the unmoved frame."""
        return [0.0] * self.coordinates

    def pose(self, q: Scalars) -> Pose:
        """The moved frame in the unmoved one."""
        raise TypeError(f"{type(self).__name__} must say which pose its coordinates give")

    def rates(self, q: Scalars, v: Scalars) -> list[Scalar]:
        """Time derivatives of the coordinates, given the speeds."""
        return [*v]

    def integrated(self, q: Scalars, step: Scalars) -> list[Scalar]:
        """Coordinates after moving from q for a unit of time with constant speeds `step`, in the moving frame."""
        return [x + dx for x, dx in zip(q, step, strict=True)]

    def of_unit_length(self, q: Scalars) -> list[Scalar]:
        """The same pose with quaternions normalised: integration changes their length."""
        return [*q]

    def difference(self, q: Scalars, other: Scalars) -> list[Scalar]:
        """The step that leads from q to the other coordinates: the inverse of `integrated`."""
        return [y - x for x, y in zip(q, other, strict=True)]

    def motion(self, v: Scalars) -> Motion:
        """z v: the joint's own motion, in the moved frame.  Xia (2019) eqs. (5), (29)."""
        six = [dot([axis[k] for axis in self.axes], v) for k in range(6)]
        return Motion(Vec3(*six[:3]), Vec3(*six[3:]))

    def effort(self, F: Wrench) -> list[Scalar]:
        """z^T F: the joint torque under a wrench.  Xia (2019) eq. (21)."""
        return [dot(axis, [*F]) for axis in self.axes]


@dataclass(frozen=True)
class Revolute(JointMotion):
    """Turns about z by q (rad).  Xia (2019) eqs. (34)-(36)."""

    fixed_axes = (TURN_Z,)

    def pose(self, q: Scalars) -> Pose:
        return Pose(about_z(q[0]), ZERO)


@dataclass(frozen=True)
class Prismatic(JointMotion):
    """Slides along z by q (m)."""

    fixed_axes = (Z,)

    def pose(self, q: Scalars) -> Pose:
        return Pose(IDENTITY, Vec3(0, 0, q[0]))


@dataclass(frozen=True)
class Helical(JointMotion):
    """Turns about z by q (rad), and slides along it by pitch q; pitch in m/rad."""

    pitch: Scalar

    @property
    def axes(self) -> tuple[Axis, ...]:
        return ((0, 0, self.pitch, 0, 0, 1),)

    def pose(self, q: Scalars) -> Pose:
        return Pose(about_z(q[0]), Vec3(0, 0, self.pitch * q[0]))


@dataclass(frozen=True)
class Planar(JointMotion):
    """Moves in the x-y plane and turns about z: q = (x, y, angle) in the unmoved frame, v in the moved one."""

    coordinates = 3
    fixed_axes = (X, Y, TURN_Z)

    def pose(self, q: Scalars) -> Pose:
        return Pose(about_z(q[2]), Vec3(q[0], q[1], 0))

    def rates(self, q: Scalars, v: Scalars) -> list[Scalar]:
        return [*turned(q[2], v[0], v[1]), v[2]]

    def integrated(self, q: Scalars, step: Scalars) -> list[Scalar]:
        turn = Vec3(0, 0, step[2])
        moved = exponential(turn).shift(Vec3(step[0], step[1], 0))
        x, y = turned(q[2], moved.x, moved.y)
        return [q[0] + x, q[1] + y, q[2] + step[2]]

    def difference(self, q: Scalars, other: Scalars) -> list[Scalar]:
        x, y = turned(-q[2], other[0] - q[0], other[1] - q[1])
        angle = other[2] - q[2]
        step = exponential(Vec3(0, 0, angle)).unshift(Vec3(x, y, 0))
        return [step.x, step.y, angle]


@dataclass(frozen=True)
class Spherical(JointMotion):
    """Turns about a point: q is a quaternion (x, y, z, w), v the angular velocity in the moved frame."""

    coordinates = 4
    fixed_axes = (TURN_X, TURN_Y, TURN_Z)

    @property
    def neutral(self) -> list[float]:
        return [0.0, 0.0, 0.0, 1.0]

    def pose(self, q: Scalars) -> Pose:
        return Pose(rotation_of(q), ZERO)

    def rates(self, q: Scalars, v: Scalars) -> list[Scalar]:
        return quaternion_rates(q, Vec3(*v))

    def integrated(self, q: Scalars, step: Scalars) -> list[Scalar]:
        return with_unit_length(product(q, exponential(Vec3(*step)).quaternion))

    def of_unit_length(self, q: Scalars) -> list[Scalar]:
        return with_unit_length(q)

    def difference(self, q: Scalars, other: Scalars) -> list[Scalar]:
        return [*logarithm(product(turned_back(q), other))]


@dataclass(frozen=True)
class Floating(JointMotion):
    """Free: q is a position (m) and a quaternion (x, y, z, w), v the velocity in the moved frame."""

    coordinates = 7
    fixed_axes = (X, Y, Z, TURN_X, TURN_Y, TURN_Z)

    @property
    def neutral(self) -> list[float]:
        return [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]

    def pose(self, q: Scalars) -> Pose:
        return Pose(rotation_of(q[3:]), Vec3(*q[:3]))

    def rates(self, q: Scalars, v: Scalars) -> list[Scalar]:
        return [*(rotation_of(q[3:]) @ Vec3(*v[:3])), *quaternion_rates(q[3:], Vec3(*v[3:]))]

    def integrated(self, q: Scalars, step: Scalars) -> list[Scalar]:
        turn = exponential(Vec3(*step[3:]))
        moved = rotation_of(q[3:]) @ turn.shift(Vec3(*step[:3]))
        return [*(Vec3(*q[:3]) + moved), *with_unit_length(product(q[3:], turn.quaternion))]

    def of_unit_length(self, q: Scalars) -> list[Scalar]:
        return [*q[:3], *with_unit_length(q[3:])]

    def difference(self, q: Scalars, other: Scalars) -> list[Scalar]:
        omega = logarithm(product(turned_back(q[3:]), other[3:]))
        moved = rotation_of(q[3:]).T @ (Vec3(*other[:3]) - Vec3(*q[:3]))
        return [*exponential(omega).unshift(moved), *omega]


def dot(a: Scalars, b: Scalars) -> Scalar:
    """Sum of products; terms with a plain 0 factor are dropped, whatever the other factor is."""
    terms = [x * y for x, y in zip(a, b, strict=True) if not is_plain_zero(x)]
    return sum(terms[1:], terms[0]) if terms else 0

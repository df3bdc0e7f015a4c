"""Joint kinds.  Each names the axes of its own frame along which it is free, and the pose that its coordinates give.

Axes are numbered x y z (linear), then x y z (angular), so that a joint's motion and effort are picks of a six-vector:
there is no motion-subspace matrix, and articulated elimination needs no linear solve.
Every kind offers the same names in the same order: free, coordinates, pose, rates, motion, effort.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from cutpoint.mechanics.spatial import IDENTITY, ZERO, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.scalars import Scalar, cos, sin


@dataclass(frozen=True)
class JointKind:
    """What every kind offers."""

    free: ClassVar[tuple[int, ...]]
    coordinates: ClassVar[int] = 1

    def pose(self, q: Sequence[Scalar]) -> Pose:
        """The moved frame in the unmoved one."""
        raise TypeError(f"{type(self).__name__} must say which pose its coordinates give")

    def rates(self, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        """Time derivatives of the coordinates, given the speeds."""
        return [*v]

    def motion(self, v: Sequence[Scalar]) -> Motion:
        """z v: the joint's own motion, in the moved frame."""
        six: list[Scalar] = [0] * 6
        for axis, rate in zip(self.free, v, strict=True):
            six[axis] = rate
        return Motion(Vec3(*six[:3]), Vec3(*six[3:]))

    def effort(self, F: Wrench) -> list[Scalar]:
        """z^T F: what of a wrench the joint itself must bear."""
        six = [*F]
        return [six[axis] for axis in self.free]


@dataclass(frozen=True)
class Revolute(JointKind):
    """Turns about z by q (rad).  Xia (2019) eqs. (34)-(36)."""

    free = (5,)

    def pose(self, q: Sequence[Scalar]) -> Pose:
        s, c = sin(q[0]), cos(q[0])
        return Pose(Mat3(Vec3(c, -s, 0), Vec3(s, c, 0), Vec3(0, 0, 1)), ZERO)


@dataclass(frozen=True)
class Prismatic(JointKind):
    """Slides along z by q (m)."""

    free = (2,)

    def pose(self, q: Sequence[Scalar]) -> Pose:
        return Pose(IDENTITY, Vec3(0, 0, q[0]))


@dataclass(frozen=True)
class Floating(JointKind):
    """Free: q is a position (m) and a quaternion (x, y, z, w), v the velocity in the moved frame."""

    free = (0, 1, 2, 3, 4, 5)
    coordinates = 7

    def pose(self, q: Sequence[Scalar]) -> Pose:
        return Pose(rotation_of(q[3:]), Vec3(*q[:3]))

    def rates(self, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        return [*(rotation_of(q[3:]) @ Vec3(*v[:3])), *quaternion_rates(q[3:], Vec3(*v[3:]))]


def rotation_of(quaternion: Sequence[Scalar]) -> Mat3:
    """Rotation of a quaternion (x, y, z, w) of any length but zero: dividing by its square needs no square root."""
    x, y, z, w = quaternion
    k = 2 / (x * x + y * y + z * z + w * w)
    xx, yy, zz = k * (x * x), k * (y * y), k * (z * z)
    xy, xz, yz = k * (x * y), k * (x * z), k * (y * z)
    wx, wy, wz = k * (w * x), k * (w * y), k * (w * z)
    return Mat3(
        Vec3(1 - yy - zz, xy - wz, xz + wy),
        Vec3(xy + wz, 1 - xx - zz, yz - wx),
        Vec3(xz - wy, yz + wx, 1 - xx - yy),
    )


def quaternion_rates(quaternion: Sequence[Scalar], omega: Vec3) -> list[Scalar]:
    """Time derivative of a quaternion (x, y, z, w), omega being the angular velocity in the turned frame."""
    x, y, z, w = quaternion
    turned = Vec3(x, y, z).cross(omega) + omega * w
    return [turned.x / 2, turned.y / 2, turned.z / 2, -Vec3(x, y, z).dot(omega) / 2]

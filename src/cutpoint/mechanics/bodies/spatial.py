"""Spatial algebra in body frames: motions, wrenches, poses, inertias.  Xia (2019) eqs. (32)-(33) and appendix.

Linear part first.  A pose of a child frame in its parent takes a motion outward (parent to child) and a wrench inward.
Only a product of a wrench with a motion, power, joins the two.  Components are scalars of any kind.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Union, overload

from cutpoint.scalars import Scalar, rate_of


class Vec3:
    """Three scalars along the axes of a frame."""

    __slots__ = ("x", "y", "z")
    __array_ufunc__ = None  # so that array * Vec3 calls __rmul__

    def __init__(self, x: Scalar, y: Scalar, z: Scalar) -> None:
        self.x, self.y, self.z = x, y, z

    def __add__(self, b: "Vec3") -> "Vec3": return Vec3(self.x + b.x, self.y + b.y, self.z + b.z)
    def __sub__(self, b: "Vec3") -> "Vec3": return Vec3(self.x - b.x, self.y - b.y, self.z - b.z)
    def __neg__(self) -> "Vec3": return Vec3(-self.x, -self.y, -self.z)
    def __mul__(self, s: Scalar) -> "Vec3": return Vec3(self.x * s, self.y * s, self.z * s)
    __rmul__ = __mul__
    def __iter__(self) -> Iterator[Any]: return iter((self.x, self.y, self.z))
    def dot(self, b: "Vec3") -> Scalar: return self.x * b.x + self.y * b.y + self.z * b.z

    def cross(self, b: "Vec3") -> "Vec3":
        """(self x) b.  Xia (2019) eq. (63)."""
        return Vec3(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)

    def rate(self) -> "Vec3":
        """Time derivatives of jets, one order shorter."""
        return Vec3(rate_of(self.x), rate_of(self.y), rate_of(self.z))

    def skew(self) -> "Mat3":
        """The matrix (self x).  Xia (2019) eq. (63)."""
        return Mat3(Vec3(0, -self.z, self.y), Vec3(self.z, 0, -self.x), Vec3(-self.y, self.x, 0))


ZERO = Vec3(0, 0, 0)


class Mat3:
    """A 3 x 3 matrix as three rows."""

    __slots__ = ("rows",)

    def __init__(self, *rows: Vec3) -> None:
        self.rows = rows

    def __add__(self, B: "Mat3") -> "Mat3": return Mat3(*(a + b for a, b in zip(self.rows, B.rows, strict=True)))
    def __sub__(self, B: "Mat3") -> "Mat3": return Mat3(*(a - b for a, b in zip(self.rows, B.rows, strict=True)))
    def __mul__(self, s: Scalar) -> "Mat3": return Mat3(*(a * s for a in self.rows))
    def __iter__(self) -> Iterator[Vec3]: return iter(self.rows)

    @property
    def T(self) -> "Mat3": return Mat3(*(Vec3(*column) for column in zip(*self.rows, strict=True)))

    @overload
    def __matmul__(self, b: Vec3) -> Vec3: ...
    @overload
    def __matmul__(self, b: "Mat3") -> "Mat3": ...
    def __matmul__(self, b: Union[Vec3, "Mat3"]) -> Union[Vec3, "Mat3"]:
        if isinstance(b, Mat3):
            columns = b.T.rows
            return Mat3(*(Vec3(*(row.dot(c) for c in columns)) for row in self.rows))
        return Vec3(*(row.dot(b) for row in self.rows))

    def congruence(self, S: "Mat3") -> "Mat3":
        """R S R^T: the tensor S of the turned frame, expressed in the unturned frame."""
        return self @ S @ self.T


NO_GRADIENT = Mat3(ZERO, ZERO, ZERO)
IDENTITY = Mat3(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1))


@dataclass(slots=True, eq=False)
class Motion:
    """Velocity of a frame, (m/s, rad/s), or its component-wise derivative, in the frame's axes: V = [v; omega]."""

    linear: Vec3
    angular: Vec3

    def __add__(self, W: "Motion") -> "Motion": return Motion(self.linear + W.linear, self.angular + W.angular)
    def __sub__(self, W: "Motion") -> "Motion": return Motion(self.linear - W.linear, self.angular - W.angular)
    def __mul__(self, s: Scalar) -> "Motion": return Motion(self.linear * s, self.angular * s)
    def __iter__(self) -> Iterator[Any]: return iter((*self.linear, *self.angular))

    def cross(self, W: "Motion") -> "Motion":
        """Rate of the motion W carried by this one.  Featherstone (2008) eq. (2.31)."""
        angular = self.angular.cross(W.angular)
        return Motion(self.angular.cross(W.linear) + self.linear.cross(W.angular), angular)

    def cross_wrench(self, F: "Wrench") -> "Wrench":
        """Rate of the wrench (or momentum) F carried by this motion.  Featherstone (2008) eq. (2.32)."""
        moment = self.angular.cross(F.moment) + self.linear.cross(F.force)
        return Wrench(self.angular.cross(F.force), moment)

    def seen_from_parent(self, X: "Pose") -> "Motion":
        """The child's motion in the parent frame: that of the point at its origin, along its axes, U^-T V."""
        angular = X.rotation @ self.angular
        return Motion(X.rotation @ self.linear + X.position.cross(angular), angular)

    def power(self, F: "Wrench") -> Scalar:
        """Power of a wrench on a body with this motion, W."""
        return self.linear.dot(F.force) + self.angular.dot(F.moment)


@dataclass(slots=True, eq=False)
class Wrench:
    """Force and moment at a frame's origin, (N, N m), or momentum, in the frame's axes: F = [f; m]."""

    force: Vec3
    moment: Vec3

    def __add__(self, G: "Wrench") -> "Wrench": return Wrench(self.force + G.force, self.moment + G.moment)
    def __sub__(self, G: "Wrench") -> "Wrench": return Wrench(self.force - G.force, self.moment - G.moment)
    def __iter__(self) -> Iterator[Any]: return iter((*self.force, *self.moment))


STILL = Motion(ZERO, ZERO)
NO_WRENCH = Wrench(ZERO, ZERO)


@dataclass(slots=True, eq=False)
class Pose:
    """Where a child frame is in its parent: takes child coordinates to parent coordinates.  Xia (2019) eq. (33)."""

    rotation: Mat3
    position: Vec3

    def __matmul__(self, Y: "Pose") -> "Pose":
        return Pose(self.rotation @ Y.rotation, self.position + self.rotation @ Y.position)

    def outward(self, V: Motion) -> Motion:
        """The parent's motion in the child frame, U^T V.  Xia (2019) eqs. (30), (32)."""
        R_T = self.rotation.T
        return Motion(R_T @ (V.linear + V.angular.cross(self.position)), R_T @ V.angular)

    def inward(self, F: Wrench) -> Wrench:
        """The child's wrench in the parent frame, U F.  Xia (2019) eqs. (32), (45)."""
        force = self.rotation @ F.force
        return Wrench(force, self.rotation @ F.moment + self.position.cross(force))


AT_ORIGIN = Pose(IDENTITY, ZERO)


@dataclass(slots=True, eq=False)
class Inertia:
    """Mass (kg), first moment mass * com (kg m), rotational inertia about the frame's origin (kg m2), in its axes."""

    mass: Scalar
    first_moment: Vec3
    rotational: Mat3

    def __add__(self, other: "Inertia") -> "Inertia":
        first_moment = self.first_moment + other.first_moment
        return Inertia(self.mass + other.mass, first_moment, self.rotational + other.rotational)

    def __mul__(self, V: Motion) -> Wrench:
        """M V: momentum of a body moving with V.  Xia (2019) eq. (60)."""
        momentum = V.linear * self.mass + V.angular.cross(self.first_moment)
        return Wrench(momentum, self.rotational @ V.angular + self.first_moment.cross(V.linear))

    @property
    def second_moment(self) -> Mat3:
        """The sum of r r^T dm over the body, kg m2: half the trace of the rotational inertia, less that inertia."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.rotational
        return Mat3(
            Vec3((yy + zz - xx) / 2, -xy, -xz), Vec3(-xy, (xx + zz - yy) / 2, -yz), Vec3(-xz, -yz, (xx + yy - zz) / 2)
        )

    def seen_from_parent(self, X: Pose) -> "Inertia":
        """The same body, described in the parent frame: U M U^T."""
        R, p = X.rotation, X.position
        h = R @ self.first_moment
        h_parent = h + p * self.mass
        shift = p.skew() @ h.skew() + h_parent.skew() @ p.skew()
        return Inertia(self.mass, h_parent, R.congruence(self.rotational) - shift)

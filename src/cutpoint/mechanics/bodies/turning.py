"""Turns about z, by angles that may be time jets.

A turn in time is R_0 E: the turn so far, and the turn from now on, which begins as the identity.  The derivatives of
E a are those of a plus the terms due to its frame's spin, Featherstone (2008) section 2.10, so they take no sine and
fewer products than derivatives of R's numbers would.
"""

from typing import Any, overload

from cutpoint.mechanics.bodies.spatial import IDENTITY, Mat3, Vec3
from cutpoint.scalars import Jet, Scalar, cos, sin


def about_z(angle: Scalar) -> Mat3:
    """R, which takes coordinates of the turned frame to those of the unturned."""
    if isinstance(angle, Jet):
        return RotationProduct(_about_z(angle.derivative(0)), RotationFromNow(angle.rate()))
    return _about_z(angle)


def turned(angle: Scalar, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
    """A vector of the plane, turned."""
    s, c = sin(angle), cos(angle)
    return c * x - s * y, s * x + c * y


class RotationAboutZ(Mat3):
    """outer @ R_z, using the fact that a turn leaves half of a tensor's part in its plane unchanged.

    The isotropic and the skew part do not change; the rest turns by twice the angle, as on Mohr's circle.
    """

    __slots__ = ("c", "outer", "s")

    def __init__(self, outer: Mat3, c: Scalar, s: Scalar) -> None:
        super().__init__(*(outer @ Mat3(Vec3(c, -s, 0), Vec3(s, c, 0), Vec3(0, 0, 1))))
        self.outer, self.c, self.s = outer, c, s

    def __rmatmul__(self, a: Mat3) -> Mat3: return RotationAboutZ(a @ self.outer, self.c, self.s)

    def congruence(self, S: Mat3) -> Mat3:
        """R S R^T, in half as many operations as two products take in the plane."""
        c, s = self.c, self.s
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = S
        w = s * (xx - yy) + c * (xy + yx)
        x = Vec3(xx - s * w, c * w - yx, c * xz - s * yz)
        y = Vec3(c * w - xy, yy + s * w, s * xz + c * yz)
        return self.outer.congruence(Mat3(x, y, Vec3(c * zx - s * zy, s * zx + c * zy, zz)))


class RotationProduct(Mat3):
    """outer @ inner, applied to a vector one after the other."""

    __slots__ = ("inner", "outer")

    def __init__(self, outer: Mat3, inner: Mat3) -> None:
        self.outer, self.inner = outer, inner

    @property
    def rows(self) -> tuple[Vec3, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]: made when asked for
        return (Mat3(*self.outer.rows) @ Mat3(*self.inner.rows)).rows

    @property
    def T(self) -> "RotationProduct": return RotationProduct(self.inner.T, self.outer.T)

    @overload
    def __matmul__(self, b: Vec3) -> Vec3: ...
    @overload
    def __matmul__(self, b: Mat3) -> Mat3: ...
    def __matmul__(self, b: Any) -> Any: return self.outer @ (self.inner @ b)
    def __rmatmul__(self, a: Mat3) -> Mat3: return RotationProduct(a @ self.outer, self.inner)


class RotationFromNow(Mat3):
    """E: the turn of a frame about z from now on, with this spin (rad/s)."""

    __slots__ = ("spin",)

    def __init__(self, spin: Jet) -> None:
        self.spin = spin

    @property
    def rows(self) -> tuple[Vec3, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]: made when asked for
        return _about_z(Jet(0, *self.spin.derivatives)).rows

    @property
    def T(self) -> "RotationFromNow": return RotationFromNow(-self.spin)

    @overload
    def __matmul__(self, b: Vec3) -> Vec3: ...
    @overload
    def __matmul__(self, b: Mat3) -> Mat3: ...
    def __matmul__(self, b: Any) -> Any:
        return Vec3(*self._carried(b.x, b.y), b.z) if isinstance(b, Vec3) else Mat3(*self.rows) @ b

    def _carried(self, *plane: Scalar) -> tuple[Jet, Jet]:
        """Each derivative is the one before, differentiated and turned on: (d/dt + spin z x) of it."""
        still = [0] * len(self.spin.derivatives)
        x, y = (a if isinstance(a, Jet) else Jet(a, *still) for a in plane)
        found = [(x.derivative(0), y.derivative(0))]
        for _ in range(min(len(still), len(x.derivatives) - 1, len(y.derivatives) - 1)):
            x, y = x.rate() - self.spin * y, y.rate() + self.spin * x
            found.append((x.derivative(0), y.derivative(0)))
        xs, ys = zip(*found, strict=True)
        return Jet(*xs), Jet(*ys)


def _about_z(angle: Scalar) -> Mat3:
    return RotationAboutZ(IDENTITY, cos(angle), sin(angle))

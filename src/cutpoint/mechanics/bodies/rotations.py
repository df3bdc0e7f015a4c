"""Quaternions (x, y, z, w), and the exponential that turns a rotation step and its velocity into a finite motion.

Sola, Deray and Atchuthan (2018), "A micro Lie theory", eqs. (101)-(105), (143)-(147), (174)-(180).
"""

from collections.abc import Sequence
from dataclasses import dataclass

from cutpoint.mechanics.bodies.spatial import Mat3, Vec3
from cutpoint.scalars import Scalar, atan, cos, sin, sqrt, where

Scalars = Sequence[Scalar]

_SMALL = 1e-4
"""Angle (rad) below which series take over: what they leave out is below 2e-17."""


def rotation_of(quaternion: Scalars) -> Mat3:
    """Rotation of a quaternion of any length but zero: dividing by its square needs no square root."""
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


def quaternion_rates(quaternion: Scalars, omega: Vec3) -> list[Scalar]:
    """Time derivative of a quaternion, omega being the angular velocity in the turned frame: half their product."""
    x, y, z, w = product(quaternion, [*omega, 0])
    return [x / 2, y / 2, z / 2, w / 2]


def product(p: Scalars, q: Scalars) -> list[Scalar]:
    """The turn q after the turn p, in frames that move along."""
    a, b = Vec3(*p[:3]), Vec3(*q[:3])
    vector = b * p[3] + a * q[3] + a.cross(b)
    return [*vector, p[3] * q[3] - a.dot(b)]


def turned_back(q: Scalars) -> list[Scalar]:
    """The inverse turn."""
    return [-q[0], -q[1], -q[2], q[3]]


def with_unit_length(q: Scalars) -> list[Scalar]:
    gain = 1 / sqrt(sum((x * x for x in q[1:]), q[0] * q[0]))
    return [gain * x for x in q]


@dataclass(frozen=True)
class Exponential:
    """A finite turn: its quaternion, and how a velocity held meanwhile shifts the origin.

    omega: rad.  a, b: of (omega x) and its square in the map from velocity to shift, 1 + a (omega x) + b (omega x)^2.
    c: of the square in its inverse, 1 - (omega x) / 2 + c (omega x)^2.
    """

    quaternion: list[Scalar]
    omega: Vec3
    a: Scalar
    b: Scalar
    c: Scalar

    def shift(self, v: Vec3) -> Vec3:
        """Displacement in the first frame when the origin's velocity is v, in the turning one."""
        once = self.omega.cross(v)
        return v + once * self.a + self.omega.cross(once) * self.b

    def unshift(self, p: Vec3) -> Vec3:
        """The velocity that shifts by p: the inverse of `shift`."""
        once = self.omega.cross(p)
        return p - once * (1 / 2) + self.omega.cross(once) * self.c


def exponential(omega: Vec3) -> Exponential:
    """Turning for a unit of time with angular velocity omega, in the turning frame."""
    square = omega.dot(omega)
    tiny = square < _SMALL * _SMALL
    n2 = where(tiny, 1, square)
    n = sqrt(n2)
    s, half = sin(n), n / 2
    half_sine, half_cosine = sin(half), cos(half)
    along = where(tiny, 1 / 2 - square / 48, half_sine / n)
    a = where(tiny, 1 / 2 - square / 24, 2 * half_sine * half_sine / n2)
    b = where(tiny, 1 / 6 - square / 120, (n - s) / (n2 * n))
    # 1 / n^2 - (1 + cos n) / (2 n sin n), by half angles: free of its 0 / 0 at n = pi
    c = where(tiny, 1 / 12 + square / 720, (1 - half * half_cosine / half_sine) / n2)
    w = where(tiny, 1 - square / 8, half_cosine)
    return Exponential([*(omega * along), w], omega, a, b, c)


def logarithm(quaternion: Scalars) -> Vec3:
    """The angular velocity, at most pi, that turns by a quaternion in a unit of time."""
    x, y, z, w = with_unit_length(quaternion)
    nearer = where(w < 0, -1, 1)  # picks the shorter turn of q and -q
    vector, cosine = Vec3(x, y, z) * nearer, w * nearer
    square = vector.dot(vector)
    tiny = square < _SMALL * _SMALL
    sine = sqrt(where(tiny, 1, square))
    # the half angle by its tangent of the quarter: 2 atan(sin / (1 + cos)), good up to a half turn
    gain = where(tiny, 2 + square / 3, 4 * atan(sine / (1 + cosine)) / sine)
    return vector * gain

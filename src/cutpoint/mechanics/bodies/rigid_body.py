"""Net wrench of a rigid body's motion, and the same as a linear function of its ten inertial parameters.

A body is a cloud of mass: its point at r accelerates with a + U r, where a is the acceleration of the frame's origin
and U = (alpha x) + (omega x)(omega x) the gradient of acceleration.  Every sum over the cloud follows from that.
"""

from collections.abc import Sequence

from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Inertia, Mat3, Motion, Vec3, Wrench
from cutpoint.scalars import Scalar


def acceleration_gradient(alpha: Vec3, omega: Vec3, w: Vec3, zz: Scalar | None = None) -> Mat3:
    """U = (alpha x) + (omega x)(w x), w being the body's angular velocity omega, or its required one.

    zz: its last element, if it is known.
    """
    (x, y, z), (p, q, r), (a, b, c) = omega, w, alpha
    return Mat3(
        Vec3(-(y * q + z * r), p * y - c, p * z + b),
        Vec3(q * x + c, -(x * p + z * r), q * z - a),
        Vec3(r * x - b, r * y + a, -(x * p + y * q) if zz is None else zz),
    )


def gradient_beside(U_z: Vec3, alpha_z: Scalar, omega: Vec3) -> Mat3:
    """U from its last column and the angular acceleration about z: U + U^T is 2 (omega x)(omega x) in any case."""
    x, y, z = omega
    xy, twice_z = x * y, z + z
    return Mat3(
        Vec3(-(y * y + z * z), xy - alpha_z, U_z.x),
        Vec3(xy + alpha_z, -(x * x + z * z), U_z.y),
        Vec3(x * twice_z - U_z.x, y * twice_z - U_z.y, U_z.z),
    )


def net_wrench(M: Inertia, A: Motion, U: Mat3) -> Wrench:
    """F* = M V' + C(omega) V + G, in the body's frame.  Xia (2019) eqs. (6)-(8), (47), (59)-(62).

    A is the acceleration of the frame (of its origin, gravity included, and angular) and U its gradient.  The force is
    the sum of (a + U r) dm, the moment that of r x (a + U r) dm: (59)-(62) with A.linear for v' + omega x v + g.  With
    the U and A of a required motion it is M V_r' + C(omega) V_r + G of eqs. (15)-(17), (50), up to a multiple of
    (omega x) in C that neither C(omega) V nor the skew symmetry of C depends on.
    """
    h, B = M.first_moment, U @ M.second_moment
    (_, xy, xz), (yx, _, yz), (zx, zy, _) = B
    return Wrench(A.linear * M.mass + U @ h, h.cross(A.linear) + Vec3(zy - yz, xz - zx, yx - xy))


def kinetic_energy(M: Inertia, V: Motion) -> Scalar:
    """V^T M V / 2, J."""
    return V.power(M * V) / 2


def body_regressor(A: Motion, omega: Vec3, w: Vec3) -> list[Wrench]:
    """Ten wrenches Y_k with F* = sum of Y_k p_k.  Atkeson, An and Hollerbach (1986), on Xia (2019) eq. (59).

    omega is the body's angular velocity, w that of the motion which A belongs to: the same, or the required one.
    p = (m, h_x, h_y, h_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz): mass, first moment and rotational inertia about the
    frame's origin.  The moments are Euler's; where w differs they have the symmetric part of omega w^T and, beside
    alpha, the rest of it.
    """
    U, a, alpha = acceleration_gradient(A.angular, omega, w), A.linear, A.angular + omega.cross(w) * 0.5
    (x, y, z), (p, q, r) = omega, w
    xx, yy, zz = x * p, y * q, z * r
    xy, yz, zx = (x * q + y * p) * 0.5, (y * r + z * q) * 0.5, (z * p + x * r) * 0.5
    units, columns = IDENTITY.rows, U.T.rows
    moments = (
        Vec3(alpha.x, zx, -xy), Vec3(alpha.y - zx, alpha.x + yz, xx - yy), Vec3(alpha.z + xy, zz - xx, alpha.x - yz),
        Vec3(-yz, alpha.y, xy), Vec3(yy - zz, alpha.z - xy, alpha.y + zx), Vec3(yz, -zx, alpha.z),
    )  # fmt: skip
    of_first_moment = [Wrench(U_k, e.cross(a)) for U_k, e in zip(columns, units, strict=True)]
    return [Wrench(a, ZERO), *of_first_moment, *(Wrench(ZERO, moment) for moment in moments)]


def inertia_of(p: Sequence[Scalar]) -> Inertia:
    """The inertia with these ten parameters, in the order of `body_regressor`."""
    m, hx, hy, hz, xx, xy, xz, yy, yz, zz = p
    return Inertia(m, Vec3(hx, hy, hz), Mat3(Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)))


def parameters_of(M: Inertia) -> list[Scalar]:
    """The ten parameters of an inertia, in the order of `body_regressor`."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = M.rotational
    return [M.mass, *M.first_moment, xx, xy, xz, yy, yz, zz]

"""What a motion costs one rigid body, and the same as a linear function of its ten inertial parameters."""

from cutpoint.mechanics.spatial import Inertia, Mat3, Motion, Vec3, Wrench
from cutpoint.scalars import Scalar


def net_wrench(M: Inertia, omega: Vec3, V: Motion, A: Motion) -> Wrench:
    """F* = M A + C(omega) V + G, in the body's frame, gravity being part of A.  Xia (2019) eqs. (47), (59)-(62).

    omega is the body's angular velocity.  V and A are its velocity and that one's derivative, or the required ones of
    eqs. (15)-(17) and (50).  C(omega) is (61) but for the term m |r|^2 (omega x) of its last block, which neither
    C(omega) V for the body's own V nor the skew symmetry of C depends on.
    """
    h, I_o, w = M.first_moment, M.rotational, V.angular
    # the frame's origin: its acceleration, once the frame's own turning is counted
    a_o = A.linear + omega.cross(V.linear)
    force = a_o * M.mass + A.angular.cross(h) + omega.cross(w.cross(h))
    moment = h.cross(a_o) + I_o @ A.angular + omega.cross(I_o @ w) + I_o @ omega.cross(w)
    return Wrench(force, moment)


def kinetic_energy(M: Inertia, V: Motion) -> Scalar:
    """V^T M V / 2, J."""
    return V.power(M * V) / 2


def body_regressor(V: Motion, A: Motion) -> list[Wrench]:
    """Ten wrenches Y_k with F* = sum of Y_k p_k.  Atkeson, An and Hollerbach (1986), on Xia (2019) eq. (59).

    p = (m, h_x, h_y, h_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz): mass, first moment and rotational inertia about the
    frame's origin.
    """
    return [net_wrench(unit, V.angular, V, A) for unit in UNIT_INERTIAS]


def parameters(M: Inertia) -> list[Scalar]:
    """The ten inertial parameters of a body, in the order of `body_regressor`."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = M.rotational
    return [M.mass, *M.first_moment, xx, xy, xz, yy, yz, zz]


def inertia_of(p: list[Scalar]) -> Inertia:
    """The inertia with these ten parameters."""
    m, hx, hy, hz, xx, xy, xz, yy, yz, zz = p
    return Inertia(m, Vec3(hx, hy, hz), Mat3(Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)))


UNIT_INERTIAS = [inertia_of([int(j == k) for j in range(10)]) for k in range(10)]

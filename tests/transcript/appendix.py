"""The appendix, and the two transformations it leans on: eqs. (6)-(8), (32), (33), (47), (59)-(63)."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

z = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


def cross(q: Array) -> Array:
    """(63) Matrix of the cross product by a 3-vector.

    Corrected: q here is any 3-vector, not the joint position that bears the same letter elsewhere.
    """
    q1, q2, q3 = q
    return np.array([[0, -q3, q2], [q3, 0, -q1], [-q2, q1, 0]])


def U(T_B: Array) -> Array:
    """(32) Matrix that takes a force from frame B to frame T, given the pose (4, 4) of B in T.

    Its transpose takes a motion the other way.
    """
    R, p = T_B[:3, :3], T_B[:3, 3]
    return np.block([[R, np.zeros((3, 3))], [cross(p) @ R, R]])


def pose(R: Array, p: Array) -> Array:
    """(33) Pose (4, 4) of frame B in frame T from rotation (3, 3) and position (3,)."""
    return np.block([[R, p[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])


def M(m: float, r: Array, I: Array) -> Array:
    """(60) Inertia matrix (6, 6) of a body of mass m with its centroid at r.

    Corrected: I is taken about the centroid, along the axes of B; about the origin of B the term m (r x)^2 would
    count twice.
    """
    return np.block([[m * np.eye(3), -m * cross(r)], [m * cross(r), I - m * cross(r) @ cross(r)]])


def C(m: float, r: Array, I: Array, omega: Array) -> Array:
    """(61) Matrix (6, 6) of the terms quadratic in velocity.

    Corrected: the four stacked rows are a 2 x 2 block matrix, its left column first.
    """
    w, c = cross(omega), cross(r)
    return np.block([[m * w, -m * w @ c], [m * c @ w, w @ I + I @ w - m * c @ w @ c]])


def G(m: float, r: Array, R_BI: Array, g: Array) -> Array:
    """(62) Wrench that carries the body's weight.

    R_BI takes world coordinates to those of B.

    Corrected: g is minus the acceleration of free fall, (0, 0, +9.81); with gravity itself the sign would be wrong.
    """
    return np.concatenate([m * R_BI @ g, m * cross(r) @ R_BI @ g])


def net_wrench(m: float, r: Array, I: Array, R_BI: Array, g: Array, V: Array, V_dot: Array) -> Array:
    """(6), (7), (8), (47), (59) Net wrench of a rigid body: joint base, rotor, output link, or link i.

    V_dot is the component-wise derivative of V.
    """
    return M(m, r, I) @ V_dot + C(m, r, I, V[3:]) @ V + G(m, r, R_BI, g)


def motion_cross(V: Array) -> Array:
    """Matrix (6, 6) of the cross product of motions; not numbered, the derivative of (5) and (31) needs it."""
    return np.block([[cross(V[3:]), cross(V[:3])], [np.zeros((3, 3)), cross(V[3:])]])

"""Section III, the arm: eqs. (29)-(31), (34)-(46), (48), (49), (51)-(53).

Frame B_i moves with link i; T_i is fixed at the end of link i - 1; O is the end-effector.
"""

import numpy as np

from transcript.appendix import Array, z


def first_body_velocity(q_dot_1: float) -> Array:
    """(29), (48) Velocity of body 1, actual or required, on a base at rest."""
    return z * q_dot_1


def cut_velocity(U: Array, B_V: Array) -> Array:
    """(30) Velocity of frame T_i at the end of body i - 1.

    Corrected: i runs to 6.
    """
    return U.T @ B_V


def body_velocity(q_dot_i: float, U: Array, V: Array) -> Array:
    """(31), (49) Velocity of body i, actual or required, from that of T_i or of body i - 1, by the U between the two.

    Corrected: i runs to 6.
    """
    return z * q_dot_i + U.T @ V


def rotations_1_2(q_1: float, q_2: float) -> tuple[Array, Array]:
    """(34) Orientations of B_1 and B_2.

    Corrected: seen from T_1 and T_2, each along the axes of the body before, not from the world.
    """
    c1, s1, c2, s2 = np.cos(q_1), np.sin(q_1), np.cos(q_2), np.sin(q_2)
    return np.array([[c1, -s1, 0], [s1, c1, 0], [0, 0, 1]]), np.array([[c2, -s2, 0], [0, 0, -1], [s2, c2, 0]])


def rotations_3_4(q_3: float, q_4: float) -> tuple[Array, Array]:
    """(35) Orientations of B_3 and B_4.

    Corrected: seen from T_3 and T_4, each along the axes of the body before, not from the world.
    """
    c3, s3, c4, s4 = np.cos(q_3), np.sin(q_3), np.cos(q_4), np.sin(q_4)
    return np.array([[c3, -s3, 0], [s3, c3, 0], [0, 0, 1]]), np.array([[0, 0, 1], [-c4, s4, 0], [-s4, -c4, 0]])


def rotations_5_6(q_5: float, q_6: float) -> tuple[Array, Array]:
    """(36) Orientations of B_5 and B_6.

    Corrected: seen from T_5 and T_6, each along the axes of the body before, not from the world.
    """
    c5, s5, c6, s6 = np.cos(q_5), np.sin(q_5), np.cos(q_6), np.sin(q_6)
    return np.array([[c5, -s5, 0], [0, 0, -1], [s5, c5, 0]]), np.array([[c6, -s6, 0], [0, 0, 1], [-s6, -c6, 0]])


def end_effector_velocity(J_q: Array, q_dot: Array) -> Array:
    """(37) Velocity of the end-effector in its own frame.

    Corrected: the joint velocities form a column.
    """
    return J_q @ q_dot


def J_q(U_O: list[Array]) -> Array:
    """(38) Jacobian of the end-effector from the U between each body and O.

    Corrected: the six columns stand side by side; the printed 2 x 3 block and its outer transpose are not 6 x 6.
    """
    return np.column_stack([U.T @ z for U in U_O])


def joint_velocity(J_q: Array, V: Array) -> Array:
    """(39) Joint velocities from the velocity of the end-effector.

    Corrected: J_q has rank 4 at q = 0, where the trajectory (57) starts, so the inverse does not exist there.
    """
    return np.linalg.inv(J_q) @ V


def V_b(V_O: Array, V: list[Array]) -> Array:
    """(40) Generalised velocity (42,): end-effector, then the bodies."""
    return np.concatenate([V_O, *V])


def J_ba(J_q: Array, U: dict[tuple[int, int], Array]) -> Array:
    """(41) Matrix from joint velocities to the generalised velocity (40).

    U[k, i] takes forces from body i to body k.

    Corrected: it is 42 x 6, six rows for the end-effector and six for each body; 72 is a slip.
    """
    lower = [[U[k, i].T @ z if k < i else z * (k == i) for k in range(1, 7)] for i in range(1, 7)]
    return np.vstack([J_q, *(np.column_stack(row) for row in lower)])


def V_e(V_O: Array, q_dot: Array, V: list[Array]) -> Array:
    """(42) Whole generalised velocity (48,): end-effector, joints, bodies."""
    return np.concatenate([V_O, q_dot, *V])


def J_e(J_q: Array, J_ba: Array) -> Array:
    """(43) Extended Jacobian (48, 6) from the end-effector's velocity to (42).

    Corrected: like (39) it exists only where J_q has full rank.
    """
    J_a = np.linalg.inv(J_q)
    return np.vstack([np.eye(6), J_a, J_ba[6:] @ J_a])


def last_body_balance(B_F: Array, F_e: Array) -> Array:
    """(44) Net wrench of body 6 from the wrench at its joint and the contact wrench.

    Corrected: F_e is exerted by link 6 on the environment and given in B_6.
    """
    return B_F - F_e


def cut_wrench(U: Array, B_F: Array) -> Array:
    """(45), (52) Wrench at the cut T_i, actual or required, from the wrench on body i.

    Corrected: for i = 1 the frame T_1, which the text leaves out, is the world frame.
    """
    return U @ B_F


def body_balance(B_F: Array, U: Array, T_F: Array) -> Array:
    """(46) Net wrench of body i from the wrenches at its two cuts."""
    return B_F - U @ T_F


def required_last_wrench(B_F_star_r: Array, F_e: Array) -> Array:
    """(51) Required wrench on body 6.

    Corrected: F_ell is the F_e of (44): by link 6 on the environment, in B_6.
    """
    return B_F_star_r + F_e


def required_wrench(B_F_star_r: Array, U: Array, T_F_r: Array) -> Array:
    """(53) Required wrench on body i from its own need and that of the cut T_i+1."""
    return B_F_star_r + U @ T_F_r

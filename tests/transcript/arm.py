"""The six-joint arm as a whole, put together from the transcribed pieces.  Joints count from 1 as in the paper."""

from functools import reduce

import numpy as np

from transcript import data, joint, manipulator
from transcript.appendix import Array, U, motion_cross, net_wrench, pose, z


def link_poses(q: Array) -> list[Array]:
    """Pose (4, 4) of B_i in B_{i-1}, i = 1 ... 6, by (33)-(36); B_0 is the world."""
    rotations = (
        *manipulator.rotations_1_2(q[0], q[1]),
        *manipulator.rotations_3_4(q[2], q[3]),
        *manipulator.rotations_5_6(q[4], q[5]),
    )
    return [pose(R, p) for R, p in zip(rotations, data.TRANSLATIONS, strict=True)]


def pose_between(q: Array, k: int, i: int) -> Array:
    """Pose of B_i in B_k, 0 <= k <= i <= 7, where B_7 is the end-effector's frame O."""
    poses = [*link_poses(q), pose(np.eye(3), data.TOOL)]
    return reduce(np.matmul, poses[k:i], np.eye(4))


def body_velocities(q: Array, q_dot: Array) -> list[Array]:
    """Velocities of B_1 ... B_6, each in its own frame, eqs. (29)-(31); with required rates in, (48) and (49)."""
    V = [manipulator.first_body_velocity(q_dot[0])]
    for i in range(2, 7):
        R, p = pose_between(q, i - 1, i)[:3, :3], data.TRANSLATIONS[i - 1]
        T_V = manipulator.cut_velocity(U(pose(np.eye(3), p)), V[-1])
        V.append(manipulator.body_velocity(q_dot[i - 1], U(pose(R, np.zeros(3))), T_V))
    return V


def body_accelerations(q: Array, q_dot: Array, q_ddot: Array, along: Array | None = None) -> list[Array]:
    """Component-wise derivatives of the velocities that the rates `along` (q_dot unless given) cause.

    Derivative of (31): B_i turns at q_dot, so d(U^T)/dt V = -(z q_dot) x (U^T V).
    """
    rates = q_dot if along is None else along
    V = body_velocities(q, rates)
    V_dot = [z * q_ddot[0]]
    for i in range(2, 7):
        U_i = U(pose_between(q, i - 1, i))
        turning = motion_cross(z * q_dot[i - 1]) @ (U_i.T @ V[i - 2])
        V_dot.append(z * q_ddot[i - 1] + U_i.T @ V_dot[-1] - turning)
    return V_dot


def world_rotations(q: Array) -> list[Array]:
    """Rotation from world coordinates to those of B_i, i = 1 ... 6."""
    return [pose_between(q, 0, i)[:3, :3].T for i in range(1, 7)]


def net_wrenches(
    q: Array, q_dot: Array, q_ddot: Array, g: Array = data.G_UP, centroids: Array = data.CENTROIDS
) -> list[Array]:
    """Net wrenches of the six links, eq. (47)."""
    V, V_dot, R_BI = body_velocities(q, q_dot), body_accelerations(q, q_dot, q_ddot), world_rotations(q)
    return [
        net_wrench(data.MASSES[i], centroids[i], data.MOMENTS[i] * np.eye(3), R_BI[i], g, V[i], V_dot[i])
        for i in range(6)
    ]


def inward_wrenches(q: Array, F_star: list[Array], F_e: Array) -> list[Array]:
    """Wrenches at the joints on B_1 ... B_6 from the net wrenches, eqs. (44)-(46); required in, required out."""
    F = [manipulator.required_last_wrench(F_star[5], F_e)]
    for i in range(5, 0, -1):
        R, p = pose_between(q, i, i + 1)[:3, :3], data.TRANSLATIONS[i]
        T_F = manipulator.cut_wrench(U(pose(R, np.zeros(3))), F[0])
        F.insert(0, manipulator.required_wrench(F_star[i - 1], U(pose(np.eye(3), p)), T_F))
    return F


def joint_torques(
    q: Array,
    q_dot: Array,
    q_ddot: Array,
    F_e: Array | None = None,
    g: Array = data.G_UP,
    centroids: Array = data.CENTROIDS,
) -> Array:
    """Torques (6,) about the joint axes, N m at the link side; F_e (6,) by link 6 on the environment, in B_6."""
    F_star = net_wrenches(q, q_dot, q_ddot, g, centroids)
    return np.array([z @ F for F in inward_wrenches(q, F_star, np.zeros(6) if F_e is None else F_e)])


def required_wrenches(q: Array, q_dot: Array, q_dot_r: Array, q_ddot_r: Array, K: Array, F_e: Array) -> list[Array]:
    """Required wrenches on B_1 ... B_6, eqs. (48)-(53), with one gain (6, 6) for all bodies."""
    V, V_r = body_velocities(q, q_dot), body_velocities(q, q_dot_r)
    V_r_dot, R_BI = body_accelerations(q, q_dot, q_ddot_r, along=q_dot_r), world_rotations(q)
    F_star_r = [
        joint.required_net_wrench(
            data.MASSES[i],
            data.CENTROIDS[i],
            data.MOMENTS[i] * np.eye(3),
            R_BI[i],
            data.G_UP,
            V[i],
            V_r[i],
            V_r_dot[i],
            K,
        )
        for i in range(6)
    ]
    return inward_wrenches(q, F_star_r, F_e)


def J_q(q: Array) -> Array:
    """Jacobian (6, 6) of the end-effector, in its own frame, eq. (38)."""
    return manipulator.J_q([U(pose_between(q, i, 7)) for i in range(1, 7)])


def J_ba(q: Array) -> Array:
    """Matrix (42, 6) from joint velocities to end-effector and bodies, eq. (41)."""
    between = {(k, i): U(pose_between(q, k, i)) for i in range(1, 7) for k in range(1, i)}
    return manipulator.J_ba(J_q(q), between)


def J_e(q: Array) -> Array:
    """Extended Jacobian (48, 6), eq. (43), where J_q is regular."""
    return manipulator.J_e(J_q(q), J_ba(q))


def angular_velocities(q: Array, q_dot: Array) -> list[Array]:
    """Angular velocities of the six links in closed form, the block after (47).

    Corrected: the y component for B_5 is theta_2 c_5 + theta_3 s_5; the printed minus is not what (29)-(36) give.
    """
    (s4, s5, s6), (c4, c5, c6) = np.sin(q[3:]), np.cos(q[3:])
    s2, c2, s23, c23 = np.sin(q[1]), np.cos(q[1]), np.sin(q[1] + q[2]), np.cos(q[1] + q[2])
    d1, d2, d3, d4, d5, d6 = q_dot
    t1, t2, t3 = d2 + d3, d4 + d1 * s23, (d2 + d3) * s4 + d1 * c23 * c4
    w5z = d5 + t1 * c4 - d1 * c23 * s4
    return [
        np.array([0, 0, d1]),
        np.array([d1 * s2, d1 * c2, d2]),
        np.array([d1 * s23, d1 * c23, t1]),
        np.array([-t1 * s4 - d1 * c23 * c4, d1 * c23 * s4 - t1 * c4, t2]),
        np.array([t2 * s5 - t3 * c5, t2 * c5 + t3 * s5, w5z]),
        np.array([-(t3 * c5 - t2 * s5) * c6 - w5z * s6, (t3 * c5 - t2 * s5) * s6 - w5z * c6, d6 + t3 * s5 + t2 * c5]),
    ]

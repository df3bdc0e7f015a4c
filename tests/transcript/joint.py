"""Section II, the joint driven through a harmonic drive: eqs. (1)-(5), (9)-(28).

Angles kappa and their rates are rotor angles divided by the ratio ell, as in the paper.
"""

import numpy as np

from transcript.appendix import Array, C, G, M, z


def wave_generator_angle(ell: float, theta_c: float, theta_f: float) -> float:
    """(1) Angle of the wave generator from those of the circular spline and the flexspline.

    Corrected: the text swaps the encoders: theta_w is read on the motor side, theta_c on the link side.
    """
    return (ell + 1) * theta_c - ell * theta_f


def flexspline_torque(delta_theta_f: float, c_f: float, K_f0: float) -> float:
    """(2) Torque of the flexspline, at the link side, from its deflection.

    Corrected: it holds only while abs(delta_theta_f c_f K_f0) < pi / 2, which the paper does not say.
    """
    return np.tan(delta_theta_f * c_f * K_f0) / c_f


def flexspline_deflection(
    delta_theta: float, tau_w: float, c_w: float, K_w0: float, ell: float, theta_err: float
) -> float:
    """(3) Deflection left to the flexspline by the wave generator and the kinematic error.

    Corrected: the total deflection, which the paper does not define, is kappa - q, positive when the motor leads.
    """
    return delta_theta - np.sign(tau_w) / (c_w * ell * K_w0) * (1 - np.exp(-c_w * np.abs(tau_w))) - theta_err


def deflection_of_torque(tau_f: float, c_f: float, K_f0: float) -> float:
    """The law (2) read the other way."""
    return np.arctan(c_f * tau_f) / (c_f * K_f0)


def rotor_velocity(ell: float, kappa_dot: float, B_U_D: Array, B_V: Array) -> Array:
    """(4), (13) Velocity of the rotor, actual or required, from that of the joint base.

    Corrected (4): ell is the signed number of motor turns per joint turn; by (1) it is ell + 1 where the flexspline is
    fixed and -ell where the circular spline is.

    Corrected (13): the paper leaves kappa_r open; it is q_r plus the deflection that the required torque causes.
    """
    return z * ell * kappa_dot + B_U_D.T @ B_V


def output_link_velocity(q_dot: float, B_U_T: Array, B_V: Array) -> Array:
    """(5), (14) Velocity of the output link, actual or required, from that of the joint base."""
    return z * q_dot + B_U_T.T @ B_V


def output_link_balance(T_F: Array, T_F_q: Array) -> Array:
    """(9), (18) Net wrench of the output link, actual or required, from the wrenches at its two ends."""
    return -T_F + T_F_q


def base_balance(B_F: Array, B_U_T: Array, T_F_q: Array, B_U_D: Array, D_F_kappa: Array) -> Array:
    """(11), (20) Net wrench of the joint base, actual or required, from the wrenches on it.

    Corrected: B_F acts from the adjacent link on the joint base; the text before (9) says the output link.
    """
    return B_F - B_U_T @ T_F_q - B_U_D @ D_F_kappa


def output_axis_torque(ell: float, tau_t: float, xi_q: float) -> float:
    """Axial component of T_F_q as the text after (11) gives it."""
    return ell * tau_t - xi_q


def rotor_axis_torque(tau: float, tau_t: float, xi_kappa: float) -> float:
    """Axial component of D_F_kappa as the text after (11) gives it."""
    return tau - tau_t - xi_kappa


def required_joint_velocity(q_dot_d: Array, Lambda: Array, q_d: Array, q: Array) -> Array:
    """(12) Required joint velocities: the desired ones, corrected by the position errors."""
    return q_dot_d + Lambda @ (q_d - q)


def required_net_wrench(
    m: float, r: Array, I: Array, R_BI: Array, g: Array, V: Array, V_r: Array, V_r_dot: Array, K: Array
) -> Array:
    """(15), (16), (17), (50) Required net wrench of a body: output link, rotor, joint base, or link i.

    Corrected: its first part is the body's wrench at the required motion (with C at the actual angular velocity),
    because the printed actual wrench would need measured accelerations.
    """
    return M(m, r, I) @ V_r_dot + C(m, r, I, V[3:]) @ V_r + G(m, r, R_BI, g) + K @ (V_r - V)


def required_output_axis_torque(
    ell: float, tau_t: float, k_vq: float, q_dot_r: float, q_dot: float, xi_q: float
) -> float:
    """(21) Axial component of the required wrench on the output link."""
    return ell * (tau_t - k_vq * (q_dot_r - q_dot)) - xi_q


def required_rotor_axis_torque(
    tau: float, tau_t: float, k_vk: float, kappa_dot_r: float, kappa_dot: float, xi_kappa: float
) -> float:
    """(22) Axial component of the required wrench on the rotor."""
    return tau - tau_t - k_vk * (kappa_dot_r - kappa_dot) - xi_kappa


def required_drive_wrench(T_F_star_r: Array, T_F_r: Array) -> Array:
    """(23) Required wrench from the joint base on the output link."""
    return T_F_star_r + T_F_r


def required_base_wrench(B_F_star_r: Array, B_U_T: Array, T_F_qr: Array, B_U_D: Array, D_F_kappa_r: Array) -> Array:
    """(25) Required wrench from the adjacent link on the joint base.

    Corrected: U is not transposed; the printed marks belong to the frames of the wrenches, as (20) shows.
    """
    return B_F_star_r + B_U_T @ T_F_qr + B_U_D @ D_F_kappa_r


def drive_torque(ell: float, T_F_qr: Array, xi_q: float, k_vq: float, q_dot_r: float, q_dot: float) -> float:
    """(26) Torque that the drive must transmit, at the motor side.

    Corrected: z_t and the wrench without its frame are z_tau and T_F_qr, as (21) shows.
    """
    return (z @ T_F_qr + xi_q) / ell + k_vq * (q_dot_r - q_dot)


def control_torque(
    tau_t: float, k_vk: float, kappa_dot_r: float, kappa_dot: float, xi_kappa: float, D_F_kappa_r: Array
) -> float:
    """(27) Motor control torque, at the motor side.

    Corrected: z_t and the wrench without its frame are z_tau and D_F_kappa_r, as (22) shows.
    """
    return tau_t + k_vk * (kappa_dot_r - kappa_dot) + xi_kappa + z @ D_F_kappa_r


def motor_torque(I_m: float, kappa_ddot: float, tau_f: float, ell: float, xi_kappa: float) -> float:
    """(28) Whole torque of the motor, at the motor side.

    Corrected: tau of (27) already holds the transmitted torque tau_t = tau_f / ell; the printed sum counts the spring
    twice and adds a torque at the link side to one at the motor side.
    """
    return I_m * kappa_ddot + tau_f / ell + xi_kappa

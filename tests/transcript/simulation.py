"""Section IV: friction, rotor, trajectory and feedback: eqs. (54)-(58)."""

import numpy as np

from transcript.appendix import Array


def link_friction(q_dot: Array, f_c: Array, f_s: Array, f_v: Array, v_s: Array, eps: float) -> Array:
    """(54) Friction torque between joint base and output link.

    Corrected: sgn, which is not defined at rest, is tanh(q_dot / eps); the unit of f_v is N m s/rad.
    """
    return (f_c + (f_s - f_c) * np.exp(-(np.abs(q_dot / v_s) ** 2))) * np.tanh(q_dot / eps) + f_v * q_dot


def motor_friction(kappa_dot: Array, f_ck: Array) -> Array:
    """(55) Friction torque between joint base and rotor, at the motor side.

    Corrected: it opposes the motion, so a sign goes with the Coulomb coefficient.
    """
    return f_ck * np.sign(kappa_dot)


def rotor_inertia_torque(I_m: Array, kappa_ddot: Array) -> Array:
    """(56) Axial net torque of a rotor that only spins, at the motor side.

    Corrected: I_m is the rotor's inertia times ell: the rotor itself has 1.14e-5 kg m2, and its angle is ell kappa.
    """
    return I_m * kappa_ddot


def trajectory(t: float, q_d: Array, T: float, order: int = 0) -> Array:
    """(57) Desired joint positions, or their derivative of the given order.

    Corrected: the text cites it as (54) and as (56).
    """
    s = 2 * np.pi * t / T
    if order == 0:
        return q_d * (t / T - np.sin(s) / (2 * np.pi))
    return q_d / T**order * ((order == 1) - (2 * np.pi) ** (order - 1) * np.sin(s + order * np.pi / 2))


def feedback(K_v: Array, K_p: Array, q_d: Array, q: Array, q_dot_d: Array, q_dot: Array) -> Array:
    """(58) Torque of the proportional-derivative controller.

    Corrected: the paper leaves its side open; the gains here are those of the side whose angles are given.
    """
    return K_v @ (q_dot_d - q_dot) + K_p @ (q_d - q)

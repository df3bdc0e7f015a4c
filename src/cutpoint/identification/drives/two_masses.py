"""Rotor and link of one joint as two masses on a spring, sampled, with the torque held between samples."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from cutpoint.arrays import Array, ComplexArray


class TwoMasses(NamedTuple):
    """Inertias of link and rotor (kg m2), stiffness (N m/rad), damping of the spring, viscous friction of link and
    rotor (N m s/rad); all at the joint's side.  Spong (1987)."""

    link: float
    rotor: float
    stiffness: float
    damping: float
    link_friction: float
    motor_friction: float

    @property
    def antiresonance(self) -> float:
        """Undamped antiresonance, Hz, at which the rotor does not move."""
        return float(np.sqrt(self.stiffness / self.link)) / (2.0 * np.pi)

    def position_response(self, frequencies: Array, period: float) -> ComplexArray:
        """theta over torque, (F,), rad/(N m), between samples a period (s) apart, the torque held between them.

        An exact zero-order hold: Franklin, Powell, Workman (1998) section 4.3.
        """
        M, J, K, D, f_l, f_m = self
        A = np.zeros((5, 5))  # of q, v, theta, theta_dot, and the torque
        A[0, 1] = A[2, 3] = 1.0
        A[1, :4] = np.array([-K, -D - f_l, K, D]) / M
        A[3] = np.array([K, D, -K, -D - f_m, 1.0]) / J
        held = expm(A * period)
        z = np.exp(2j * np.pi * frequencies * period)
        # a column for each frequency: NumPy 1.26 would take a single column for vectors
        states = np.linalg.solve(z[:, None, None] * np.eye(4) - held[:4, :4], held[None, :4, 4:])
        return states[:, 2, 0].astype(np.complex128)

"""Gains from what an engineer asks for: bandwidth and damping."""

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.control.pd import PD
from cutpoint.errors import InputError
from cutpoint.robot import Robot


def pd_for_bandwidth(robot: Robot, bandwidth: float, damping: float = 0.7, q: ArrayLike | None = None) -> PD:
    """A motor-side PD under which each joint alone, drives stiff, would move as a second-order system.

    bandwidth in Hz, damping as a ratio; inertias are those of links and rotors at q (neutral if not given).  Well below
    the drives' own modes the joints then behave so; near them no PD on one side can.
    """
    if not (np.isfinite(bandwidth) and bandwidth > 0 and np.isfinite(damping) and damping > 0):
        raise InputError(f"pd_for_bandwidth: bandwidth {bandwidth} Hz and damping {damping} must be positive")
    omega = 2 * np.pi * bandwidth
    M = robot.mass_matrix(robot.neutral() if q is None else q)
    inertia = np.array(
        [M[d.v, d.v] + (d.drive.reflected_inertia if d.drive.is_elastic else 0) for d in robot.machine.drives]
    )
    return PD(inertia * omega**2, 2 * damping * omega * inertia, side="motor")

"""What gains are designed from: a robot's inertia and load at a pose, and what is asked of the closed loop."""

from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.robot import Robot


class Design(NamedTuple):
    """Inputs of gain design: the robot; its pose q; inertia of links and of elastic drives' rotors at each joint,
    kg m2; gravity torques, N m; bandwidth omega, rad/s; damping ratio; control period, s."""

    robot: Robot
    q: Array
    link: Array
    rotor: Array
    weight: Array
    omega: float
    damping: float
    period: float

    @property
    def inertia(self) -> Array:
        return self.link + self.rotor

    @property
    def stiffness(self) -> Array:
        return self.inertia * self.omega**2

    @property
    def resonance(self) -> Array:
        """Natural frequency, rad/s, of each rotor against its link, the spring under its load; inf of rigid drives."""
        springs = [drive.compliance for drive in self.robot.drives.values()]
        pairs = zip(springs, self.weight, strict=True)
        stiffness = np.array([float(x.tangent(x.deflection(load))) if x else np.inf for x, load in pairs])
        with np.errstate(divide="ignore"):  # a rigid drive's rotor is part of the link
            return np.sqrt(stiffness * (1 / self.link + 1 / self.rotor))


def design_of(robot: Robot, q: Array, omega: float, damping: float, period: float) -> Design:
    """Inputs of gain design: omega, rad/s; damping, a ratio; period, s."""
    weight = robot.gravity_forces(q)[[d.v for d in robot.machine.drives]]
    return Design(robot, q, *inertias(robot, q), weight, omega, damping, period)


def inertias(robot: Robot, q: Array) -> tuple[Array, Array]:
    """Inertia of links and of elastic drives' rotors at each joint, (n,) each, kg m2."""
    M, driven = robot.mass_matrix(q), robot.machine.drives
    rotor = [d.drive.reflected_inertia if d.drive.is_elastic else 0.0 for d in driven]
    return np.array([M[d.v, d.v] for d in driven]), np.array(rotor)

"""Recordings of simulated arms, of which all parameters are known."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import cutpoint
from cutpoint import Coulomb, Drive, Robot, Rotor
from cutpoint.control import PD
from cutpoint.errors import ModelError
from cutpoint.identification import Recording
from cutpoint.identification.excitation.series import FourierSeries, still_waves
from cutpoint.identification.rigid.base_parameters import BaseParameters, base_parameters
from cutpoint.identification.rigid.bodies import bodies_of, with_parameters
from cutpoint.model.places import Places
from cutpoint.model.validation import check_bodies
from cutpoint.simulation import Sensors
from random_trees import random_tree

Array = NDArray[np.float64]

NOISE = 0.05
"""N m, white, of each torque sample."""


class Known(NamedTuple):
    """A robot, and one whose file is wrong about its bodies."""

    robot: Robot
    file: Robot

    def base(self, rotors: bool | Collection[str] = True) -> tuple[BaseParameters, Array]:
        """Base parameters as the wrong file orders them, and their true values."""
        base = base_parameters(self.file, rotors=rotors)
        reflected = [float(self.robot.drives[self.robot.joints[j]].reflected_inertia) for j in base.rotors]
        return base, base.matrix @ [*self.robot.inertial_parameters, *reflected]


def known_arm(seed: int, size: int = 3) -> Known:
    """An arm of any joints with geared motors and dry friction, and the same with other bodies in its file."""
    rng = np.random.default_rng(seed)
    drives = {
        f"joint{k}": Drive(
            ratio=100.0,
            rotor=Rotor(rng.uniform(1e-5, 5e-5)),
            link_friction=Coulomb(rng.uniform(0.5, 2.0), rng.uniform(0.1, 1.0), smoothing=0.05),
        )
        for k in range(size)
    }
    robot = Robot(random_tree(seed, size), drives)
    bodies = bodies_of(robot)
    half = np.eye(4) + 0.2 * rng.normal(size=(bodies.count, 4, 4))
    wrong = with_parameters(robot.mechanism, bodies.parameters(half @ half.transpose(0, 2, 1)))
    return Known(robot, Robot(wrong, drives))


def motion(seed: int, joints: int, duration: float = 10.0) -> FourierSeries:
    """A series of five harmonics, at random."""
    sine, cosine = still_waves(5, 2)
    waves = 0.4 * np.random.default_rng(seed + 1000).normal(size=(sine.shape[1], joints))
    return FourierSeries(duration, 1.0 / duration, np.zeros(joints), sine @ waves, cosine @ waves)


def recorded(robot: Robot, seed: int) -> Recording:
    """10 s at 1 kHz under a PD law, encoders of 2^18 steps a turn with noise, torques with noise."""
    n = len(robot.joints)
    step = 2.0 * np.pi / 2**18
    sensors = Sensors(link_resolution=step, motor_resolution=step, link_noise=1e-5, motor_noise=1e-5, seed=seed)
    log = cutpoint.simulate(robot, PD([400.0] * n, [40.0] * n), motion(seed, n), sensors=sensors)
    # a command is held over a period: in the mean it acts half of one later
    held = log["motor_torque"].copy()
    held[1:] = 0.5 * (held[1:] + held[:-1])
    noise = NOISE * np.random.default_rng(seed).normal(size=held.shape)
    return Recording(log.time, log.joints, q=log["measured_q"], torque=held + noise)


def exists(robot: Robot) -> bool:
    """Whether all bodies are such as mass can have."""
    bodies = robot.mechanism.bodies
    try:
        for body in bodies:
            check_bodies([body], [[body.name]], Places(None))
    except ModelError:
        return False
    return all(body.mass > 0.0 for body in bodies)

"""All numbers of a loop that may differ between runs of one structure: to one array, and back."""

from typing import Any, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.sensors import Encoders
from cutpoint.definitions import Machine
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar, leaves, rebuild

Scalars = list[Scalar]


class Given(NamedTuple):
    """Everything with parameters except the law.  limits: of torque, N m at the joint's side; period: of control, s."""

    machine: Machine
    encoders: Encoders
    limits: Scalars
    period: Scalar


def parameters_of(robot: Robot, encoders: Encoders, period: float) -> Array:
    """Numbers of drives, sensors, torque limits, then the control period."""
    return np.array([*robot.drive_parameters, *leaves(encoders), *robot.effort_limits, period], float)


def with_parameters(robot: Robot, encoders: Encoders, parameters: Scalars) -> Given:
    """Robot, encoders and the rest with these numbers, of any kind."""
    numbers = iter(parameters)
    machine = robot.machine_with([next(numbers) for _ in robot.drive_parameters], lean=True)
    encoders = rebuild(encoders, numbers)
    return Given(machine, encoders, [next(numbers) for _ in robot.drives], next(numbers))


def law_parameters(law: Any, period: float) -> Array:
    """Numbers of the law, then the control period, s."""
    return np.array([*leaves(law), period], float)

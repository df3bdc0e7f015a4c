"""A control law's step as a kernel: the closed loop's control stage, for use in a robot controller."""

from typing import Any, NamedTuple

import numpy as np

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.control.interface import SENSED, Control, start_of
from cutpoint.control.own_law import check_pure
from cutpoint.control.sensors import SAMPLED, Sensors, encoders_of
from cutpoint.kernels import Kernel
from cutpoint.robot import Robot
from cutpoint.scalars import leaves, with_float_leaves
from cutpoint.simulation.controllers import fitting
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.loop.parameters import law_parameters

REFERENCE = ("reference_q", "reference_v", "reference_a", "reference_jerk", "reference_snap")


class ControlStep(NamedTuple):
    """A law's command, one number per drive, and its next memory.

    torque, feedforward_torque (N m); motor_reference (rad), motor_speed_reference (rad/s): at the joint's side.
    fault: a number, see `control.Fault`.
    """

    torque: Any
    feedforward_torque: Any
    motor_reference: Any
    motor_speed_reference: Any
    fault: Any
    next_memory: Any


def law_kernel(robot: Robot, law: Control, *, name: str = "control_step") -> Kernel:
    """One step of a law, equal to the compiled loop's to the last bit; torque limits are not applied.

    Inputs: SENSED and REFERENCE, one number per drive, time (s), memory, and parameters (see `law_parameters`).
    Outputs: those of ControlStep.
    Raises InputError for a law of another robot's size, TraceError for one that cannot be traced.
    """
    loop = _loop_of(robot, law)
    n, count = loop.layout.n, len(law_parameters(loop.controller, 1.0))

    def control_step(time: Any, memory: Any, parameters: Any, **given: Any) -> ControlStep:
        measured, references = ([x for key in keys for x in given[key]] for keys in (SAMPLED, REFERENCE))
        command, after = loop.control(measured, memory, [time, *references], parameters)
        torque, feedforward, theta, theta_dot = (command[k * n : (k + 1) * n] for k in range(4))
        return ControlStep(torque, feedforward, theta, theta_dot, command[-1], after)

    sizes = dict.fromkeys((*SENSED, *REFERENCE), n)
    memory = len(loop.initial_memory())
    return kernels.compile(
        control_step, name=name, backend=robot.backend, **sizes, time=(), memory=memory, parameters=count
    )


def law_memory(law: Any) -> Array:
    """A law's memory at the start, flat."""
    return np.array(leaves(with_float_leaves(start_of(law))), float)


def _loop_of(robot: Robot, law: Control) -> ClosedLoop:
    n, law = len(robot.drives), fitting(robot, law)
    check_pure(law, n)
    return ClosedLoop(robot, law, encoders_of(Sensors(), n, 1.0), with_float_leaves(start_of(law)), 1.0, {})

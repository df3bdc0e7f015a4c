"""From recorded rows to a log of named channels with units."""

import numpy as np
from numpy.typing import NDArray

from cutpoint.simulation.log import Log
from cutpoint.simulation.loop import ClosedLoop

Array = NDArray[np.float64]

UNITS = {
    "q": "rad", "v": "rad/s", "theta": "rad", "theta_dot": "rad/s", "measured_q": "rad", "measured_theta": "rad",
    "measured_v": "rad/s", "measured_theta_dot": "rad/s", "command_torque": "N m", "feedforward_torque": "N m",
    "feedback_torque": "N m", "motor_reference": "rad", "motor_speed_reference": "rad/s", "motor_torque": "N m",
    "joint_torque": "N m", "friction_torque": "N m", "reference_q": "rad", "reference_v": "rad/s",
    "position_error": "rad", "motor_position_error": "rad",
}  # fmt: skip
"""Units of revolute joints; on prismatic ones m stands for rad and N for N m."""


def log_of(loop: ClosedLoop, record: Array, times: Array, reference: Array, meta: dict[str, object]) -> Log:
    """Everything recorded, and what follows from it."""
    channels: dict[str, Array] = {}
    start = 0
    for name, size in loop.channels.items():
        channels[name] = record[:, start : start + size].copy()
        start += size
    samples = len(record)
    driven = [d.q for d in loop.robot.machine.drives]
    channels["reference_q"], channels["reference_v"] = reference[0, :samples], reference[1, :samples]
    channels["position_error"] = channels["reference_q"] - channels["q"][:, driven]
    channels["motor_position_error"] = channels["motor_reference"] - channels["theta"]
    channels["feedback_torque"] = channels["command_torque"] - channels["feedforward_torque"]
    about = {"robot": loop.robot.name, "control_period": loop.period, **meta}
    return Log(times[:samples], channels, {name: UNITS[name] for name in channels}, tuple(loop.robot.drives), about)

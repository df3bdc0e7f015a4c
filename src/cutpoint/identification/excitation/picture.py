"""Figure of an excitation."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.arrays import Array
from cutpoint.identification.excitation.limits import Use
from cutpoint.identification.excitation.series import FourierSeries
from cutpoint.joint_units import at_joints
from cutpoint.reporting.style import FAINT, MOTOR, STYLE, fit, styled_figure
from cutpoint.robot import Robot

Bounds = tuple[float, float]

AXIS_WIDTH, AXIS_HEIGHT = 3.6, 1.5
"""Inches."""

SAMPLES = 1000


def figure_of(robot: Robot, trajectory: FourierSeries, limits: Sequence[Use]) -> Figure:
    """Position, speed and motor torque over one period, a row per joint; stated limits are dashed."""
    time = np.linspace(0.0, 1.0 / trajectory.base_frequency, SAMPLES)
    motion = trajectory.derivatives(time, 4)
    torque = robot.elastic_inverse_dynamics(*motion, quasi_rigid=True).motor_torque
    stated = {(use.kind, use.name): (use.low, use.high) for use in limits}
    return styled_figure(lambda: _drawn(robot, time, motion, torque, stated))


def _drawn(robot: Robot, time: Array, motion: Array, torque: Array, stated: Mapping[tuple[str, str], Bounds]) -> Figure:
    rows = len(robot.joints)
    size = (0.6 + 3 * AXIS_WIDTH, 0.6 + AXIS_HEIGHT * rows)
    figure = Figure(figsize=size, dpi=STYLE["figure.dpi"], layout="constrained")
    axes = figure.subplots(rows, 3, sharex=True, squeeze=False)
    forces = at_joints(robot, "N m")
    for k, (name, unit) in enumerate(at_joints(robot, "rad").items()):
        shown, factor = ("deg", 180.0 / np.pi) if unit == "rad" else ("m", 1.0)
        _draw(axes[k, 0], time, factor * motion[0][:, k], factor, stated.get(("position", name)))
        _draw(axes[k, 1], time, factor * motion[1][:, k], factor, stated.get(("speed", name)))
        _draw(axes[k, 2], time, torque[:, k], 1.0, stated.get(("torque", name)))
        titles = (f"position [{shown}]", f"speed [{shown}/s]", f"motor torque [{forces[name]}]")
        for axis, title in zip(axes[k], titles, strict=True):
            fit(axis.set_title(f"{name}: {title}", parse_math=False), AXIS_WIDTH - 0.5)
    for axis in axes[-1]:
        axis.set_xlabel("time [s]")
    if limited := next((x for x in axes.flat if len(x.lines) > 1), None):
        figure.legend(limited.lines[:2], ["excitation", "limit"], loc="outside upper right", ncols=2)
    return figure


def _draw(axis: Axes, time: Array, values: Array, factor: float, allowed: Bounds | None) -> None:
    axis.plot(time, values, color=MOTOR, linewidth=1.0)
    for bound in allowed or ():
        axis.axhline(factor * bound, color=FAINT, linewidth=0.8, linestyle="--")
    axis.margins(x=0.0)
    axis.ticklabel_format(useOffset=False)

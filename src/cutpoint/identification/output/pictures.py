"""Measured and modelled torques, and residuals, a row or a panel per joint."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.identification.output.torque_errors import TorqueErrors
from cutpoint.joint_units import at_joints, either
from cutpoint.reporting.style import FAINT, HAIR, INK, LINK, MOTOR, WIDTH
from cutpoint.robot import Robot

ROW = 1.9
"""Inches of a panel's height."""

POINTS = 3000
"""Most points drawn of each curve or cloud."""

LARGEST_PART = 99.5
"""Percentage of the residuals that a panel shows: single outliers would flatten all others."""


def torque_picture(errors: TorqueErrors, robot: Robot) -> Figure:
    """Measured torque over time, and both models, where the motion is known; the held-out part on a grey background."""
    joints, units = robot.joints, at_joints(robot, "N m")
    figure = Figure(figsize=(WIDTH, 0.6 + ROW * len(joints)), layout="constrained")
    panels = list(figure.subplots(len(joints), 1, sharex=True, squeeze=False).flat)
    some = np.flatnonzero(np.isfinite(errors.after).any(axis=1))
    some = np.arange(some[0], some[-1] + 1)[thinned(some.size)] if some.size else some
    time = errors.time[some]
    for j, (axes, joint) in enumerate(zip(panels, joints, strict=True)):
        # wider and paler than the models on top of it, which might otherwise hide it
        axes.plot(time, errors.measured[some, j], color=INK, linewidth=2.6, alpha=0.4, label="measured")
        axes.plot(time, errors.before[some, j], color=FAINT, linewidth=1.0, linestyle="--", label="the files' model")
        axes.plot(time, errors.after[some, j], color=LINK, linewidth=1.0, label="identified model")
        if errors.held_out[some].any():
            axes.axvspan(time[errors.held_out[some]][0], time[-1], color=HAIR, alpha=0.5, linewidth=0.0)
        titled(axes, f"{joint}: torque [{units[joint]}]")
        axes.margins(x=0.0)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=3)
    panels[-1].set_xlabel("time [s]")
    return figure


def residual_picture(errors: TorqueErrors, robot: Robot) -> Figure:
    """Residuals of the identified model over speed, position and load."""
    joints, units = robot.joints, at_joints(robot, "N m")
    figure = Figure(figsize=(WIDTH, 0.6 + ROW * len(joints)), layout="constrained")
    grid = figure.subplots(len(joints), 3, sharey="row", squeeze=False)
    residual = errors.measured - errors.after
    speed, position, load = (either(at_joints(robot, unit).values()) for unit in ("rad/s", "rad", "N m"))
    labels = f"speed [{speed}]", f"position [{position}]", f"load of the links [{load}]"
    against = [*zip(labels, (errors.v, errors.q, errors.load), strict=True)]
    some = thinned(errors.time.size)
    for j, joint in enumerate(joints):
        for axes, (label, values) in zip(grid[j], against, strict=True):
            held_out = errors.held_out[some]
            for part, color, name in ((~held_out, MOTOR, "fitted"), (held_out, LINK, "held out")):
                axes.plot(values[some, j][part], residual[some, j][part], ".", color=color, markersize=1.5, label=name)
            if j == len(joints) - 1:
                axes.set_xlabel(label)
        titled(grid[j, 0], f"{joint}: residual [{units[joint]}]")
        reach = np.abs(residual[np.isfinite(residual[:, j]), j])
        if reach.size and reach.any():
            top = 1.1 * float(np.percentile(reach, LARGEST_PART))
            grid[j, 0].set_ylim(-top, top)
    handles, names = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper right", ncols=2, markerscale=6)
    return figure


def thinned(count: int) -> slice:
    return slice(None, None, 1 + count // POINTS)


def titled(axes: Axes, text: str) -> None:
    """Sets a title with a user's joint name, without mathematical notation."""
    axes.set_title(text, parse_math=False)

"""Figures 10 and 11, and Table 4 as a picture."""

import numpy as np
from matplotlib.figure import Figure

from cutpoint.simulation import Log
from cutpoint.studies.chain import Array
from cutpoint.studies.paper.page import JOINTS
from cutpoint.studies.paper.printed import TABLE_4_POSITION, TABLE_4_TORQUE
from cutpoint.studies.style import JOINTS as COLOURS
from cutpoint.studies.style import LINK, MOTOR, WIDTH, six_panels


def position_rms(log: Log) -> Array:
    """Degrees, by joint."""
    return np.rad2deg(log.rms("position_error"))


def figure_10(log: Log) -> Figure:
    figure, panels = six_panels("torque", "N m")
    for k, axes in enumerate(panels):
        (control,) = axes.plot(log.time, log["command_torque"][:, k], color=LINK, lw=1.0)
        (foreseen,) = axes.plot(log.time, log["feedforward_torque"][:, k], color=MOTOR, lw=1.3, ls="--")
    figure.legend([control, foreseen], ["control torque τ", "feedforward τ$_m$"], loc="outside upper center", ncols=2)
    return figure


def figure_11(log: Log) -> Figure:
    figure = Figure(figsize=(WIDTH, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    lines = []
    for k, colour in enumerate(COLOURS):
        lines += left.plot(log.time, np.rad2deg(log["position_error"][:, k]), color=colour, lw=1.0)
        right.plot(log.time, log["feedback_torque"][:, k], color=colour, lw=1.0)
    left.set(title="(a) position errors", ylabel="error [deg]")
    right.set(title="(b) compensation errors", ylabel="torque [N m]")
    for axes in (left, right):
        axes.set_xlabel("time [s]")
        axes.margins(x=0)
    figure.legend(lines, JOINTS, loc="outside lower center", ncols=6)
    return figure


def by_rung(logs: dict[str, Log]) -> Figure:
    """RMS errors of the loops, PD alone to all rungs, with the printed ones at the right."""
    figure = Figure(figsize=(WIDTH, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = [*logs]
    at = np.arange(len(names))
    lines = []
    for k, colour in enumerate(COLOURS):
        lines += left.semilogy(at, [position_rms(logs[n])[k] for n in names], "o-", color=colour, ms=4)
        right.semilogy(at, [logs[n].rms("feedback_torque")[k] for n in names], "o-", color=colour, ms=4)
        left.plot(len(names), TABLE_4_POSITION[k], "s", color=colour, mfc="white")
        right.plot(len(names), TABLE_4_TORQUE[k], "s", color=colour, mfc="white")
    left.set(title="RMS position error [deg]")
    right.set(title="RMS compensation error [N m]")
    short = ["PD\nalone", "gravity", "rigid", "rotors", "friction", "elastic", "paper"]
    for axes in (left, right):
        axes.set_xticks(np.arange(len(short)), short, fontsize=9)
        axes.grid(which="minor", visible=False)
    figure.legend(lines, JOINTS, loc="outside lower center", ncols=6)
    return figure

"""Figures 10 and 11, and Table 4 as a picture."""

import numpy as np
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from cutpoint.arrays import Array
from cutpoint.reporting.style import INK, LINK, MOTOR, WIDTH
from cutpoint.reporting.style import JOINTS as COLOURS
from cutpoint.simulation import Log
from cutpoint.studies.paper.panels import six_panels
from cutpoint.studies.paper.printed import JOINTS, TABLE_4_POSITION, TABLE_4_TORQUE


def position_rms(log: Log) -> Array:
    """RMS position errors by joint, degrees."""
    return np.rad2deg(log.rms("position_error"))


def figure_10(log: Log) -> Figure:
    figure = Figure(figsize=(WIDTH, 5.0), layout="constrained")
    for k, axes in enumerate(six_panels(figure, "torque", "N m")):
        axes.plot(log.time, log["command_torque"][:, k], color=LINK, lw=0.5, alpha=0.8)
        axes.plot(log.time, log["feedforward_torque"][:, k], color=MOTOR, lw=1.6, ls="--")
    handles = [Line2D([], [], color=LINK, lw=2), Line2D([], [], color=MOTOR, ls="--")]
    figure.legend(handles, ["control torque $\\tau$", "feedforward $\\tau_m$"], loc="outside upper center", ncols=2)
    return figure


def figure_11(log: Log) -> Figure:
    """(a) above, (b) below, six panels each."""
    figure = Figure(figsize=(WIDTH, 8.2), layout="constrained")
    above, below = (figure.add_subfigure(half) for half in figure.add_gridspec(2, 1))
    _errors(above, "(a) position errors", "deg", log.time, np.rad2deg(log["position_error"]))
    _errors(below, "(b) compensation errors", "N m", log.time, log["feedback_torque"])
    return figure


def _errors(figure: SubFigure, title: str, unit: str, time: Array, errors: Array) -> None:
    figure.suptitle(title, x=0.01, ha="left", weight="bold", fontsize=12)
    for k, axes in enumerate(six_panels(figure, "error", unit)):
        axes.plot(time, errors[:, k], color=COLOURS[k], lw=0.4, alpha=0.55)
        axes.plot(time, np.convolve(errors[:, k], np.full(101, 1 / 101), mode="same"), color=INK, lw=1.2)


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

"""Figures 13 and 14: one run of the simulated stand-in, and the band that all of them fill."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.ndimage import uniform_filter1d

from cutpoint.arrays import Array
from cutpoint.reporting.style import FAINT, HAIR, INK, LINK, MOTOR, WIDTH
from cutpoint.reporting.style import JOINTS as COLOURS
from cutpoint.studies.paper.printed import JOINTS
from cutpoint.studies.paper.stand_in import Run

_MEAN = 20  # samples: 20 ms
_SHOWN = 10  # every so many samples of a mean are drawn


def figure_13(time: Array, reference: Array, shown: Run, runs: Sequence[Run]) -> Figure:
    """(a) positions, (b) errors; reference (N, 2) in rad."""
    figure = Figure(figsize=(WIDTH, 3.7), layout="constrained")
    positions, *panels = figure.subplots(1, 3)
    for k, colour in enumerate(COLOURS[:2]):
        positions.plot(time, np.rad2deg(shown.q[:, k]), color=colour, lw=3, alpha=0.45)
        positions.plot(time, np.rad2deg(reference[:, k]), color=INK, lw=1.0, ls="--")
        positions.text(29.5, np.rad2deg(reference[-1, k]) - 6.5, JOINTS[k], color=colour, ha="right", va="top")
    positions.set(title="(a) positions [deg]", xlabel="time [s]")
    positions.margins(x=0)
    for k, axes in enumerate(panels):
        errors = [np.rad2deg(run.position_error[:, k]) for run in runs]
        _band(axes, time, np.rad2deg(shown.position_error[:, k]), errors, COLOURS[k])
        axes.set(title=f"(b) error of {JOINTS[k]} [deg]", xlabel="time [s]")
    _legend(figure, {"desired": Line2D([], [], color=INK, ls="--", lw=1)})
    return figure


def figure_14(time: Array, shown: Run, runs: Sequence[Run]) -> Figure:
    """(a) torques, (b) compensation errors."""
    figure = Figure(figsize=(WIDTH, 5.8), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True)
    for k, (torque, error) in enumerate(panels.T):
        torque.plot(time, shown.control[:, k], color=LINK, lw=0.5, alpha=0.8)
        torque.plot(time, shown.feedforward[:, k], color=MOTOR, lw=1.6, ls="--")
        torque.set(title=f"(a) torque of {JOINTS[k]} [N m]")
        torque.margins(x=0)
        _band(error, time, shown.feedback[:, k], [run.feedback[:, k] for run in runs], COLOURS[k])
        error.set(title=f"(b) compensation error of {JOINTS[k]} [N m]", xlabel="time [s]")
    more = {
        "control torque $\\tau$": Line2D([], [], color=LINK, lw=2),
        "feedforward $\\tau_m$": Line2D([], [], color=MOTOR, ls="--"),
    }
    _legend(figure, more)
    return figure


def _band(axes: Axes, time: Array, shown: Array, runs: Sequence[Array], colour: str) -> None:
    """One run, its mean over 20 ms, and from the lowest to the highest such mean of all runs."""
    means = np.array([_mean(run) for run in runs])
    axes.fill_between(time[::_SHOWN], means.min(axis=0), means.max(axis=0), color=HAIR, lw=0, zorder=1)
    axes.plot(time, shown, color=colour, lw=0.4, alpha=0.55, zorder=2)
    axes.plot(time[::_SHOWN], _mean(shown), color=INK, lw=1.0, zorder=3)
    axes.axhline(0.0, color=FAINT, lw=0.6, zorder=1)
    axes.margins(x=0)


def _mean(x: Array) -> Array:
    """Over 20 ms around each sample that is drawn."""
    return uniform_filter1d(x, _MEAN, mode="nearest")[::_SHOWN]


def _legend(figure: Figure, more: dict[str, Line2D]) -> None:
    handles = {
        **more,
        "mean over 20 ms": Line2D([], [], color=INK, lw=1),
        "range of such means over the seeds": Patch(color=HAIR),
    }
    figure.legend([*handles.values()], [*handles], loc="outside lower center", ncols=len(handles))

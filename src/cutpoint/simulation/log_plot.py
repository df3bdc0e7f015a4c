"""A log as a picture."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cutpoint.errors import InputError
from cutpoint.simulation.log import Array, Log

AXIS_WIDTH, AXIS_HEIGHT = 3.6, 2.0
"""Inches."""

ACROSS = 3
"""Axes side by side."""

Line = tuple[str, Array]
"""A label and its values (N,), in a unit for people."""


def picture(log: Log, names: Sequence[str]) -> Figure:
    """One axis per unit and joint for the named channels; without names, one axis per channel."""
    axes = _axes(log, names)
    if not axes:
        raise InputError("the log has no channels to plot")
    across = min(ACROSS, len(axes), len(log.joints) if names and log.joints else ACROSS)
    down = -(-len(axes) // across)
    figure = Figure(figsize=(0.6 + AXIS_WIDTH * across, 0.6 + AXIS_HEIGHT * down), layout="constrained")
    colours = {label: f"C{index}" for index, label in enumerate(names or log.joints)}
    for index, ((unit, title), lines) in enumerate(axes.items()):
        axis = figure.add_subplot(down, across, index + 1)
        _draw(axis, log.time, lines, colours, later="--" if names else "-")
        axis.set_title(f"{title} [{unit}]" if unit else title, loc="left", fontsize="medium", parse_math=False)
        if index >= len(axes) - across:
            axis.set_xlabel("time [s]")
    _explain(figure, colours)
    return figure


def _axes(log: Log, names: Sequence[str]) -> dict[tuple[str, str], list[Line]]:
    """The lines of each axis, by its unit and title, in the order of their first line."""
    axes: dict[tuple[str, str], list[Line]] = {}
    for name in names or log.channels:
        values = log[name].reshape(log.time.size, -1)
        for column, (joint, unit) in enumerate(log.columns(name)):
            shown, factor = _for_people(unit)
            title, label = (joint or name, name) if names else (name, joint)
            axes.setdefault((shown, title), []).append((label, factor * values[:, column]))
    return axes


def _for_people(unit: str) -> tuple[str, float]:
    """The unit to show and what values are multiplied with: degrees for angles and their time derivatives."""
    if unit == "rad" or unit.startswith("rad/"):
        return unit.replace("rad", "deg", 1), 180.0 / np.pi
    return unit, 1.0


def _draw(axis: Axes, time: Array, lines: Sequence[Line], colours: dict[str, str], later: str) -> None:
    """Draws the lines, those after the first in the style `later`; a channel without joints is grey among joints."""
    for index, (label, values) in enumerate(lines):
        axis.plot(time, values, later if index else "-", color=colours.get(label, "0.2"), linewidth=1.0)
    axis.margins(x=0.0)
    axis.grid(alpha=0.3)
    axis.ticklabel_format(useOffset=False)


def _explain(figure: Figure, colours: dict[str, str]) -> None:
    if colours:
        samples = [Line2D([], [], color=colour) for colour in colours.values()]
        legend = figure.legend(samples, list(colours), loc="outside upper center", ncols=6)
        for text in legend.get_texts():
            text.set_parse_math(False)

"""A log as a picture."""

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle
from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from cutpoint.arrays import Array
from cutpoint.door import check_kind
from cutpoint.errors import InputError
from cutpoint.reporting.style import FAINT, JOINTS, STYLE, fit, grid_of, styled_figure
from cutpoint.simulation.log.log import Log

AXIS_WIDTH, AXIS_HEIGHT = 3.6, 2.0
"""Inches."""

TITLE_WIDTH = AXIS_WIDTH - 0.5
"""Inches: what the labels of its ticks leave of an axis at least."""

LEAST_HEIGHT = 1e-9
"""Of an axis, in its unit: what is smaller is rounding, which would fill it."""

COLOURS = (JOINTS, [f"C{k}" for k in range(10)], [*map(to_hex, colormaps["tab20"](range(20)))])
"""Of lines: the first that go round, or the last."""

OWN = "this log"
"""The legend's name of the log that is drawn with others beside it."""

STYLES = ("-", "--", "-.", ":")
"""Of lines, from one time to the next that they go through all colours."""

MOST_COLUMNS, COLUMN_GAP = 6, 0.2
"""Of the legend; inches between two of them."""


class Line(NamedTuple):
    """times (s) and values (N,), these in a unit for people, of a log's channel; joint: "" if it has none."""

    run: str
    channel: str
    joint: str
    times: Array
    values: Array


class Words(NamedTuple):
    """Labels of lines in the legend, "" for none, all of them in order; and titles of axes without their units."""

    label: Callable[[Line], str]
    labels: Sequence[str]
    title: Callable[[Line], str]


Axis = tuple[str, str, bool]
"""A unit, the joint or channel that shares an axis, and whether it is of errors, which positions would flatten."""


def picture(logs: Mapping[str, Log], names: Sequence[str]) -> Figure:
    """One axis per unit and joint for the named channels of all logs, apart for errors; without names, one per channel
    of the only log.

    logs: by their names in legends; "" for one that needs none.
    """
    axes = _axes(logs, names)
    if not axes:
        raise InputError("the log has no channels to plot, or only NaN in them")
    words = _words(logs, names, axes)
    across, cells = _cells(axes, apart=bool(names))
    return styled_figure(lambda: _drawn(axes, words, across, cells, dashed=bool(names)))


def _drawn(axes: dict[Axis, list[Line]], words: Words, across: int, cells: list[int], dashed: bool) -> Figure:
    """dashed: whether lines that cover others let them show through, each in another way."""
    down = cells[-1] // across + 1
    size = (0.6 + AXIS_WIDTH * across, 0.3 + AXIS_HEIGHT * down)
    figure = Figure(figsize=size, dpi=STYLE["figure.dpi"], layout="constrained")
    looks = _looks(words.labels)
    covering = {words.label(line) for lines in axes.values() for line in lines[1:]} if dashed else set[str]()
    later = dict(zip([label for label in looks if label in covering], cycle(STYLES[1:])))
    drawn: dict[str, Line2D] = {}
    times = [line.times[end] for lines in axes.values() for line in lines for end in (0, -1)]
    for cell, ((unit, *_), lines) in zip(cells, axes.items(), strict=True):
        axis, title = figure.add_subplot(down, across, cell + 1), words.title(lines[0])
        drawn = _draw(axis, [(words.label(line), line) for line in lines], looks, later) | drawn
        if min(times) < max(times):
            axis.set_xlim(min(times), max(times))
        fit(axis.set_title(f"{title} [{unit}]" if unit else title, parse_math=False), TITLE_WIDTH)
        if cell + across not in cells:
            axis.set_xlabel("time [s]")
    _explain(figure, {label: drawn[label] for label in looks if label and label in drawn})
    return figure


def check_beside(beside: Mapping[str, Log], names: Sequence[str], label: str) -> None:
    """Raises InputError for anything but logs by name, apart from this log's own label, and if no channels are named to
    draw of them."""
    check_kind("plot", "label", label, str, "a text for the legend")
    check_kind("plot", "beside", beside, Mapping, "logs by name, such as {'VDC': log}")
    for run, other in beside.items():
        check_kind("plot", "each name in beside", run, str, "a text for the legend")
        if not run:
            raise InputError("plot: a name in beside is empty; name each log, for the legend")
        if run == label:
            raise InputError(f"plot: label {label!r} is also the name of a log beside; give each its own")
        check_kind("plot", f"beside[{run!r}]", other, Log, "a log")
    if beside and not names:
        raise InputError("plot: name the channels of logs side by side: log.plot('position_error', beside={...})")


def _words(logs: Mapping[str, Log], names: Sequence[str], axes: dict[Axis, list[Line]]) -> Words:
    """What is the same for all lines of every axis stands in the titles, the rest in the legend."""
    if not names:
        return Words(lambda line: line.joint, next(iter(logs.values())).joints, lambda line: line.channel)
    if all(len({line.channel for line in lines}) == 1 for lines in axes.values()):
        own = {run: run or OWN if len(logs) > 1 else "" for run in logs}
        return Words(lambda line: own[line.run], [*own.values()], lambda line: ": ".join(filter(None, line[2:0:-1])))

    def label(run: str, channel: str) -> str:
        return f"{run}: {channel}" if run else channel

    labels = [label(run, name) for run in logs for name in names]
    return Words(lambda line: label(line.run, line.channel), labels, lambda line: line.joint or line.channel)


def _cells(axes: dict[Axis, list[Line]], apart: bool) -> tuple[int, list[int]]:
    """The number of columns, and the cell of each axis, row by row.

    apart: axes of other channels than those before them begin a row.
    """
    shown = [tuple((line.run, line.channel) for line in lines) if apart else () for lines in axes.values()]
    _, across = grid_of(max(map(shown.count, shown)))
    cells: list[int] = []
    for k, channels in enumerate(shown):
        begun = k and channels != shown[k - 1]
        cells.append(-(-(cells[-1] + 1) // across) * across if begun else len(cells) and cells[-1] + 1)
    return across, cells


def _looks(labels: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Colour and style of each line."""
    colours = next((some for some in COLOURS if len(labels) <= len(some)), COLOURS[-1])
    return {label: (colours[k % len(colours)], STYLES[k // len(colours) % 4]) for k, label in enumerate(labels)}


def _axes(logs: Mapping[str, Log], names: Sequence[str]) -> dict[Axis, list[Line]]:
    """The lines of each axis, in the order of their first line; none where all is NaN."""
    axes: dict[Axis, list[Line]] = {}
    short = {
        kind: all(_are_short(log, names or [*log.channels], kind) for log in logs.values()) for kind in (True, False)
    }
    for run, log in logs.items():
        for name in names or log.channels:
            values = log[name].reshape(log.time.size, -1)
            is_error = _is_error(name)
            for column, (joint, unit) in enumerate(log.columns(name)):
                shown, factor = ("mm", 1e3) if unit == "m" and short[is_error] else _for_people(unit)
                line = Line(run, name, joint, log.time, factor * values[:, column])
                axes.setdefault((shown, (joint if names else "") or name, is_error), []).append(line)
    return {key: lines for key, lines in axes.items() if not all(np.isnan(line.values).all() for line in lines)}


def _is_error(name: str) -> bool:
    """Whether a channel is an error, which has an axis of its own since it is much smaller."""
    return name.endswith("_error")


def _are_short(log: Log, names: Sequence[str], errors: bool) -> bool:
    """Whether all shown lengths, those of errors or the others, are below a metre."""
    for name in names:
        values = log[name].reshape(log.time.size, -1)
        ways = values[:, [unit == "m" and _is_error(name) == errors for _, unit in log.columns(name)]]
        if (np.abs(ways) >= 1.0).any():
            return False
    return True


def _for_people(unit: str) -> tuple[str, float]:
    """The unit to show and its factor: degrees for angles and their time derivatives."""
    if unit == "rad" or unit.startswith("rad/"):
        return unit.replace("rad", "deg", 1), 180.0 / np.pi
    return unit, 1.0


def _draw(
    axis: Axes, lines: Sequence[tuple[str, Line]], looks: dict[str, tuple[str, str]], later: Mapping[str, str]
) -> dict[str, Line2D]:
    """Draws the lines, by label, in their colours and styles; those labels that are `later` in some axis have the style
    given there in all, to show what they cover; a channel without joints is grey among joints."""
    drawn: dict[str, Line2D] = {}
    for label, line in lines:
        colour, style = looks.get(label, (FAINT, "-"))
        (drawn[label],) = axis.plot(line.times, line.values, later.get(label, style), color=colour, linewidth=1.0)
        if line.times.size == 1:
            drawn[label].set_marker(".")
    low, high = axis.get_ylim()
    if high - low < LEAST_HEIGHT:
        axis.set_ylim(low - LEAST_HEIGHT / 2, high + LEAST_HEIGHT / 2)
    axis.ticklabel_format(axis="y", useOffset=False)
    return drawn


def _explain(figure: Figure, drawn: dict[str, Line2D]) -> None:
    """A legend above the axes, in as few rows of about the same length as the figure is wide for, and room for them."""
    if not drawn:
        return
    width, height = figure.get_size_inches()
    alone = _legend(figure, drawn, columns=1)
    widest = _inches(figure, alone)[0] + COLUMN_GAP
    alone.remove()
    fitting = max(1, min(MOST_COLUMNS, int(width / widest)))
    rows = -(-len(drawn) // fitting)
    legend = _legend(figure, drawn, columns=-(-len(drawn) // rows))
    figure.set_size_inches(max(width, widest), height + _inches(figure, legend)[1])


def _legend(figure: Figure, drawn: dict[str, Line2D], columns: int) -> Legend:
    # a legend fills column by column, and is read row by row
    names = [name for k in range(columns) for name in [*drawn][k::columns]]
    # names are set afterwards: a legend leaves out those that begin with an underscore
    lines, blank = [drawn[name] for name in names], [" "] * len(names)
    legend = figure.legend(lines, blank, loc="outside upper center", ncols=columns)
    for text, name in zip(legend.get_texts(), names, strict=True):
        text.set_parse_math(False)
        text.set_text(name)
    return legend


def _inches(figure: Figure, legend: Legend) -> tuple[float, float]:
    """Width and height."""
    box = legend.get_window_extent()
    return box.width / figure.dpi, box.height / figure.dpi

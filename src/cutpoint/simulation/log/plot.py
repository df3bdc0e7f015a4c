"""A log as a picture."""

from collections.abc import Mapping, Sequence, Set

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from cutpoint.door import check_kind
from cutpoint.errors import InputError
from cutpoint.simulation.log.log import Array, Log

AXIS_WIDTH, AXIS_HEIGHT = 3.6, 2.0
"""Inches."""

ACROSS = 3
"""Axes side by side."""

LEAST_HEIGHT = 1e-9
"""Of an axis, in its unit: what is smaller is rounding, which would fill it."""

FEW, MANY = [f"C{k}" for k in range(10)], [*map(to_hex, colormaps["tab20"](range(20)))]
"""Colours of lines, the second where the first do not go round."""

STYLES = ("-", "--", "-.", ":")
"""Of lines, from one time to the next that they go through all colours."""

MOST_COLUMNS, COLUMN_GAP = 6, 0.2
"""Of the legend; inches between two of them."""

Line = tuple[str, Array, Array]
"""A label, times and values (N,), these in a unit for people."""


def picture(logs: Mapping[str, Log], names: Sequence[str]) -> Figure:
    """One axis per unit and joint for the named channels of all logs; without names, one per channel of the only log.

    logs: by the prefix of their channels in legends; "" for none.
    """
    axes = _axes(logs, names)
    if not axes:
        raise InputError("the log has no channels to plot, or only NaN in them")
    across, cells = _cells(axes, apart=bool(names))
    down = cells[-1] // across + 1
    figure = Figure(figsize=(0.6 + AXIS_WIDTH * across, 0.3 + AXIS_HEIGHT * down), layout="constrained")
    later = {label for lines in axes.values() for label, *_ in lines[1:]} if names else set[str]()
    looks = _looks([_label(name, run) for run in logs for name in names] or next(iter(logs.values())).joints)
    drawn: dict[str, Line2D] = {}
    for cell, ((unit, title), lines) in zip(cells, axes.items(), strict=True):
        axis = figure.add_subplot(down, across, cell + 1)
        drawn = _draw(axis, lines, looks, later) | drawn
        axis.set_title(f"{title} [{unit}]" if unit else title, loc="left", fontsize="medium", parse_math=False)
        if cell + across not in cells:
            axis.set_xlabel("time [s]")
    _explain(figure, {label: drawn[label] for label in looks if label in drawn})
    return figure


def check_beside(beside: Mapping[str, Log], names: Sequence[str]) -> None:
    """Raises InputError for anything but logs by name, and if no channels are named to draw of them."""
    check_kind("plot", "beside", beside, Mapping, "logs by name, such as {'VDC': log}")
    for run, other in beside.items():
        check_kind("plot", "each name in beside", run, str, "a text for the legend")
        if not run:
            raise InputError("plot: a name in beside is empty; name each log, for the legend")
        check_kind("plot", f"beside[{run!r}]", other, Log, "a log")
    if beside and not names:
        raise InputError("plot: name the channels of logs side by side: log.plot('position_error', beside={...})")


def _label(channel: str, run: str) -> str:
    return f"{run}: {channel}" if run else channel


def _cells(axes: dict[tuple[str, str], list[Line]], apart: bool) -> tuple[int, list[int]]:
    """The number of columns, and the cell of each axis, row by row.

    apart: axes of other channels than those before them begin a row.
    """
    shown = [tuple(label for label, *_ in lines) if apart else () for lines in axes.values()]
    most = max(map(shown.count, shown))
    across = -(-most // -(-most // ACROSS))
    cells: list[int] = []
    for k, channels in enumerate(shown):
        begun = k and channels != shown[k - 1]
        cells.append(-(-(cells[-1] + 1) // across) * across if begun else len(cells) and cells[-1] + 1)
    return across, cells


def _looks(labels: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Colour and style of each line."""
    colours = FEW if len(labels) <= len(FEW) else MANY
    return {label: (colours[k % len(colours)], STYLES[k // len(colours) % 4]) for k, label in enumerate(labels)}


def _axes(logs: Mapping[str, Log], names: Sequence[str]) -> dict[tuple[str, str], list[Line]]:
    """The lines of each axis, by its unit and title, in the order of their first line; none where all is NaN."""
    axes: dict[tuple[str, str], list[Line]] = {}
    are_short = all(_are_short(log, names or [*log.channels]) for log in logs.values())
    for run, log in logs.items():
        for name in names or log.channels:
            values = log[name].reshape(log.time.size, -1)
            for column, (joint, unit) in enumerate(log.columns(name)):
                shown, factor = ("mm", 1e3) if unit == "m" and are_short else _for_people(unit)
                title, label = (joint or name, _label(name, run)) if names else (name, joint)
                axes.setdefault((shown, title), []).append((label, log.time, factor * values[:, column]))
    return {key: lines for key, lines in axes.items() if not all(np.isnan(line).all() for *_, line in lines)}


def _are_short(log: Log, names: Sequence[str]) -> bool:
    """Whether all shown lengths are below a metre."""
    for name in names:
        values = log[name].reshape(log.time.size, -1)
        ways = values[:, [unit == "m" for _, unit in log.columns(name)]]
        if (np.abs(ways) >= 1.0).any():
            return False
    return True


def _for_people(unit: str) -> tuple[str, float]:
    """The unit to show and its factor: degrees for angles and their time derivatives."""
    if unit == "rad" or unit.startswith("rad/"):
        return unit.replace("rad", "deg", 1), 180.0 / np.pi
    return unit, 1.0


def _draw(axis: Axes, lines: Sequence[Line], looks: dict[str, tuple[str, str]], later: Set[str]) -> dict[str, Line2D]:
    """Draws the lines in their colours and styles; those labels that are `later` in some axis are dashed in all, to
    show what they cover; a channel without joints is grey among joints."""
    drawn: dict[str, Line2D] = {}
    for label, time, values in lines:
        colour, style = looks.get(label, ("0.2", "-"))
        style = "--" if label in later else style
        (drawn[label],) = axis.plot(time, values, style, color=colour, linewidth=1.0)
    axis.margins(x=0.0)
    low, high = axis.get_ylim()
    if high - low < LEAST_HEIGHT:
        axis.set_ylim(low - LEAST_HEIGHT / 2, high + LEAST_HEIGHT / 2)
    axis.grid(alpha=0.3)
    axis.ticklabel_format(useOffset=False)
    return drawn


def _explain(figure: Figure, drawn: dict[str, Line2D]) -> None:
    """A legend above the axes, in as many columns as the figure is wide for, and room for its rows."""
    if not drawn:
        return
    width, height = figure.get_size_inches()
    alone = _legend(figure, drawn, columns=1)
    widest = _inches(figure, alone)[0] + COLUMN_GAP
    alone.remove()
    legend = _legend(figure, drawn, columns=max(1, min(MOST_COLUMNS, int(width / widest))))
    figure.set_size_inches(max(width, widest), height + _inches(figure, legend)[1])


def _legend(figure: Figure, drawn: dict[str, Line2D], columns: int) -> Legend:
    # names are set afterwards: a legend leaves out those that begin with an underscore
    legend = figure.legend([*drawn.values()], [" "] * len(drawn), loc="outside upper center", ncols=columns)
    for text, name in zip(legend.get_texts(), drawn, strict=True):
        text.set_parse_math(False)
        text.set_text(name)
    return legend


def _inches(figure: Figure, legend: Legend) -> tuple[float, float]:
    """Width and height."""
    box = legend.get_window_extent()
    return box.width / figure.dpi, box.height / figure.dpi

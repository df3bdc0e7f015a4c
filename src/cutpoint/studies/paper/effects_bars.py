"""Each effect's share of the tracking error as bars: unknown to the feedforward, and known."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.reporting.style import LINK, MOTOR, WIDTH
from cutpoint.studies.paper.effects_runs import Share, Shares

_LEAST, _MOST = 1e-2, 3e3
"""Ends of the logarithmic axis, 1e-3 deg; what grows by less than the one, or falls, has its number and no bar."""

_HEIGHT = 0.36
_NAMES = ("feedforward does not know it", "feedforward knows it")


def figure(shares: Shares) -> Figure:
    shown = Figure(figsize=(WIDTH, 5.4), layout="constrained")
    left, right = shown.subplots(1, 2, sharey=True)
    for axes, title, found in ((left, "(a) added to those above", shares.added), (right, "(b) alone", shares.alone)):
        _bars(axes, found)
        axes.set_title(title)
    left.set_yticks(range(len(shares.added)), [*shares.added])
    left.invert_yaxis()
    shown.supxlabel("growth of the arm's RMS tracking error [$10^{-3}$ deg]", fontsize=12)
    shown.legend([*left.containers], _NAMES, loc="outside upper right", ncols=2)
    return shown


def _bars(axes: Axes, shares: Mapping[str, Share]) -> None:
    costs = 1e3 * np.array([share.costs for share in shares.values()])
    for growth, colour, aside in zip(costs.T, (LINK, MOTOR), (-_HEIGHT / 2, _HEIGHT / 2), strict=True):
        at, length = np.arange(len(growth)) + aside, np.maximum(growth, _LEAST)
        axes.barh(at, length, height=_HEIGHT, color=colour)
        for y, end, value in zip(at, length, growth, strict=True):
            where = {"textcoords": "offset points", "va": "center", "fontsize": 10}
            axes.annotate(_short(value), (float(end), float(y)), (4, 0), **where)
    axes.set(xscale="log", xlim=(_LEAST, _MOST))
    axes.set_axisbelow(True)
    axes.minorticks_off()
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0, labelsize=11)


def _short(value: float) -> str:
    """Two digits, as far as they are worth it."""
    if abs(value) < 0.1 * _LEAST:
        return "0"
    return f"{float(f'{value:.2g}'):g}".replace("-", "−")

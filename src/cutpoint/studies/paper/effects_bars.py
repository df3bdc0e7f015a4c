"""Each effect's share of the tracking error as bars: unknown to the feedforward, and known."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.studies.paper.effects_runs import Share, Shares
from cutpoint.studies.report.page import number
from cutpoint.studies.style import FAINT, LINK, MOTOR, WIDTH

_LEAST = 1e-2
"""Where the logarithmic axis begins, 1e-3 deg; what grows by less has no bar, and its number beside the axis."""

_HIGH = 0.36


def figure(shares: Shares) -> Figure:
    shown = Figure(figsize=(WIDTH, 5.4), layout="constrained")
    left, right = shown.subplots(1, 2, sharey=True, sharex=True)
    _bars(left, shares.added)
    _bars(right, shares.alone)
    left.set(title="(a) added to those above", yticks=range(len(shares.added)), yticklabels=[*shares.added])
    left.invert_yaxis()
    right.set(title="(b) alone")
    shown.supxlabel("growth of the arm's RMS tracking error [$10^{-3}$ deg]", fontsize=12)
    handles = [left.containers[0], left.containers[1]]
    shown.legend(handles, ["feedforward does not know it", "feedforward knows it"], loc="outside upper right", ncols=2)
    return shown


def _bars(axes: Axes, shares: Mapping[str, Share]) -> None:
    at = np.arange(len(shares))
    costs = 1e3 * np.array([share.costs for share in shares.values()])
    for costs_so, colour, aside in zip(costs.T, (LINK, MOTOR), (-_HIGH / 2, _HIGH / 2), strict=True):
        axes.barh(at + aside, np.maximum(costs_so, _LEAST), height=_HIGH, color=colour)
        for y, cost in zip(at + aside, costs_so, strict=True):
            end = (max(cost, _LEAST), float(y))
            text = f"{cost:.3g}".replace("-", "−") if abs(cost) >= 1e-3 else "0"
            axes.annotate(text, end, (4, 0), textcoords="offset points", va="center", fontsize=10)
    axes.set(xscale="log", xlim=(_LEAST, 3e3))
    axes.grid(visible=False, axis="y")
    axes.grid(visible=False, which="minor")
    axes.spines["left"].set_color(FAINT)
    axes.tick_params(axis="y", length=0, labelsize=11)


__all__ = ["figure", "number"]

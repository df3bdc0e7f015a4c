"""Figure 6: the arm to scale with the frames of its joints, at zero and at the end of (57)."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d import Axes3D, proj3d

from cutpoint.arrays import Array
from cutpoint.reporting.style import INK, LINK, WIDTH
from cutpoint.robots import xia2019_mechanism
from cutpoint.studies.paper.arm_view import draw_arm, draw_legend, view
from cutpoint.studies.paper.chain import Chain, chain_of
from cutpoint.studies.paper.printed import GOAL, LENGTHS

Label = tuple[int, float, float]
"""At which corner of the arm, and how far from it on paper, in points."""

_ROOM = ((-0.25, -0.5, 0.0), (1.25, 0.75, 1.0))
_AT_ZERO: dict[str, Label] = {
    "{B$_1$}": (0, -26, -4),
    "{B$_2$}": (1, -26, 4),
    "{B$_3$}, {B$_4$}": (2, -2, 44),
    "{B$_5$}, {B$_6$}": (3, 4, 44),
    "{O}": (4, 16, -4),
}
_AT_GOAL: dict[str, Label] = {
    "{B$_1$}": (0, -26, -4),
    "{B$_2$}": (1, -40, -8),
    "{B$_3$}, {B$_4$}": (2, -52, -2),
    "{B$_5$}, {B$_6$}": (3, 46, -14),
    "{O}": (4, 16, -4),
}


def figure_6() -> Figure:
    figure = Figure(figsize=(WIDTH, 4.6))
    chain = chain_of(xia2019_mechanism())
    _panel(figure, 0.0, "(a)  q = 0, where (57) starts", chain, np.zeros(6), _AT_ZERO, lengths=True)
    _panel(figure, 0.5, "(b)  where (57) ends", chain, GOAL, _AT_GOAL, lengths=False)
    draw_legend(figure)
    return figure


def _panel(
    figure: Figure, left: float, title: str, chain: Chain, q: Array, labels: dict[str, Label], lengths: bool
) -> None:
    axes = view(figure, (left, 0.06, 0.5, 0.88), _ROOM, zoom=1.36)
    corners = draw_arm(axes, chain, q)
    for name, (corner, right, up) in labels.items():
        _label(axes, corners[corner], name, right, up, INK)
    if lengths:
        for start, end, name in zip(corners[:-1], corners[1:], LENGTHS, strict=True):
            _label(axes, (start + end) / 2, f"${name}$", *((12, 0) if start[2] != end[2] else (8, -14)), LINK)
    figure.text(left + 0.03, 0.93, title, weight="bold")


def _label(axes: Axes3D, at: Array, words: str, right: float, up: float, colour: str) -> None:
    x, y, _ = proj3d.proj_transform(at[0], at[1], at[2], axes.get_proj())
    halo = [withStroke(linewidth=3, foreground="white")]
    offset = {"xytext": (right, up), "textcoords": "offset points", "ha": "center", "va": "center"}
    axes.annotate(words, (float(x), float(y)), color=colour, path_effects=halo, zorder=50, **offset)

"""Figure 6: the arm to scale with the frames of its joints, at zero and at the end of (57)."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d import Axes3D, proj3d

from cutpoint.robots import xia2019_mechanism
from cutpoint.studies.chain import Array, Chain, chain_of, places
from cutpoint.studies.paper.printed import GOAL, LENGTHS
from cutpoint.studies.style import FAINT, HAIR, INK, LINK, MOTOR, SPRING, WIDTH

Label = tuple[int, float, float]
"""At which corner of the arm, and how far from it on paper, in points."""

_TRIAD = 0.12  # m
_ZOOM: Any = 1.36  # matplotlib calls it an int, and takes any number
_COLOURS = (FAINT, SPRING, MOTOR)
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
    _legend(figure)
    return figure


def _panel(
    figure: Figure, left: float, title: str, chain: Chain, q: Array, labels: dict[str, Label], lengths: bool
) -> None:
    axes = figure.add_axes((left, 0.06, 0.5, 0.88), projection="3d")
    assert isinstance(axes, Axes3D)
    _room(axes)
    corners = _arm(axes, chain, q)
    for name, (corner, right, up) in labels.items():
        _label(axes, corners[corner], name, right, up, INK)
    if lengths:
        for start, end, name in zip(corners[:-1], corners[1:], LENGTHS, strict=True):
            _label(axes, (start + end) / 2, f"${name}$", *((12, 0) if start[2] != end[2] else (8, -14)), LINK)
    figure.text(left + 0.03, 0.93, title, weight="bold")


def _room(axes: Axes3D) -> None:
    """The floor alone, ruled every quarter of a metre."""
    low, high = np.array([-0.25, -0.5, 0.0]), np.array([1.25, 0.75, 1.0])
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(tuple(high - low), zoom=_ZOOM)
    axes.view_init(elev=22, azim=-58)
    axes.set_axis_off()
    for x in np.arange(low[0], high[0] + 0.1, 0.25):
        axes.plot([x, x], [low[1], high[1]], [0, 0], color=HAIR, lw=0.7)
    for y in np.arange(low[1], high[1] + 0.1, 0.25):
        axes.plot([low[0], high[0]], [y, y], [0, 0], color=HAIR, lw=0.7)


def _arm(axes: Axes3D, chain: Chain, q: Array) -> Array:
    """Draws it; where it has corners, (5, 3): base, shoulder, elbow, wrist, tool."""
    at = places(chain, q)
    tool = at.origins[5] + LENGTHS["l_4"] * at.rotations[5][:, 2]
    corners = np.vstack([at.origins[[0, 1, 2, 4]], tool])
    axes.plot(corners[:, 0], corners[:, 1], 0 * corners[:, 2], color=HAIR, lw=5, solid_joinstyle="round")
    axes.plot(*corners.T, color=LINK, lw=7, alpha=0.3, solid_joinstyle="round")
    axes.plot(*at.centroids.T, "x", color=INK, ms=6, mew=1.6, ls="none")
    for R, origin in zip(at.rotations, at.origins, strict=True):
        for column, colour in enumerate(_COLOURS):
            axes.quiver(*origin, *(_TRIAD * R[:, column]), color=colour, lw=1.6, arrow_length_ratio=0.25)
    axes.plot(*corners[:-1].T, "o", mec=INK, mfc="white", ms=7, ls="none")
    return corners


def _label(axes: Axes3D, at: Array, words: str, right: float, up: float, colour: str) -> None:
    x, y, _ = proj3d.proj_transform(at[0], at[1], at[2], axes.get_proj())
    halo = [withStroke(linewidth=3, foreground="white")]
    offset = {"xytext": (right, up), "textcoords": "offset points", "ha": "center", "va": "center"}
    axes.annotate(words, (float(x), float(y)), color=colour, path_effects=halo, zorder=50, **offset)


def _legend(figure: Figure) -> None:
    lines = [Line2D([], [], color=colour, lw=2) for colour in _COLOURS]
    lines.append(Line2D([], [], color=INK, marker="x", ls="none", mew=1.6))
    names = ["$x$", "$y$", "$z$: the joint's axis", "centroid of a link"]
    figure.legend(lines, names, loc="lower center", ncols=4)

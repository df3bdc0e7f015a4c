"""The arm to scale in a room, with the frames of its joints."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D

from cutpoint.arrays import Array
from cutpoint.reporting.style import FAINT, HAIR, INK, LINK, MOTOR, SPRING
from cutpoint.studies.paper.chain import Chain, places
from cutpoint.studies.paper.printed import LENGTHS

Room = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Lowest and highest x, y, z of what is seen, m; x and y in quarters."""

_TRIAD = 0.12  # m
_COLOURS = (FAINT, SPRING, MOTOR)


def view(figure: Figure, where: tuple[float, float, float, float], room: Room, zoom: Any) -> Axes3D:
    """Axes at (left, bottom, width, height) of the figure: the floor alone, ruled every quarter of a metre.

    zoom: how large; matplotlib calls it an int, and takes any number.
    """
    axes = figure.add_axes(where, projection="3d")
    assert isinstance(axes, Axes3D)
    low, high = np.array(room)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(tuple(high - low), zoom=zoom)
    axes.view_init(elev=22, azim=-58)
    axes.set_axis_off()
    for x in np.arange(low[0], high[0] + 0.1, 0.25):
        axes.plot([x, x], [low[1], high[1]], [0, 0], color=HAIR, lw=0.7)
    for y in np.arange(low[1], high[1] + 0.1, 0.25):
        axes.plot([low[0], high[0]], [y, y], [0, 0], color=HAIR, lw=0.7)
    return axes


def draw_arm(axes: Axes3D, chain: Chain, q: Array) -> Array:
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


def draw_legend(figure: Figure) -> None:
    lines = [Line2D([], [], color=colour, lw=2) for colour in _COLOURS]
    lines.append(Line2D([], [], color=INK, marker="x", ls="none", mew=1.6))
    names = ["$x$", "$y$", "$z$: the joint's axis", "centroid of a link"]
    figure.legend(lines, names, loc="lower center", ncols=4)

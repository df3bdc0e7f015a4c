"""Pencils for schematic drawings: canvas, boxes, arrows, springs, frames, brackets.  One unit is half an inch."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from matplotlib.patheffects import withStroke

from cutpoint.reporting.style import FAINT, INK

Point = tuple[float, float]

_INCHES = 0.5
_LINE = 1.4


def canvas(width: float, height: float) -> tuple[Figure, Axes]:
    """An empty sheet; coordinates go from (0, 0), lower left, to (width, height)."""
    figure = Figure(figsize=(width * _INCHES, height * _INCHES))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, width), ylim=(0, height), aspect="equal")
    axes.axis("off")
    return figure, axes


def text(axes: Axes, at: Point, words: str, **style: Any) -> None:
    """Words centred at a point."""
    axes.text(*at, words, **{"ha": "center", "va": "center", "linespacing": 1.35, **style})


def box(axes: Axes, corner: Point, size: Point, words: str, edge: str, fill: str) -> None:
    """A block with rounded corners and words in it; corner is the lower left one."""
    patch = FancyBboxPatch(corner, *size, boxstyle="round,pad=0,rounding_size=0.12", ec=edge, fc=fill, lw=1.3, zorder=3)
    axes.add_patch(patch)
    text(axes, (corner[0] + size[0] / 2, corner[1] + size[1] / 2), words, zorder=4)


def arrow(axes: Axes, start: Point, end: Point, colour: str, width: float = _LINE, **style: Any) -> None:
    """A straight arrow."""
    options = {"arrowstyle": "-|>", "mutation_scale": 11, "shrinkA": 0, "shrinkB": 0, "zorder": 5, **style}
    axes.add_patch(FancyArrowPatch(start, end, color=colour, lw=width, **options))


def path(axes: Axes, points: list[Point], colour: str = INK) -> None:
    """A polyline with an arrow head at its end."""
    x, y = zip(*points[:-1], strict=True)
    axes.plot(x, y, color=colour, lw=_LINE, solid_capstyle="butt", zorder=2)
    arrow(axes, points[-2], points[-1], colour)


def turn(axes: Axes, centre: Point, colour: str, size: Point) -> None:
    """A turning about the horizontal axis, right-handed to the right: an open ellipse with a head."""
    angle = np.deg2rad(np.linspace(235, -60, 60))
    points = np.array(centre) + 0.5 * np.array(size) * np.column_stack([np.cos(angle), np.sin(angle)])
    axes.plot(*points[:-2].T, color=colour, lw=1.5, zorder=7)
    arrow(axes, tuple(points[-6]), tuple(points[-1]), colour, 1.5, zorder=7, mutation_scale=10)


def spring(axes: Axes, start: Point, end: Point, colour: str, turns: int = 6) -> None:
    """A zigzag between two points, with a straight lead at either end."""
    a, b = np.array(start), np.array(end)
    along = (b - a) / np.linalg.norm(b - a)
    across = np.array([-along[1], along[0]])
    at = np.linspace(0.18, 0.82, 2 * turns + 1)
    side = np.r_[0, np.resize([1, -1], 2 * turns - 1), 0]
    zigzag = a + at[:, None] * (b - a) + 0.28 * side[:, None] * across
    points = np.vstack([a, zigzag, b])
    axes.plot(*points.T, color=colour, lw=1.7, solid_joinstyle="round", zorder=3)


def ground(axes: Axes, centre: Point, width: float = 1.2) -> None:
    """Fixed to the world: a line with strokes below it."""
    x, y = centre
    axes.plot([x - width / 2, x + width / 2], [y, y], color=INK, lw=1.4, zorder=3)
    for k in np.linspace(-width / 2, width / 2 - 0.15, max(4, int(width / 0.22))):
        axes.plot([x + k, x + k + 0.16], [y - 0.2, y], color=INK, lw=0.8, zorder=3)


def span(axes: Axes, left: float, right: float, y: float, words: str) -> None:
    """A dimension between two abscissae, words above it."""
    arrow(axes, (left, y), (right, y), INK, 1.0, arrowstyle="<|-|>", mutation_scale=9)
    for x in (left, right):
        axes.plot([x, x], [y - 0.16, y + 0.16], color=INK, lw=0.8)
    text(axes, ((left + right) / 2, y + 0.32), words, color=INK)


def leader(axes: Axes, at: Point, words_at: Point, words: str, colour: str) -> None:
    """Words with a thin line to what they name, ending in a dot."""
    axes.plot([at[0], words_at[0]], [at[1], words_at[1]], color=FAINT, lw=0.8, zorder=8)
    axes.plot(*at, "o", ms=3, color=INK, zorder=9)
    text(axes, words_at, words, color=colour, va="bottom" if words_at[1] > at[1] else "top", zorder=9)


def triad(axes: Axes, origin: Point, name: str, colour: str, length: float = 0.95) -> None:
    """A frame seen from the side: z along the joint's axis to the right, x up, y towards the reader."""
    x, y = origin
    arrow(axes, origin, (x + length, y), colour, 1.8, zorder=10)
    arrow(axes, origin, (x, y + length), colour, 1.8, zorder=10)
    axes.plot(x, y, "o", ms=9, mfc="white", mec=colour, mew=1.5, zorder=11)
    axes.plot(x, y, "o", ms=3, color=colour, zorder=12)
    halo = {"color": colour, "zorder": 12, "path_effects": [withStroke(linewidth=3, foreground="white")]}
    text(axes, (x + length + 0.2, y + 0.02), "$z$", **halo)
    text(axes, (x, y + length + 0.22), "$x$", **halo)
    text(axes, (x + 0.52, y + 0.5), f"{{{name}}}", weight="bold", **halo)

"""Figure 1: where a joint's flexibility comes from, and what it does."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon

from cutpoint.reporting.style import BASE, BASE_FILL, FAINT, FORCE, INK, LINK, LINK_FILL, MOTOR, MOTOR_FILL, SPRING
from cutpoint.studies.paper.drawing import arrow, box, canvas, ground, leader, spring, text

_Q, _THETA = 14.0, 36.0  # degrees: link and motor in the drawing, far more apart than they ever are


def figure_1() -> Figure:
    figure, axes = canvas(18, 7.2)
    _cause(axes)
    _effect(axes)
    return figure


def _cause(axes: Axes) -> None:
    text(axes, (0.3, 6.75), "(a) cause: the reducer bends", ha="left", weight="bold")
    box(axes, (0.4, 3.1), (1.9, 1.6), "motor\nrotor", MOTOR, MOTOR_FILL)
    box(axes, (3.3, 3.1), (1.2, 1.6), "gear\n$\\ell:1$", BASE, BASE_FILL)
    axes.plot([2.3, 3.3], [3.9, 3.9], color=MOTOR, lw=5, solid_capstyle="butt")
    spring(axes, (4.5, 3.9), (7.1, 3.9), SPRING)
    box(axes, (7.1, 3.1), (1.9, 1.6), "output\nlink", LINK, LINK_FILL)
    ground(axes, (3.9, 2.3))
    axes.plot([3.9, 3.9], [2.3, 3.1], color=INK, lw=1.4)
    text(axes, (1.35, 5.2), "turns by $\\ell\\,\\theta$", color=MOTOR)
    text(axes, (3.9, 5.2), "$\\theta$", color=MOTOR)
    text(axes, (8.05, 5.2), "turns by $q$", color=LINK)
    leader(axes, (5.8, 3.65), (6.3, 2.5), "flexspline and\nwave generator of\nthe harmonic drive", SPRING)


def _effect(axes: Axes) -> None:
    text(axes, (10.0, 6.75), "(b) effect: motor and link disagree", ha="left", weight="bold")
    centre = np.array([11.0, 2.2])
    axes.plot([centre[0], centre[0] + 6.6], [centre[1], centre[1]], color=FAINT, lw=0.8, ls=(0, (6, 4)))
    _arm(axes, centre, _THETA, MOTOR, "none", "--")
    tip = _arm(axes, centre, _Q, LINK, LINK_FILL, "-")
    axes.add_patch(Circle(tuple(centre), 0.5, ec=INK, fc="white", lw=1.3, zorder=6))
    axes.plot(*centre, "o", ms=4, color=INK, zorder=7)
    axes.add_patch(Polygon([(10.5, 1.35), (11.5, 1.35), (11.3, 1.85), (10.7, 1.85)], ec=INK, fc=BASE_FILL, zorder=2))
    ground(axes, (centre[0], 1.35), 1.5)
    _angle(axes, centre, 5.1, 0, _Q, "$q$", LINK)
    _angle(axes, centre, 5.1, _Q, _THETA, "$\\Delta\\theta$", SPRING)
    _angle(axes, centre, 6.1, 0, _THETA, "$\\theta$", MOTOR)
    arrow(axes, (tip[0] - 0.2, tip[1] - 0.1), (tip[0] - 0.2, 1.35), FORCE, 2.0)
    text(axes, (tip[0], 1.55), "load", color=FORCE, ha="left")
    text(axes, (14.0, 5.55), "where the motor says it is", color=MOTOR)
    text(axes, (13.3, 1.65), "where the link is", color=LINK)
    text(axes, (13.6, 0.55), "drawn far too large: of this arm, a tenth of a degree at most", fontsize=11)


def _arm(axes: Axes, centre: np.ndarray, degrees: float, edge: str, fill: str, line: str) -> np.ndarray:
    """A link from the joint's centre; its tip."""
    along = np.array([np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))])
    across = np.array([-along[1], along[0]])
    corners = [centre + 0.34 * across, centre + 4.6 * along + 0.2 * across]
    corners += [centre + 4.6 * along - 0.2 * across, centre - 0.34 * across]
    axes.add_patch(Polygon(corners, ec=edge, fc=fill, lw=1.4, ls=line, zorder=4))
    return centre + 4.4 * along


def _angle(axes: Axes, centre: np.ndarray, radius: float, start: float, end: float, words: str, colour: str) -> None:
    axes.add_patch(Arc(tuple(centre), 2 * radius, 2 * radius, theta1=start, theta2=end, color=colour, lw=1.3, zorder=8))
    tip = np.deg2rad(end)
    on = centre + radius * np.array([np.cos(tip), np.sin(tip)])
    back = on + 0.12 * np.array([np.sin(tip), -np.cos(tip)])
    arrow(axes, tuple(back), tuple(on), colour, 1.3, zorder=8)
    middle = np.deg2rad((start + end) / 2)
    at = centre + (radius + 0.18) * np.array([np.cos(middle), np.sin(middle)])
    text(axes, tuple(at), words, color=colour, ha="left", zorder=9, bbox={"fc": "white", "ec": "none", "pad": 0.6})

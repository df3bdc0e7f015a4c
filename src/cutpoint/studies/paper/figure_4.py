"""Figure 4: the three bodies of a flexible joint, their frames, and the two cutting points."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.reporting.style import BASE, INK, LINK, MOTOR, SPRING
from cutpoint.studies.paper import section
from cutpoint.studies.paper.drawing import canvas, leader, text, triad, turn

_AXIS = 4.6


def figure_4() -> Figure:
    figure, axes = canvas(18, 9.2)
    at = section.placed(axes, (2.4, _AXIS), 1.08)
    for part in (section.base, section.output, section.bearing, section.flexspline, section.rotor):
        part(axes, at)
    axes.plot([1.3, 16.2], [_AXIS, _AXIS], color="#555555", lw=0.8, ls=(0, (10, 3, 2, 3)), zorder=3)
    triad(axes, (5.0, _AXIS), "B", BASE)
    triad(axes, (8.3, _AXIS), "D", MOTOR)
    triad(axes, (12.4, _AXIS), "T", LINK)
    _cuts(axes)
    _names(axes)
    return figure


def _cuts(axes: Axes) -> None:
    for x in (2.1, 15.3):
        axes.plot([x, x], [_AXIS - 3.0, _AXIS + 3.0], color=INK, lw=1.4, ls=(0, (5, 3)))
    text(axes, (2.1, _AXIS + 3.2), "driven cutting point:\nto the link before", va="bottom")
    text(axes, (15.3, _AXIS + 3.2), "driving cutting point:\nto the link after", va="bottom")


def _names(axes: Axes) -> None:
    leader(axes, (5.0, _AXIS + 2.65), (5.6, 8.0), "joint base, {B}:\n${}^B\\mathbf{V}$", BASE)
    leader(
        axes,
        (10.3, _AXIS + 1.0),
        (9.7, 8.0),
        "motor rotor, {D}:  (4)\n${}^D\\mathbf{V} = z_\\tau \\ell\\dot\\theta + {}^B\\mathbf{U}_D^T\\,{}^B\\mathbf{V}$",
        MOTOR,
    )
    leader(
        axes,
        (11.35, _AXIS - 1.8),
        (12.2, 1.35),
        "output link, {T}:  (5)\n${}^T\\mathbf{V} = z_\\tau \\dot q + {}^B\\mathbf{U}_T^T\\,{}^B\\mathbf{V}$",
        LINK,
    )
    leader(axes, (9.6, _AXIS - 1.42), (7.6, 1.2), "flexspline: bends,\nwithout mass of its own", SPRING)
    turn(axes, (3.9, _AXIS), MOTOR, (0.5, 1.1))
    turn(axes, (14.4, _AXIS), LINK, (0.6, 1.7))
    text(axes, (3.9, _AXIS - 0.95), "$\\ell\\dot\\theta$", color=MOTOR, zorder=12)
    text(axes, (14.4, _AXIS - 1.2), "$\\dot q$", color=LINK)

"""Figure 2: the joint cut along its axis, and which encoder sees what."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.reporting.style import BASE, LINK, MOTOR, SPRING
from cutpoint.studies.paper import section
from cutpoint.studies.paper.drawing import canvas, leader, text


def figure_2() -> Figure:
    figure, axes = canvas(18, 9.4)
    at = section.placed(axes, (2.4, 4.5), 1.08)
    axes.plot([2.4, 15.8], [4.5, 4.5], color="#555555", lw=0.8, ls=(0, (10, 3, 2, 3)), zorder=9)
    for part in (section.base, section.output, section.bearing, section.flexspline, section.rotor):
        part(axes, at)
    section.encoder(axes, at, 1.35, MOTOR)
    section.encoder(axes, at, 10.6, LINK)
    _names_above(axes)
    _names_below(axes)
    return figure


def _names_above(axes: Axes) -> None:
    leader(axes, (3.86, 5.8), (2.2, 7.6), "motor-side encoder\n$\\theta_w = \\ell\\,\\theta$", MOTOR)
    leader(axes, (6.8, 6.6), (6.1, 8.0), "stator", BASE)
    leader(axes, (9.0, 5.95), (8.7, 8.0), "flexspline, its rim\nfixed to the base: $\\theta_f$", SPRING)
    leader(axes, (10.6, 6.4), (12.4, 8.0), "circular spline,\nturns with the link: $\\theta_c$", LINK)
    leader(axes, (13.85, 5.8), (16.0, 7.0), "link-side encoder\n$\\theta_c = q$", LINK)


def _names_below(axes: Axes) -> None:
    leader(axes, (4.7, 2.2), (2.6, 1.3), "joint base\n(housing)", BASE)
    leader(axes, (6.8, 3.6), (6.2, 1.3), "motor rotor", MOTOR)
    leader(axes, (10.3, 3.7), (9.9, 1.3), "wave generator\non the motor's shaft: $\\theta_w$", MOTOR)
    leader(axes, (14.3, 4.2), (14.6, 2.4), "output link", LINK)
    text(axes, (17.7, 0.7), "(1)   $\\theta_w = (\\ell+1)\\,\\theta_c - \\ell\\,\\theta_f$", ha="right")

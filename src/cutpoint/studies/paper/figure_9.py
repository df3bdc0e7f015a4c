"""Figure 9: the feedforward compensator and the loop around the bending drive, with sides and units."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from cutpoint.reporting.style import BASE, BASE_FILL, INK, LINK, LINK_FILL, MOTOR, MOTOR_FILL, SPRING, SPRING_FILL
from cutpoint.studies.paper.drawing import arrow, box, canvas, path, text

_ROW = 3.6


def figure_9() -> Figure:
    figure, axes = canvas(20, 9.0)
    _grounds(axes)
    _blocks(axes)
    _forward(axes)
    _feedback(axes)
    return figure


def _grounds(axes: Axes) -> None:
    """What runs in the computer once a control period, and what the physics does."""
    for corner, size, words in (
        ((0.2, 0.3), (12.1, 8.4), "computer, every 1 ms"),
        ((12.7, 0.3), (7.1, 8.4), "plant, continuous"),
    ):
        axes.add_patch(Rectangle(corner, *size, fc="#f7f8fa", ec="none", zorder=0))
        text(axes, (corner[0] + 0.25, corner[1] + size[1] - 0.4), words, ha="left", color=BASE, style="italic")


def _blocks(axes: Axes) -> None:
    box(axes, (0.5, _ROW - 0.8), (2.1, 1.6), "trajectory\n(57)", BASE, BASE_FILL)
    box(
        axes,
        (4.4, 5.6),
        (4.2, 1.9),
        "VD feedforward\n(29)–(31), (44)–(47), (54)\nthrough the drive: (2)",
        BASE,
        BASE_FILL,
    )
    box(axes, (8.2, _ROW - 0.8), (1.9, 1.6), "PD\n(58)", BASE, BASE_FILL)
    box(axes, (13.0, _ROW - 0.8), (1.8, 1.6), "motor\nrotor", MOTOR, MOTOR_FILL)
    box(axes, (15.5, _ROW - 0.8), (1.7, 1.6), "drive\n(2)", SPRING, SPRING_FILL)
    box(axes, (17.9, _ROW - 0.8), (1.6, 1.6), "links", LINK, LINK_FILL)
    for x, y in ((6.6, _ROW), (11.3, _ROW)):
        axes.add_patch(Circle((x, y), 0.28, ec=INK, fc="white", lw=1.3, zorder=5))


def _forward(axes: Axes) -> None:
    path(axes, [(2.6, _ROW), (3.4, _ROW), (3.4, 6.55), (4.4, 6.55)])
    text(axes, (3.25, 5.2), "$q_d$ to $q_d^{(4)}$\nrad/s$^k$", ha="right", color=LINK)
    path(axes, [(6.6, 5.6), (6.6, _ROW + 0.28)], MOTOR)
    text(axes, (6.75, 4.75), "$\\theta_d,\\ \\dot\\theta_d$\nrad, rad/s", ha="left", color=MOTOR)
    path(axes, [(6.88, _ROW), (8.2, _ROW)], MOTOR)
    text(axes, (7.5, _ROW + 0.35), "$\\tilde\\theta$", color=MOTOR)
    path(axes, [(10.1, _ROW), (11.02, _ROW)], MOTOR)
    text(axes, (10.55, _ROW + 0.45), "$\\tau_e$\nN m", color=MOTOR, fontsize=11, va="bottom", linespacing=1.1)
    path(axes, [(8.6, 6.55), (11.3, 6.55), (11.3, _ROW + 0.28)], MOTOR)
    text(axes, (9.95, 6.95), "$\\tau_m$, N m", color=MOTOR)
    path(axes, [(11.58, _ROW), (13.0, _ROW)], MOTOR)
    text(axes, (12.15, _ROW + 0.45), "$\\tau$", color=MOTOR)
    path(axes, [(14.8, _ROW), (15.5, _ROW)], MOTOR)
    text(axes, (15.15, _ROW + 0.4), "$\\theta$", color=MOTOR)
    path(axes, [(17.2, _ROW), (17.9, _ROW)], LINK)
    text(axes, (17.55, _ROW + 0.4), "$\\tau_f$", color=LINK)
    path(axes, [(18.7, _ROW + 0.8), (18.7, 5.4), (16.35, 5.4), (16.35, _ROW + 0.8)], LINK)
    text(axes, (17.5, 5.75), "$q$, rad", color=LINK)
    path(axes, [(15.9, _ROW - 0.8), (15.9, 2.2), (13.9, 2.2), (13.9, _ROW - 0.8)], SPRING)
    text(axes, (14.9, 1.85), "$-\\tau_f$", color=SPRING)
    arrow(axes, (18.7, 1.9), (18.7, _ROW - 0.8), LINK)
    text(axes, (18.7, 1.5), "friction (54)", color=LINK)


def _feedback(axes: Axes) -> None:
    path(axes, [(13.35, _ROW - 0.8), (13.35, 1.75), (6.6, 1.75), (6.6, _ROW - 0.28)], MOTOR)
    text(axes, (9.4, 2.1), "motor-side encoder $\\theta,\\ \\dot\\theta$: rad, rad/s", color=MOTOR)
    for x, y, sign in (
        (6.32, _ROW - 0.55, "$-$"),
        (6.32, _ROW + 0.5, "$+$"),
        (10.9, _ROW - 0.4, "$+$"),
        (11.05, _ROW + 0.5, "$+$"),
    ):
        text(axes, (x, y), sign, fontsize=11)
    text(
        axes,
        (0.5, 0.95),
        "blue: motor's side, orange: link's side; all angles and torques\n"
        "referred to the joint: rotor angle / $\\ell$, shaft torque $\\times\\ \\ell$",
        ha="left",
        fontsize=11,
    )

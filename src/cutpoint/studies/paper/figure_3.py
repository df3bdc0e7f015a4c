"""Figure 3: where the drive bends, and the one spring that is left of it at the joint's side."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from cutpoint.reporting.style import BASE, BASE_FILL, FORCE, INK, LINK, LINK_FILL, MOTOR, MOTOR_FILL, SPRING
from cutpoint.studies.paper.drawing import arrow, box, canvas, ground, span, spring, text


def figure_3() -> Figure:
    figure, axes = canvas(18, 10.6)
    _drive(axes, 7.0)
    _at_the_joint(axes, 2.0)
    return figure


def _drive(axes: Axes, y: float) -> None:
    text(
        axes,
        (0.3, y + 3.2),
        "(a) the drive: the wave generator bends on the motor's side, the flexspline on the link's",
        ha="left",
        weight="bold",
    )
    _shaft(axes, 1.9, 3.0, y, MOTOR)
    _shaft(axes, 13.9, 15.4, y, LINK)
    box(axes, (0.4, y - 0.8), (1.7, 1.6), "rotor\n$J_r$", MOTOR, MOTOR_FILL)
    spring(axes, (3.0, y), (6.0, y), MOTOR)
    _shaft(axes, 6.0, 7.4, y, MOTOR)
    box(axes, (7.4, y - 0.8), (2.4, 1.6), "ideal gear\n$\\ell:1$", BASE, BASE_FILL)
    _shaft(axes, 9.8, 10.9, y, LINK)
    spring(axes, (10.9, y), (13.9, y), SPRING)
    box(axes, (15.4, y - 0.8), (1.7, 1.6), "output\nlink", LINK, LINK_FILL)
    text(axes, (4.5, y - 0.8), "wave generator $K_w(\\tau_w)$", color=MOTOR)
    text(axes, (12.4, y - 0.8), "flexspline $K_f(\\tau_f)$", color=SPRING)
    _encoder(axes, 2.55, y, "$\\theta_w$", MOTOR)
    _encoder(axes, 14.65, y, "$\\theta_c$", LINK)
    _friction(axes, 8.6, y)
    _torque(axes, 6.25, 7.15, y + 0.75, "$\\tau_w$")
    _torque(axes, 9.95, 10.85, y + 0.75, "$\\tau_f=\\ell\\,\\tau_w$")
    span(
        axes,
        2.55,
        14.65,
        y + 1.85,
        "$\\Delta\\theta = \\theta_w/\\ell - \\theta_c$,  both encoders read at the joint's side",
    )


def _at_the_joint(axes: Axes, y: float) -> None:
    text(axes, (0.3, y + 2.1), "(b) the same, all of it at the joint's side", ha="left", weight="bold")
    box(axes, (0.4, y - 0.8), (3.2, 1.6), "rotor, reflected\n$\\ell^2 J_r = \\ell I_m$", MOTOR, MOTOR_FILL)
    _shaft(axes, 3.6, 4.6, y, MOTOR)
    spring(axes, (4.6, y), (8.6, y), SPRING, turns=8)
    _shaft(axes, 8.6, 9.6, y, LINK)
    box(axes, (9.6, y - 0.8), (1.9, 1.6), "output\nlink", LINK, LINK_FILL)
    text(axes, (4.1, y + 0.5), "$\\theta$", color=MOTOR)
    text(axes, (9.1, y + 0.5), "$q$", color=LINK)
    text(axes, (6.6, y - 0.85), "$\\tau_f(\\theta-q)$", color=SPRING)
    text(axes, (12.1, y + 0.75), "(2)   $\\tau_f=\\tan(c_f K_{f0}\\,\\Delta\\theta_f)\\,/\\,c_f$", ha="left")
    text(axes, (12.1, y - 0.1), "at rest   $1/K = 1/K_{f0} + 1/(\\ell^2 K_{w0})$", ha="left")
    text(
        axes,
        (12.1, y - 0.95),
        "here $K_{w0}=\\infty$: a catalogue's stiffness\nis that of both in series",
        ha="left",
        va="center",
        fontsize=11,
    )


def _shaft(axes: Axes, left: float, right: float, y: float, colour: str) -> None:
    axes.plot([left, right], [y, y], color=colour, lw=4, solid_capstyle="butt", zorder=2)


def _encoder(axes: Axes, x: float, y: float, angle: str, colour: str) -> None:
    axes.add_patch(Ellipse((x, y), 0.28, 1.2, ec=colour, fc="white", lw=1.6, zorder=6))
    text(axes, (x, y - 0.95), angle, color=colour, fontsize=14)


def _torque(axes: Axes, left: float, right: float, y: float, words: str) -> None:
    arrow(axes, (left, y - 0.3), (right, y - 0.3), FORCE)
    text(axes, ((left + right) / 2, y + 0.1), words, color=FORCE)


def _friction(axes: Axes, x: float, y: float) -> None:
    """A damper from the gear to the base."""
    axes.plot([x, x], [y - 0.8, y - 1.15], color=INK, lw=1.4)
    axes.plot([x - 0.3, x - 0.3, x + 0.3, x + 0.3], [y - 1.65, y - 1.05, y - 1.05, y - 1.65], color=INK, lw=1.4)
    axes.plot([x - 0.2, x + 0.2], [y - 1.35, y - 1.35], color=INK, lw=1.4)
    axes.plot([x, x], [y - 1.35, y - 1.95], color=INK, lw=1.4)
    ground(axes, (x, y - 1.95))
    text(axes, (x + 0.5, y - 1.4), "friction $\\tau_{ff}$", ha="left")

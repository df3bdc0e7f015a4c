"""Figure 5: the free bodies of a flexible joint, with the forces of eqs. (9)-(11)."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.reporting.style import BASE, FORCE, LINK, MOTOR
from cutpoint.studies.paper import section
from cutpoint.studies.paper.drawing import arrow, canvas, text, triad

_AXIS, _SCALE = 4.8, 0.62


def figure_5() -> Figure:
    figure, axes = canvas(18, 8.2)
    section.base(axes, section.placed(axes, (0.7, _AXIS), _SCALE))
    section.rotor(axes, section.placed(axes, (6.9, _AXIS), _SCALE))
    section.output(axes, section.placed(axes, (9.3, _AXIS), _SCALE))
    axes.plot([0.4, 17.6], [_AXIS, _AXIS], color="#555555", lw=0.7, ls=(0, (10, 3, 2, 3)), zorder=2)
    for x, name, colour in ((4.25, "B", BASE), (10.3, "D", MOTOR), (15.1, "T", LINK)):
        triad(axes, (x, _AXIS), name, colour, 0.75)
    _on_the_base(axes)
    _on_the_rotor(axes)
    _on_the_link(axes)
    return figure


def _on_the_base(axes: Axes) -> None:
    _force(axes, (0.35, _AXIS + 0.35), (1.8, _AXIS + 0.35), "${}^B\\mathbf{F}$", (0.8, _AXIS + 0.75))
    _force(axes, (7.0, _AXIS + 1.1), (5.4, _AXIS + 1.1), "$-{}^B\\mathbf{U}_T{}^T\\mathbf{F}_q$", (6.3, _AXIS + 0.6))
    _force(
        axes, (5.9, _AXIS - 1.1), (4.1, _AXIS - 1.1), "$-{}^B\\mathbf{U}_D{}^D\\mathbf{F}_\\kappa$", (5.3, _AXIS - 0.6)
    )
    _balance(
        axes,
        3.4,
        "joint base {B}",
        BASE,
        "(11)",
        "${}^B\\mathbf{F}^* = {}^B\\mathbf{F} - "
        "{}^B\\mathbf{U}_T{}^T\\mathbf{F}_q - "
        "{}^B\\mathbf{U}_D{}^D\\mathbf{F}_\\kappa$",
        "${}^B\\mathbf{F}$: from the link before, to the base",
    )


def _on_the_rotor(axes: Axes) -> None:
    _force(axes, (7.6, _AXIS + 0.45), (8.75, _AXIS + 0.45), "${}^D\\mathbf{F}_\\kappa$", (8.1, _AXIS + 0.9))
    _balance(
        axes,
        9.5,
        "motor rotor {D}",
        MOTOR,
        "(10)",
        "${}^D\\mathbf{F}^* = {}^D\\mathbf{F}_\\kappa$",
        "$z_\\tau^T\\,{}^D\\mathbf{F}_\\kappa = \\tau - \\tau_t - \\xi(\\theta,\\dot\\theta)$",
    )


def _on_the_link(axes: Axes) -> None:
    _force(axes, (12.3, _AXIS + 1.1), (13.6, _AXIS + 1.1), "${}^T\\mathbf{F}_q$", (12.8, _AXIS + 1.55))
    _force(axes, (17.7, _AXIS + 0.6), (16.4, _AXIS + 0.6), "$-{}^T\\mathbf{F}$", (17.1, _AXIS + 1.05))
    _balance(
        axes,
        15.2,
        "output link {T}",
        LINK,
        "(9)",
        "${}^T\\mathbf{F}^* = -{}^T\\mathbf{F} + {}^T\\mathbf{F}_q$",
        "$z_\\tau^T\\,{}^T\\mathbf{F}_q = \\ell\\,\\tau_t - \\xi(q,\\dot q)$,   $\\ell\\,\\tau_t = \\tau_f$",
    )


def _force(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], words: str, at: tuple[float, float]
) -> None:
    arrow(axes, start, end, FORCE, 2.2, mutation_scale=14)
    text(axes, at, words, color=FORCE, fontsize=13)


def _balance(axes: Axes, x: float, title: str, colour: str, number: str, law: str, along: str) -> None:
    text(axes, (x, 7.7), title, color=colour, weight="bold", fontsize=13)
    text(axes, (x, 1.9), f"{number}   {law}", fontsize=13)
    text(axes, (x, 0.9), along)

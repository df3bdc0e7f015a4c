"""A joint with its harmonic drive cut along its axis, part by part: base, rotor, flexspline, output link.

Measured in units along and from the axis; the joint is 10 long and 5 high about its axis.
"""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.transforms import Affine2D, Transform

from cutpoint.reporting.style import BASE, BASE_FILL, LINK, LINK_FILL, MOTOR, MOTOR_FILL, SPRING, SPRING_FILL

Slab = tuple[float, float, float, float]
"""From x to x along the axis, from r to r off it."""


def placed(axes: Axes, origin: tuple[float, float], scale: float) -> Transform:
    """Where a part is drawn: the point of the axis at x = 0, and how large."""
    return Affine2D().scale(scale).translate(*origin) + axes.transData


def base(axes: Axes, at: Transform) -> None:
    """Joint base: housing and end plate, with the motor's stator."""
    _ring(axes, at, [(2.0, 2.3, 0.45, 2.6), (2.0, 9.6, 2.3, 2.6)], BASE, BASE_FILL)
    _ring(axes, at, [(3.0, 5.2, 1.5, 2.3)], BASE, "#c9ced6", hatch="////")


def rotor(axes: Axes, at: Transform) -> None:
    """Motor's rotor and shaft, with the wave generator on its end."""
    _ring(axes, at, [(3.0, 5.2, 0.25, 1.3)], MOTOR, MOTOR_FILL, hatch="////")
    _ring(axes, at, [(6.9, 7.7, 0.25, 1.18)], MOTOR, MOTOR_FILL)
    _bar(axes, at, (0.9, 7.9, -0.25, 0.5), MOTOR, MOTOR_FILL)


def flexspline(axes: Axes, at: Transform) -> None:
    """The thin cup that bends, its rim on the housing."""
    _ring(axes, at, [(5.8, 5.95, 1.24, 2.3), (5.8, 7.8, 1.24, 1.4)], SPRING, SPRING_FILL)


def output(axes: Axes, at: Transform) -> None:
    """Circular spline, flange and shaft of the output link."""
    _ring(axes, at, [(6.9, 7.8, 1.46, 2.05)], LINK, LINK_FILL, hatch="....")
    _bar(axes, at, (8.1, 8.5, -2.05, 4.1), LINK, LINK_FILL)
    _ring(axes, at, [(7.8, 8.1, 1.46, 2.05)], LINK, LINK_FILL)
    _bar(axes, at, (8.5, 11.6, -0.5, 1.0), LINK, LINK_FILL)


def bearing(axes: Axes, at: Transform) -> None:
    """Between circular spline and housing."""
    _ring(axes, at, [(7.2, 7.5, 2.05, 2.3)], BASE, "white")


def encoder(axes: Axes, at: Transform, x: float, colour: str) -> None:
    """A disc on the shaft and its reading head above."""
    _bar(axes, at, (x - 0.07, x + 0.07, -0.95, 1.9), colour, colour)
    _bar(axes, at, (x - 0.25, x + 0.25, 1.05, 0.3), colour, "white")


def _ring(axes: Axes, at: Transform, slabs: Sequence[Slab], edge: str, fill: str, hatch: str = "") -> None:
    """Slabs above the axis and their mirror images below."""
    for left, right, low, high in slabs:
        _bar(axes, at, (left, right, low, high - low), edge, fill, hatch)
        _bar(axes, at, (left, right, -high, high - low), edge, fill, hatch)


def _bar(axes: Axes, at: Transform, slab: Slab, edge: str, fill: str, hatch: str = "") -> None:
    """From x to x, from y upward by a height."""
    left, right, bottom, height = slab
    patch = Rectangle((left, bottom), right - left, height, ec=edge, fc=fill, lw=1.2, hatch=hatch, zorder=3)
    patch.set_transform(at)
    axes.add_patch(patch)

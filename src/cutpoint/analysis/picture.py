"""Bode plots of drives: from motor torque to the speeds on both sides."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

from cutpoint.analysis.frequency_response import FrequencyResponse, frequency_response
from cutpoint.analysis.modes import Modes
from cutpoint.arrays import Array, ComplexArray
from cutpoint.errors import InputError
from cutpoint.reporting.style import INK, LINK, MOTOR, STYLE, fit, grid_of, styled_figure

PANEL = (4.4, 3.9)
"""Inches of a joint's magnitude and phase together."""

BELOW, ABOVE = 8.0, 4.0
"""How far the picture goes below the lowest mode and above the highest."""

PEAK, DECADES = 10.0, 6
"""How much of a peak is shown above nearly all of the curves, and how many decades below that."""

LINK_LAGS = -315.0
"""Lowest phase shown of a link: a quarter turn behind its torque before resonance, half a turn more beyond it."""

RATIOS = {"rad": "velocity / torque [(rad/s)/(N m)]", "m": "velocity / force [(m/s)/N]"}
"""What the magnitude is, by the unit of a joint's position."""


def picture(modes: Modes) -> Figure:
    """Magnitude and phase over frequency, one panel per joint.  Raises InputError if there are no drive modes."""
    if not modes.frequencies.size:
        raise InputError(f"no picture of modes: {modes.remark}")
    return styled_figure(lambda: _drawn(modes))


def _drawn(modes: Modes) -> Figure:
    joints = modes.model.joints
    down, across = grid_of(len(joints))
    size = (0.6 + PANEL[0] * across, 0.3 + 0.8 / across + PANEL[1] * down)
    # no space in parts of the picture's height, which would part a joint's two axes
    layout = ConstrainedLayoutEngine(hspace=0.0)
    figure = Figure(figsize=size, dpi=STYLE["figure.dpi"], layout=layout)
    cells = figure.add_gridspec(down, across)
    for k, (joint, unit) in enumerate(zip(joints, modes.model.units, strict=True)):
        inner = cells[divmod(k, across)].subgridspec(2, 1, height_ratios=[2, 1])
        magnitude = figure.add_subplot(inner[0])
        phase = figure.add_subplot(inner[1], sharex=magnitude)
        response = _response(modes, joint)
        _magnitude(magnitude, response, RATIOS[unit])
        _phase(phase, response)
    _explain(figure, modes.model.friction, across)
    return figure


def _response(modes: Modes, joint: str) -> FrequencyResponse:
    """The response over a band around all modes, sampled more densely at this joint's peaks and dips."""
    low, high = modes.frequencies.min() / BELOW, modes.frequencies.max() * ABOVE
    marks = frequency_response(modes.model, [low, high], joint)
    steps = np.geomspace(1e-4, 0.1, 25)
    around = np.outer(np.r_[marks.resonances, marks.antiresonances], np.r_[1 - steps, 1 + steps])
    return frequency_response(modes.model, np.unique(np.r_[np.geomspace(low, high, 1000), around.ravel()]), joint)


def _magnitude(axes: Axes, response: FrequencyResponse, ratio: str) -> None:
    motor, link = np.abs(response.motor_velocity), np.abs(response.link_velocity)
    axes.loglog(response.frequencies, link, color=LINK, linewidth=1.2)
    axes.loglog(response.frequencies, motor, color=MOTOR, linewidth=1.2)
    top = PEAK * float(np.quantile(np.r_[motor, link], 0.95))
    axes.set_ylim(max(float(np.quantile(np.r_[motor, link], 0.02)) / PEAK, top / 10**DECADES), top)
    _mark(axes, response.resonances, "v", 0.94)
    _mark(axes, response.antiresonances, "^", 0.06)
    fit(axes.set_title(response.joint, parse_math=False), PANEL[0] - 0.6)
    axes.set_ylabel(ratio, fontsize="small")
    axes.tick_params(labelbottom=False, labelsize="small")


def _mark(axes: Axes, frequencies: Array, marker: str, height: float) -> None:
    """Marks with their frequencies, at a height in parts of the axes."""
    at = axes.get_xaxis_transform()
    axes.plot(frequencies, np.full(frequencies.size, height), marker, color=INK, markersize=4, transform=at)
    for f in frequencies:
        axes.axvline(f, color=INK, linewidth=0.5, linestyle=":" if marker == "^" else "--", alpha=0.5)


def _phase(axes: Axes, response: FrequencyResponse) -> None:
    # a rigid drive's link lags no more than its motor
    rigid = np.allclose(response.link_velocity, response.motor_velocity, rtol=1e-9, atol=0.0)
    both = ((response.link_velocity, LINK, -180.0 if rigid else LINK_LAGS), (response.motor_velocity, MOTOR, -180.0))
    for values, colour, lowest in both:
        axes.semilogx(response.frequencies, _degrees(values, lowest), color=colour, linewidth=1.2)
    axes.set_ylim(-330, 110)
    axes.set_yticks([-270, -180, -90, 0, 90])
    axes.set_ylabel("phase [deg]", fontsize="small")
    axes.set_xlabel("frequency [Hz]", fontsize="small")
    axes.tick_params(labelsize="small")
    axes.margins(x=0)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())


def _degrees(values: ComplexArray, lowest: float) -> Array:
    """Phase within a turn from `lowest` upward, broken where it goes around."""
    phase = (np.degrees(np.angle(values)) - lowest) % 360.0 + lowest
    phase[1:][np.abs(np.diff(phase)) > 270] = np.nan
    return phase


def _explain(figure: Figure, friction: bool, across: int) -> None:
    samples = {
        "motor torque to motor velocity": Line2D([], [], color=MOTOR),
        "motor torque to link velocity": Line2D([], [], color=LINK),
        "resonance": Line2D([], [], color=INK, marker="v", markersize=4, linestyle="--", linewidth=0.5),
        "anti-resonance (motor locked)": Line2D(
            [], [], color=INK, marker="^", markersize=4, linestyle=":", linewidth=0.5
        ),
    }
    title = f"linear, at rest, at the joint's side; friction {'by its slope at rest' if friction else 'left out'}"
    columns = (1, 2, 4)[across - 1]
    place = "outside upper center"
    figure.legend([*samples.values()], [*samples], loc=place, ncols=columns, title=title)

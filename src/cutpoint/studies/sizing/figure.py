"""The torque-speed plane of every drive: the motion, and the limits of gear and motor."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.motor import within_limits
from cutpoint.model.units import RPM
from cutpoint.reporting.style import BASE_FILL, FAINT, FORCE, INK, LINK, MOTOR, fit, grid_of, styled_figure, width_of
from cutpoint.studies.sizing.drive_sizing import DriveSizing, allowed
from cutpoint.studies.sizing.load import Load
from cutpoint.studies.sizing.margins import told

PANEL = (3.6, 3.1)
"""Inches of one panel."""

TITLE_WIDTH, TITLE_GAP = PANEL[0] - 0.8, 0.1
"""Inches: what the labels of the ticks leave of a panel, and between a name and a margin on one line."""

START_STOP = "#f2f3f6"
"""Fill of the zone up to the repeated peak torque, paler than that of the averages."""

MOMENTARY_SHOWN = 2.2
"""The momentary peak is drawn if it is at most this many times what else must be seen."""

ENDLESS = 1e12
"""N m: more than any motor has, for its limit to be seen."""

STANDSTILL = 1e-2
"""Of the fastest speed, up to which a motor's has no direction."""

HEADROOM = 0.13
"""Above the highest thing, for words: a share of the plane's height below it."""

GEAR_CURVE, MOTOR_CURVE, MOTOR_LIMIT = "what the gear exerts", "what the motor exerts", "motor's limit"
AVERAGE, RATED, BEYOND = "gear, average", "gear, rated", "beyond a limit"
AVERAGES, STARTS = "zone of averages", "zone of starts and stops"
SAMPLES: dict[str, dict[str, Any]] = {
    GEAR_CURVE: {"color": LINK, "lw": 1.3},
    # wide and pale, so that it is seen behind the gear's
    MOTOR_CURVE: {"color": MOTOR, "lw": 2.8, "alpha": 0.5},
    AVERAGE: {"color": LINK, "marker": "o", "mec": "white", "ms": 7, "ls": ""},
    RATED: {"color": INK, "marker": "+", "mew": 1.2, "ms": 8, "ls": ""},
    AVERAGES: {"facecolor": BASE_FILL, "edgecolor": FAINT, "lw": 0.8},
    STARTS: {"facecolor": START_STOP, "edgecolor": FAINT, "lw": 0.8},
    MOTOR_LIMIT: {"color": MOTOR, "lw": 1, "ls": "--"},
    BEYOND: {"mfc": "none", "mec": FORCE, "mew": 1.6, "ms": 11, "marker": "o", "ls": ""},
}
"""Styles of all items, in the order of the legend."""


def figure_of(drives: Sequence[DriveSizing], load: Load) -> Figure:
    """A panel a drive; torques at the joint's side, positive where the drive pushes along its motion."""
    return styled_figure(lambda: _drawn(drives, load))


def _drawn(drives: Sequence[DriveSizing], load: Load) -> Figure:
    mixed = len({drive.slides for drive in drives}) > 1
    down, across = grid_of(len(drives))
    figure = Figure(figsize=(0.4 + PANEL[0] * across, 1.0 + PANEL[1] * down), layout="constrained")
    for k, drive in enumerate(drives):
        axes = figure.add_subplot(down, across, k + 1)
        _panel(axes, load, drive, k)
        if k % across == 0 or mixed:
            axes.set_ylabel("force at the joint [N]" if drive.slides else "torque at the joint [N m]")
        if k >= len(drives) - across:
            axes.set_xlabel("motor speed [rpm]")
    _explain(figure, across)
    return figure


def _panel(axes: Axes, load: Load, drive: DriveSizing, k: int) -> None:
    ratio, speed = drive.drive.ratio, load.motor_speed[:, k] / RPM
    moves = np.abs(speed) > STANDSTILL * np.abs(speed).max(initial=0.0)
    gear, motor = load.output_torque[:, k], load.motor_torque[:, k] * ratio
    # at rest, what pushes along a motion is what holds
    forwards = np.where(moves, np.sign(speed * ratio), np.where(gear < 0, -1.0, 1.0))
    gear, motor = gear * forwards, motor * forwards
    _window(axes, drive, np.r_[gear, motor], float(np.abs(speed).max()))
    _zones(axes, drive)
    _motor_limit(axes, drive)
    for torque, sample in ((motor, MOTOR_CURVE), (gear, GEAR_CURVE)):
        axes.plot(np.abs(speed), np.where(moves, torque, np.nan), **SAMPLES[sample], label=sample)
    # an average has no sign: it stands on the side of the larger torques
    side = 1 if gear[moves].max(initial=0.0) >= -gear[moves].min(initial=0.0) else -1
    average = drive.demand.mean_motor_speed / RPM, side * drive.demand.average_torque
    axes.plot(*average, **SAMPLES[AVERAGE], label=AVERAGE, zorder=5)
    for failed in drive.failures:
        at = average
        if failed.at is not None:
            i = int(np.searchsorted(load.time, failed.at.time))
            at = abs(speed[i]), (motor if failed.limit.startswith("motor") else gear)[i]
        axes.plot(*at, **SAMPLES[BEYOND], label=BEYOND, zorder=6)
    _title(axes, drive)


def _window(axes: Axes, drive: DriveSizing, torques: Array, fastest: float) -> None:
    """The visible part of the plane: all of the motion, and the gear's zones."""
    maximum, peak = allowed(drive, "maximum speed"), allowed(drive, "repeated peak torque")
    highest = max(float(torques.max()), *(x for x in (peak, allowed(drive, "average torque")) if x < np.inf), 1e-9)
    momentary = allowed(drive, "momentary peak torque")
    highest = momentary if highest < momentary <= MOMENTARY_SHOWN * highest else highest
    lowest = min(-0.2 * highest, 1.3 * float(torques.min()))
    axes.set_ylim(lowest, highest + HEADROOM * (highest - lowest))
    axes.set_xlim(0, 1.08 * (max(fastest, maximum / RPM) if maximum < np.inf else fastest) or 1.0)
    axes.axhline(0, color=INK, lw=0.7, zorder=1)
    axes.grid(False)


def _zones(axes: Axes, drive: DriveSizing) -> None:
    """What the gear is allowed when it starts and stops, and on average; its rated point; its momentary peak."""
    right, broken = axes.get_xlim()[1], {margin.limit for margin in drive.failures}
    for torque, speed, zoned in (
        ("repeated peak torque", "maximum speed", STARTS),
        ("average torque", "average speed", AVERAGES),
    ):
        high, wide = allowed(drive, torque), min(allowed(drive, speed) / RPM, right)
        if high < np.inf:
            edge = FORCE if broken & {torque, speed} else FAINT
            look = {**SAMPLES[zoned], "edgecolor": edge}
            axes.add_patch(Rectangle((0, -high), wide, 2 * high, **look, label=zoned, zorder=0.5))
            # on the half of the edge that the average does not come near
            at, by, side = (0.0, 4, "left") if drive.demand.mean_motor_speed / RPM > wide / 2 else (wide, -3, "right")
            _label(axes, f"{torque.removesuffix(' torque')} {high:.4g}", (at, high), (by, 3), side, edge)
    momentary = allowed(drive, "momentary peak torque")
    if momentary < axes.get_ylim()[1]:
        axes.axhline(momentary, color=FAINT, lw=1, ls=":")
        _label(axes, f"momentary peak {momentary:.4g}", (0, momentary), (4, 3), "left", FAINT)
    rated = drive.drive.ratings
    if rated and rated.rated_torque is not None and rated.rated_speed is not None:
        speed = rated.rated_speed / RPM
        if speed < right and rated.rated_torque < axes.get_ylim()[1]:
            axes.plot(speed, rated.rated_torque, **SAMPLES[RATED], label=RATED, zorder=6)


def _label(axes: Axes, text: str, at: tuple[float, float], offset: tuple[float, float], side: str, colour: str) -> None:
    ink = INK if colour == FAINT else colour
    # readable where curves and rings run behind it
    words = axes.annotate(text, at, offset, textcoords="offset points", ha=side, fontsize=8.5, color=ink, zorder=7)
    words.set_path_effects([withStroke(linewidth=3, foreground="white")])


def _motor_limit(axes: Axes, drive: DriveSizing) -> None:
    """Driving and braking torque within the motor's current, its voltage and the torque limits, over speed."""
    speeds, (low, high) = np.linspace(0, axes.get_xlim()[1], 4000), axes.get_ylim()
    bound, at_joint = min(allowed(drive, "motor torque"), ENDLESS), speeds * RPM / abs(drive.drive.ratio)
    for sign in (1.0, -1.0):
        pushed = within_limits(drive.drive, np.full_like(speeds, sign * ENDLESS), at_joint)
        curve = np.clip(pushed, -bound, bound)
        if ((sign * curve >= 0) & (curve >= low) & (curve <= high)).any():
            axes.plot(speeds, np.where(sign * curve >= 0, curve, np.nan), **SAMPLES[MOTOR_LIMIT], label=MOTOR_LIMIT)


def _title(axes: Axes, drive: DriveSizing) -> None:
    tightest = drive.tightest
    least = "no limit stated" if tightest is None else f"margin {told(tightest)}: {tightest.limit}"
    name = axes.set_title(drive.joint, parse_math=False, weight="bold", fontsize=11)
    margin = axes.set_title(least, loc="right", fontsize=9.5, color=FORCE if drive.failures else INK)
    fit(name, TITLE_WIDTH)
    if width_of(name) + width_of(margin) > TITLE_WIDTH - TITLE_GAP:
        name.set_text(f"{drive.joint}\n")


def _explain(figure: Figure, across: int) -> None:
    """Adds a legend of the items in the figure."""
    drawn = {label for axes in figure.axes for label in axes.get_legend_handles_labels()[1]}
    shown = {label: look for label, look in SAMPLES.items() if label in drawn}
    samples = [Patch(**look) if "facecolor" in look else Line2D([], [], **look) for look in shown.values()]
    columns = (1, 2, 4)[across - 1]
    figure.legend(samples, [*shown], loc="outside lower center", ncols=columns, fontsize=10)

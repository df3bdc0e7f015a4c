"""Textbook figures of a drive's effects: friction here, periodic ones in `effects_waves`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.friction import Stribeck
from cutpoint.mechanics.drives.presliding import ElastoPlastic
from cutpoint.model.drive import Drive
from cutpoint.model.units import ARC_MINUTE
from cutpoint.reporting.style import FAINT, FORCE, INK, LINK, MOTOR, MOTOR_FILL, SPRING, WIDTH
from cutpoint.simulation import Log
from cutpoint.studies.drive.loop import SpringState, branch, cycle, state_at
from cutpoint.studies.drive_effects import (
    ASYMMETRY,
    COLD,
    EFFECTS,
    FRICTION,
    GEARS,
    LEANING,
    PRESLIDING,
    TEMPERATURE,
    drive_with,
)
from cutpoint.studies.paper.effects_waves import kinematic_error, spectrum_of_torque, spectrum_of_tracking, torque_waves

SHOWN = 1
"""Joint 2."""

PEAK = 30.0
"""To which the hysteresis loop is wound, N m."""

MINOR = ((-27.0, -11.0), (-8.0, 8.0), (11.0, 27.0))
"""Between which torques minor loops turn, N m."""

LOADS = (0.0, 25.0, 50.0)
"""For which gear friction is drawn, N m."""

TURNS = (0.0, 1.4, -1.4, -0.3, -0.8, 1.4)
"""Of a slow motion by which presliding is drawn, 1e-3 rad."""

_DASHES: Any = (0, (5, 3))
_LEADER = {"arrowstyle": "-", "color": INK, "lw": 0.7}


def figure(nominal: Drive, tracking: Mapping[str, Log]) -> Figure:
    """Eight panels of a drive; tracking: loops with the kinematic error alone, by label."""
    shown = Figure(figsize=(WIDTH, 12.4), layout="constrained")
    panels = shown.subplot_mosaic("ab;cd;ef;gh", height_ratios=(1.2, 1, 1, 1))
    drive = drive_with(nominal, GEARS[SHOWN], EFFECTS)
    assert isinstance(nominal.link_friction, Stribeck)
    hysteresis_loop(panels["a"], drive)
    stribeck_curve(panels["b"], nominal.link_friction)
    gear_friction(panels["c"], nominal)
    presliding(panels["d"], drive_with(nominal, GEARS[SHOWN], (FRICTION, PRESLIDING)))
    kinematic_error(panels["e"], drive)
    spectrum_of_tracking(panels["f"], tracking, SHOWN, drive.ratio)
    torque_waves(panels["g"], drive)
    spectrum_of_torque(panels["h"], drive)
    return shown


def hysteresis_loop(axes: Axes, drive: Drive) -> None:
    loop, spring = cycle(drive, PEAK), drive.compliance
    assert isinstance(spring, CatalogueSpring)
    deflection, torque = (np.append(*ends) for ends in zip(loop.up, loop.down, strict=True))
    axes.fill(deflection / ARC_MINUTE, torque, color=MOTOR_FILL, lw=0)
    line = np.linspace(-PEAK, PEAK, 121)
    axes.plot(spring.deflection(line) / ARC_MINUTE, line, color=FAINT, lw=1.0, ls=_DASHES, label="spring alone")
    axes.plot(deflection / ARC_MINUTE, torque, color=MOTOR, label="to and fro")
    for k, (x, y) in enumerate(minor_loops(drive, loop.down[0][0])):
        axes.plot(x / ARC_MINUTE, y, color=LINK, label="" if k else "minor loops")
    half = loop.width / ARC_MINUTE / 2
    axes.plot([-half, half], [0, 0], color=FORCE, lw=2.5, solid_capstyle="butt", zorder=5)
    leader = _LEADER | {"color": FORCE}
    loss = f"hysteresis loss\n{2 * half:.2g} arcmin"
    axes.annotate(loss, (half, 0), (1.7, -14), color=FORCE, arrowprops=leader, va="center")
    axes.legend(loc="upper left")
    axes.set(title="(a) hysteresis loop", xlabel="deflection [arcmin]", ylabel="torque [N m]")


def minor_loops(drive: Drive, farthest: float) -> list[tuple[Array, Array]]:
    """Deflections and torques of loops that leave the falling branch and come back to it, rad and N m."""
    assert drive.hysteresis is not None
    top, found = SpringState(farthest, tuple(drive.hysteresis.reach)), list[tuple[Array, Array]]()
    for low, high in MINOR:
        start = state_at(drive, top, low)
        turn = state_at(drive, start, high)
        end = state_at(drive, turn, low)
        up, down = (np.linspace(a.deflection, b.deflection, 120) for a, b in ((start, turn), (turn, end)))
        found.append((np.append(up, down), np.append(branch(drive, start, up), branch(drive, turn, down))))
    return found


def stribeck_curve(axes: Axes, law: Stribeck) -> None:
    speed = np.linspace(-0.8, 0.8, 1601)
    torque = np.asarray(law.torque(speed))
    leaning = f"{100 * LEANING:.0f} % more forwards,\n{100 * LEANING:.0f} % less backwards"
    _cross(axes)
    axes.plot(speed, torque, color=MOTOR)
    axes.plot(speed, replace(law, asymmetry=LEANING).torque(speed), color=SPRING, lw=1.1, ls=_DASHES, label=leaning)
    for text, at, where in (
        ("breakaway", float(speed[torque.argmax()]), (0.2, 3.25)),
        ("Stribeck effect", 0.17, (0.27, 2.2)),
        ("viscous", 0.6, (0.5, 1.3)),
    ):
        axes.annotate(text, (at, float(law.torque(at))), where, arrowprops=_LEADER, va="center", fontsize=11)
    axes.legend(loc="upper left", fontsize=10, handlelength=1.6)
    axes.set(title="(b) Stribeck curve, Table 2", xlabel="joint speed [rad/s]", ylabel="friction [N m]")
    axes.margins(x=0)


def gear_friction(axes: Axes, nominal: Drive) -> None:
    """Warm under each of the loads; cold without."""
    speed = np.linspace(-1.0, 1.0, 1601)
    warm, cold = (
        drive_with(nominal, GEARS[SHOWN], (FRICTION, ASYMMETRY, *more)).motor_friction for more in ((), (COLD,))
    )
    assert warm is not None and cold is not None
    _cross(axes)
    for load, shade in zip(LOADS, (0.4, 0.7, 1.0), strict=True):
        label = f"under {load:.0f} N m" if load else "without load"
        axes.plot(speed, warm.torque(speed, load), color=MOTOR, alpha=shade, label=label)
    axes.plot(speed, cold.torque(speed), color=SPRING, ls=_DASHES, label=f"without load, {TEMPERATURE:.0f} °C")
    handles, labels = axes.get_legend_handles_labels()
    axes.legend([handles[k] for k in (2, 1, 0, 3)], [labels[k] for k in (2, 1, 0, 3)], fontsize=10, handlelength=1.6)
    axes.set(title="(c) gear friction by load", xlabel="joint speed [rad/s]", ylabel="friction [N m]", xlim=(-1, 1))


def presliding(axes: Axes, drive: Drive) -> None:
    law = drive.motor_friction
    assert isinstance(law, ElastoPlastic)
    path, torque = dragged(law, 1e-3 * np.array(TURNS))
    breakaway = float(law.sliding.plateau(0))
    _cross(axes)
    for side in (-1, 1):
        axes.axhline(side * breakaway, color=FAINT, lw=1.0, ls=_DASHES)
    axes.plot(1e3 * path, torque, color=MOTOR)
    axes.text(-1.4, 1.06 * breakaway, "breakaway", color=FAINT, va="bottom", fontsize=10)
    axes.annotate("winds up", (0.15, float(law.stiffness) * 0.15e-3), (0.4, 0.35), arrowprops=_LEADER, fontsize=11)
    axes.set(title="(d) presliding", xlabel="displacement [$10^{-3}$ rad]", ylabel="friction [N m]")
    axes.set_ylim(-1.3 * breakaway, 1.3 * breakaway)


def dragged(law: ElastoPlastic, turns: Sequence[float] | Array) -> tuple[Array, Array]:
    """Friction of a slow motion from turn to turn: displacements in rad, torques in N m."""
    path, torque, strain = [float(turns[0])], [0.0], 0.0
    for start, end in pairwise(turns):
        slowly = 1e-9 * np.sign(end - start)
        for at in np.linspace(start, end, 300)[1:]:
            strain = law.strain(strain, at - path[-1], slowly)
            path.append(float(at))
            torque.append(float(law.strained_torque(strain, slowly)))
    return np.array(path), np.array(torque)


def _cross(axes: Axes) -> None:
    axes.axhline(0, color=FAINT, lw=0.8)
    axes.axvline(0, color=FAINT, lw=0.8)

"""A drive of the catalogue in four panels: stiffness, accuracy, running torque, efficiency."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from cutpoint.formats.catalogue import catalogue_gear
from cutpoint.formats.catalogue_entry import ARC_MINUTE
from cutpoint.formats.catalogue_sheets import CatalogueGear
from cutpoint.mechanics.catalogue import CatalogueSpring
from cutpoint.studies.chain import Array
from cutpoint.studies.drive.measured import Specimen, arc_minutes
from cutpoint.studies.drive.rows import SPEEDS
from cutpoint.studies.style import FAINT, FORCE, INK, JOINTS, LINK, MOTOR, MOTOR_FILL, WIDTH, styled

_ORDERS = 8
"""Waves a turn to which the spectrum goes."""


def save_picture(name: str, path: Path) -> None:
    """The four panels as a file.  Raises ModelError for a name that is not in the catalogue."""
    with styled():
        picture(name).savefig(path)


def picture(name: str) -> Figure:
    """The four panels.  Errors as in `save_picture`."""
    specimen = Specimen(name)
    figure = Figure(figsize=(WIDTH, 7.6), layout=ConstrainedLayoutEngine(w_pad=0.08, h_pad=0.08))
    panels = figure.subplot_mosaic([["a", "b"], ["a", "spectrum"], ["c", "d"]], height_ratios=(3, 2, 5.5))
    _stiffness(panels["a"], specimen)
    _accuracy(panels["b"], panels["spectrum"], specimen)
    _running_torque(panels["c"], specimen)
    _efficiency(panels["d"], specimen)
    gear = specimen.gear
    figure.suptitle(
        f"{gear.name}    {gear.maker}, size {gear.size}, ratio {gear.ratio}", x=0.02, ha="left", fontsize=14
    )
    return figure


def _stiffness(axes: Axes, specimen: Specimen) -> None:
    axes.set(title="(a) torsion, wave generator blocked", xlabel="torsion [arcmin]", ylabel="torque [N m]")
    loop, spring = specimen.loop, specimen.spring
    if loop is None or spring is None:
        return _missing(axes, "stiffness")
    (x_up, up), (x_down, down) = loop.up, loop.down
    axes.fill(np.append(x_up, x_down) / ARC_MINUTE, np.append(up, down), color=MOTOR_FILL, lw=0)
    axes.plot(np.append(x_up, x_down) / ARC_MINUTE, np.append(up, down), color=MOTOR, label="laws")
    peak = float(up.max())
    corners = np.array([t for t in (float(spring.t1), float(spring.t2)) if t < peak])
    line = np.concatenate([[-peak], -corners[::-1], [0.0], corners, [peak]])
    axes.plot(_straight(spring, line), line, color=INK, lw=1.0, ls=(0, (5, 3)), label="catalogue's segments")
    for k, corner in enumerate(corners, start=1):
        at = float(_straight(spring, corner)), corner
        axes.plot(*at, "o", color=INK, ms=4)
        axes.annotate(f"$T_{k}$", at, (7, -9), textcoords="offset points")
    values = ", ".join(f"{float(k) / 1e3:.3g}" for k in (spring.k1, spring.k2, spring.k3))
    text = f"$K_1$, $K_2$, $K_3$ = {values} kN m/rad"
    axes.text(0.99, 0.03, text, transform=axes.transAxes, ha="right", fontsize=11)
    if specimen.gear.hysteresis:
        _loss(axes, loop.width, peak)
    axes.legend(loc="upper left")


def _straight(spring: CatalogueSpring, torque: Any) -> Any:
    """Torsion by the catalogue's segments, arcmin."""
    size = np.abs(torque)
    first, second = np.minimum(size, spring.t1), np.clip(size - spring.t1, 0, spring.t2 - spring.t1)
    angle = first / spring.k1 + second / spring.k2 + np.maximum(size - spring.t2, 0) / spring.k3
    return np.sign(torque) * angle / ARC_MINUTE


def _loss(axes: Axes, width: float, peak: float) -> None:
    """The loop's width at zero torque, marked."""
    half = arc_minutes(width) / 2
    axes.plot([-half, half], [0, 0], color=FORCE, lw=2.5, solid_capstyle="butt")
    text = f"hysteresis loss\n{2 * half:.3g} arcmin"
    arrow = {"arrowstyle": "-", "color": FORCE, "lw": 0.8}
    axes.annotate(text, (half, 0), (0.66, 0.3), textcoords="axes fraction", color=FORCE, arrowprops=arrow, va="center")
    axes.set_ylim(-1.12 * peak, 1.12 * peak)


def _accuracy(wave: Axes, spectrum: Axes, specimen: Specimen) -> None:
    wave.set(title="(b) kinematic error", xlabel="turn of the wave generator [deg]", ylabel="error [arcmin]")
    spectrum.set(xlabel="waves a turn", ylabel="amplitude")
    if specimen.gear.accuracy is None:
        spectrum.set_axis_off()
        return _missing(wave, "transmission accuracy")
    half = specimen.gear.accuracy.transmission_arcmin / 2
    angle = np.linspace(0.0, 2 * np.pi, 721)
    wave.axhspan(-half, half, color=MOTOR_FILL, lw=0, alpha=0.6)
    wave.plot(np.degrees(angle), specimen.error(angle) / ARC_MINUTE, color=MOTOR)
    wave.annotate("", (225, half), (225, -half), arrowprops={"arrowstyle": "<->", "color": FORCE, "lw": 0.9})
    wave.text(231, -0.05 * half, f"{2 * half:.3g} arcmin", color=FORCE, va="center", bbox=_paper())
    wave.set(xticks=range(0, 361, 90), xlim=(0, 360), ylim=(-1.35 * half, 1.35 * half))
    lines = _spectrum(specimen) / ARC_MINUTE
    spectrum.vlines(range(1, _ORDERS + 1), 0, lines[1 : _ORDERS + 1], color=MOTOR, lw=4)
    spectrum.set(xticks=range(1, _ORDERS + 1), xlim=(0.4, _ORDERS + 0.6), ylim=(0, 1.35 * half))
    spectrum.grid(visible=False, axis="x")


def _spectrum(specimen: Specimen) -> Array:
    """Amplitudes by order, rad, from one turn."""
    error = specimen.error(np.linspace(0.0, 2 * np.pi, 1024, endpoint=False))
    return np.abs(np.fft.rfft(error)) * 2 / len(error)


def _running_torque(axes: Axes, specimen: Specimen) -> None:
    axes.set(title="(c) running torque at the input, no load", xlabel="input speed [rpm]", ylabel="torque [N m]")
    if not specimen.knows_speed:
        return _missing(axes, "running torque")
    rpm = np.concatenate([np.linspace(0, 100, 100), np.linspace(100, _fastest(specimen), 200)[1:]])
    axes.plot(rpm, [specimen.running_torque(n) for n in rpm], color=LINK)
    for marker, label, points, own in _sheet_points(specimen):
        inside = INK if own else "white"
        axes.plot(*np.transpose(points), marker, mec=INK, mfc=inside, ms=6, clip_on=False, zorder=5, label=label)
    axes.set(xlim=(0, None), ylim=(0, None))
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right", handlelength=1.0)
    _doubt(axes, specimen, ("dry", "slope"))


def _sheet_points(specimen: Specimen) -> Iterator[tuple[str, str, list[tuple[float, float]], bool]]:
    """Marker, label, (rpm, N m) and whether they are its own, or those of the gear that stands in for it."""
    gear, like = specimen.gear, specimen.gear.friction
    other, scale = (catalogue_gear(like.like), like.scale) if like else (gear, 1.0)
    source = other.name + (f", times {scale:g}" if scale != 1.0 else "")
    alone = ", gear alone" if gear.motor else ""
    for marker, name, points_of in (("D", "starting torque", _starting), ("o", "running torque", _running)):
        if own := points_of(gear):
            yield marker, f"{name}, data sheet{alone}", own, True
        elif theirs := points_of(other):
            yield marker, f"{name}, {source}", [(rpm, scale * torque) for rpm, torque in theirs], False


def _starting(gear: CatalogueGear) -> list[tuple[float, float]]:
    return [(0.0, gear.starting.torque)] if gear.starting else []


def _running(gear: CatalogueGear) -> list[tuple[float, float]]:
    return [*gear.running.points] if gear.running else []


def _efficiency(axes: Axes, specimen: Specimen) -> None:
    axes.set(title="(d) efficiency", xlabel="output torque [N m]", ylabel="efficiency [%]")
    if not specimen.knows_load or specimen.load is None:
        return _missing(axes, "efficiency")
    load = np.linspace(1e-3, 1.25, 300) * specimen.load
    for colour, rpm in zip(JOINTS, SPEEDS, strict=False):
        curve = np.array([100 * specimen.efficiency(rpm, torque) for torque in load])
        axes.plot(load, curve, color=colour, label=f"{rpm:g} rpm")
        points = specimen.gear.efficiency.points if specimen.gear.efficiency else ()
        for _, torque, eta in (point for point in points if point[0] == rpm):
            axes.plot(torque, 100 * eta, "o", color=colour, ms=6, mec="white", zorder=5)
    if specimen.gear.ratings:
        axes.axvline(specimen.load, color=FAINT, lw=0.9, ls=(0, (4, 3)))
        axes.annotate(" rated", (specimen.load, 2), color=FAINT, ha="right", rotation=90, va="bottom", fontsize=10)
    axes.set(xlim=(0, load[-1]), ylim=(0, 100))
    axes.legend(loc="lower right", bbox_to_anchor=(0.78, 0.0))
    _doubt(axes, specimen, ("dry", "slope", "per_load"))


def _fastest(specimen: Specimen) -> float:
    return specimen.gear.speeds.maximum_rpm if specimen.gear.speeds else max(SPEEDS)


def _doubt(axes: Axes, specimen: Specimen, parts: tuple[str, ...]) -> None:
    """A word in the title where it rests on another gear's numbers."""
    if {*parts} & {*specimen.friction.estimated}:
        axes.set_title("estimate", loc="right", color=FORCE, fontstyle="italic", fontsize=11)
    elif specimen.is_fitted:
        axes.set_title("fitted to efficiency", loc="right", color=FAINT, fontstyle="italic", fontsize=11)


def _missing(axes: Axes, what: str) -> None:
    axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
    axes.spines[:].set_visible(False)
    axes.text(0.5, 0.5, f"no source gives its {what}", transform=axes.transAxes, ha="center", color=FAINT)


def _paper() -> dict[str, object]:
    return {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.5}

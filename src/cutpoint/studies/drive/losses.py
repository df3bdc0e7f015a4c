"""Panels on a drive's losses: running torque over speed, and efficiency over load."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes

from cutpoint.formats.catalogue.catalogue import catalogue_gear
from cutpoint.formats.catalogue.sheets import CatalogueGear
from cutpoint.reporting.style import FAINT, FORCE, INK, JOINTS, LINK
from cutpoint.studies.drive.angles import missing
from cutpoint.studies.drive.measured import Specimen
from cutpoint.studies.drive.rows import SPEEDS


def running_torque(axes: Axes, specimen: Specimen) -> None:
    axes.set(title="(c) running torque, no load", xlabel="input speed [rpm]", ylabel="input torque [N m]")
    if not specimen.knows_speed:
        return missing(axes, "running torque")
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


def efficiency(axes: Axes, specimen: Specimen) -> None:
    axes.set(title="(d) efficiency", xlabel="output torque [N m]", ylabel="efficiency [%]")
    if not specimen.knows_load or specimen.load is None:
        return missing(axes, "efficiency")
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
    """A remark in the title if it relies on another gear's numbers."""
    if {*parts} & {*specimen.friction.estimated}:
        axes.set_title("estimate", loc="right", color=FORCE, fontstyle="italic", fontsize=11)
    elif specimen.is_fitted:
        axes.set_title("fitted to efficiency", loc="right", color=FAINT, fontstyle="italic", fontsize=11)

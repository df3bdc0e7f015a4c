"""Panels on what a drive's output does: torsion over torque, and kinematic error over a turn."""

import numpy as np
from matplotlib.axes import Axes

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.model.units import ARC_MINUTE
from cutpoint.reporting.style import FAINT, FORCE, INK, MOTOR, MOTOR_FILL
from cutpoint.studies.drive.loop import Loop
from cutpoint.studies.drive.measured import Specimen

_ORDERS = 8
"""Highest order of the spectrum, waves per turn."""


def stiffness(axes: Axes, specimen: Specimen) -> None:
    axes.set(title="(a) torsion, wave generator blocked", xlabel="torsion [arcmin]", ylabel="torque [N m]")
    loop, spring = specimen.loop, specimen.spring
    if loop is None or spring is None:
        return missing(axes, "stiffness")
    torsion, torque = np.concatenate([loop.up, loop.down], axis=1)
    axes.fill(torsion / ARC_MINUTE, torque, color=MOTOR_FILL, lw=0)
    axes.plot(torsion / ARC_MINUTE, torque, color=MOTOR, label="laws")
    _segments(axes, spring, float(torque.max()))
    if specimen.gear.hysteresis:
        _loss(axes, loop)
    axes.legend(loc="upper left")


def _segments(axes: Axes, spring: CatalogueSpring, peak: float) -> None:
    """The catalogue's curve, with its corners and slopes."""
    corners = np.array([t for t in (float(spring.t1), float(spring.t2)) if t < peak])
    line = np.concatenate([[-peak], -corners[::-1], [0.0], corners, [peak]])
    torsion = spring.straight_deflection(line) / ARC_MINUTE
    axes.plot(torsion, line, color=INK, lw=1.0, ls=(0, (5, 3)), label="catalogue's segments")
    for k, corner in enumerate(corners, start=1):
        at = float(spring.straight_deflection(corner)) / ARC_MINUTE, corner
        axes.plot(*at, "o", color=INK, ms=4)
        axes.annotate(f"$T_{k}$", at, (7, -9), textcoords="offset points")
    values = ", ".join(f"{float(k) / 1e3:.3g}" for k in (spring.k1, spring.k2, spring.k3))
    text = f"$K_1$, $K_2$, $K_3$ = {values} kN m/rad"
    axes.text(0.99, 0.03, text, transform=axes.transAxes, ha="right", fontsize=11)
    axes.set_ylim(-1.12 * peak, 1.12 * peak)


def _loss(axes: Axes, loop: Loop) -> None:
    """The loop's width at zero torque, marked."""
    half = loop.width / ARC_MINUTE / 2
    axes.plot([-half, half], [0, 0], color=FORCE, lw=2.5, solid_capstyle="butt")
    text = f"hysteresis loss\n{2 * half:.3g} arcmin"
    arrow = {"arrowstyle": "-", "color": FORCE, "lw": 0.8}
    axes.annotate(text, (half, 0), (0.66, 0.3), textcoords="axes fraction", color=FORCE, arrowprops=arrow, va="center")


def accuracy(wave: Axes, spectrum: Axes, specimen: Specimen) -> None:
    wave.set(title="(b) kinematic error", xlabel="turn of the wave generator [deg]", ylabel="error [arcmin]")
    spectrum.set(xlabel="waves a turn", ylabel="amplitude [arcmin]")
    if specimen.gear.accuracy is None:
        spectrum.set_axis_off()
        return missing(wave, "transmission accuracy")
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


def missing(axes: Axes, what: str) -> None:
    axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
    axes.spines[:].set_visible(False)
    axes.text(0.5, 0.5, f"no source gives its {what}", transform=axes.transAxes, ha="center", color=FAINT)


def _paper() -> dict[str, object]:
    return {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.5}

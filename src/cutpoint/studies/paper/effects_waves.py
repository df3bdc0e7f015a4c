"""Effects periodic in the rotor's angle: kinematic error, torque ripple, cogging, and their spectra."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.motor import shaft_torque
from cutpoint.model.drive import Drive
from cutpoint.model.units import ARC_MINUTE
from cutpoint.reporting.style import FORCE, INK, LINK, MOTOR, MOTOR_FILL, SPRING
from cutpoint.simulation import Log
from cutpoint.studies.drive_effects import COGGING_ORDER

ORDERS = 10.0
"""Waves a turn to which the spectrum of tracking goes."""

_MIDDLE = 0.2
"""What of the rotor's way is left out at either end, where it hardly turns."""

_PER_TURN = 256


def kinematic_error(axes: Axes, drive: Drive) -> None:
    law, angle = drive.kinematic_error, np.linspace(0.0, 2 * np.pi, 721)
    assert law is not None
    error = np.asarray(law.value(angle / drive.ratio, drive.ratio)) / ARC_MINUTE
    half = float(np.ptp(error)) / 2
    axes.axhspan(-half, half, color=MOTOR_FILL, lw=0, alpha=0.6)
    axes.plot(np.degrees(angle), error, color=MOTOR)
    axes.annotate("", (90, half), (90, -half), arrowprops={"arrowstyle": "<->", "color": FORCE, "lw": 0.9})
    axes.text(98, 0.35 * half, f"{2 * half:.2g} arcmin", color=FORCE, va="center")
    axes.set(title="(e) kinematic error", xlabel="turn of the wave generator [deg]", ylabel="error [arcmin]")
    axes.set(xticks=range(0, 361, 90), xlim=(0, 360), ylim=(-1.4 * half, 1.4 * half))


def spectrum_of_tracking(axes: Axes, tracking: Mapping[str, Log], joint: int, ratio: float) -> None:
    """The link's tracking error by waves a turn of the wave generator, as loops under two feedforwards leave it."""
    for (name, log), colour in zip(tracking.items(), (LINK, MOTOR), strict=True):
        order, amplitude = by_order(log["theta"][:, joint] * ratio, log["position_error"][:, joint])
        seen = order <= ORDERS
        axes.semilogy(order[seen], 1e3 * np.rad2deg(amplitude[seen]), color=colour, lw=1.2, label=name)
    axes.set(title="(f) tracking error that it leaves, joint 2", xlabel="waves a turn of the wave generator")
    axes.set(ylabel="error [$10^{-3}$ deg]", xlim=(0, ORDERS), ylim=(1e-5, None), xticks=range(0, int(ORDERS) + 1, 2))
    axes.minorticks_off()
    axes.legend(loc="upper right")


def by_order(angle: Array, signal: Array) -> tuple[Array, Array]:
    """Waves a turn, and their amplitudes, of a signal along an angle that only grows or only falls, rad; (N,) each."""
    way = angle[-1] - angle[0]
    whole = int(abs(way) * (1 - 2 * _MIDDLE) / (2 * np.pi))
    start = angle[0] + _MIDDLE * way
    at = start + np.sign(way) * 2 * np.pi * np.arange(whole * _PER_TURN) / _PER_TURN
    forwards = np.sign(way)
    sampled = np.interp(forwards * at, forwards * angle, signal)
    window = np.hanning(len(sampled))
    spectrum = np.abs(np.fft.rfft((sampled - sampled.mean()) * window)) * 2 / window.sum()
    return np.arange(len(spectrum)) / whole, spectrum


def torque_waves(axes: Axes, drive: Drive) -> None:
    """At the shaft over a quarter of a turn, around the torque that the gear is rated for."""
    angle = np.linspace(0.0, np.pi / 2, 721)
    loaded, unloaded = rated(drive), 0.0
    sum_, cogging = (1e3 * (delivered(drive, angle, torque) - torque) for torque in (loaded, unloaded))
    axes.plot(np.degrees(angle), sum_ - cogging, color=LINK, lw=1.2, label=f"ripple at {loaded:.2g} N m")
    axes.plot(np.degrees(angle), cogging, color=SPRING, lw=1.2, label="cogging")
    axes.plot(np.degrees(angle), sum_, color=INK, lw=1.8, label="both")
    axes.set(title="(g) torque ripple and cogging", xlabel="turn of the motor [deg]", ylabel="torque [mN m]")
    axes.set(xticks=range(0, 91, 15), xlim=(0, 90), ylim=(None, 1.75 * sum_.max()))
    axes.legend(loc="upper center", ncols=3, handlelength=1.2, columnspacing=1.0, fontsize=10)


def spectrum_of_torque(axes: Axes, drive: Drive) -> None:
    angle = np.linspace(0.0, 2 * np.pi, 1024, endpoint=False)
    for torque, colour, aside in ((rated(drive), INK, -0.35), (0.0, SPRING, 0.35)):
        waves = np.abs(np.fft.rfft(delivered(drive, angle, torque) - torque)) * 2e3 / len(angle)
        orders = np.flatnonzero(waves > 1e-9)
        axes.vlines(orders + aside, 0, waves[orders], color=colour, lw=5, label=f"at {torque:.2g} N m")
    axes.set(title="(h) their spectrum", xlabel="waves a turn of the motor", ylabel="amplitude [mN m]")
    axes.set(xticks=range(0, COGGING_ORDER + 9, 4), xlim=(0, COGGING_ORDER + 8), ylim=(0, None))
    axes.grid(visible=False, axis="x")
    axes.legend(loc="upper center", handlelength=1.2)


def rated(drive: Drive) -> float:
    """Torque at the shaft for which the gear is rated, N m."""
    assert drive.ratings is not None and drive.ratings.rated_torque is not None
    return drive.ratings.rated_torque / abs(drive.ratio)


def delivered(drive: Drive, angle: Array, torque: float) -> Array:
    """Shaft torque of an electromagnetic torque, N m."""
    return np.asarray(shaft_torque(drive, torque * drive.ratio, angle / drive.ratio)) / drive.ratio

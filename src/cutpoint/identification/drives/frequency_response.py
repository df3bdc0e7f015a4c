"""A drive's stiffness, damping and rotor inertia from the frequency response of motor position to motor torque."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares
from scipy.signal import csd, welch

from cutpoint.arrays import Array, ComplexArray
from cutpoint.door import channels, positive
from cutpoint.errors import InputError
from cutpoint.identification.drives.two_masses import TwoMasses

WINDOWS = 8
"""Window lengths in a recording, by default; windows overlap by half."""

NEIGHBOURS = 1.5
"""Bins over which a Hann window spreads one frequency: that many are one independent piece of evidence."""

LEAKAGE = 0.01
"""Relative error of a response due to windows of finite length, however coherent it is."""

COHERENT = 0.2
"""Coherence below which a frequency is not used."""

STARTS, FRICTIONS = 40, (0.01, 0.1, 0.5)
"""Antiresonances over the band from which a search may start, and frictions, over the root of stiffness times link."""

SEARCHES = 8
"""From the best starts: a spring that is well damped hardly shows its antiresonance, and a search may miss it."""

MOST_DRY = 0.5
"""Largest share of the motor's torque that dry friction may take: with more, a drive sticks."""

FEWEST = 20
"""Coherent frequencies that are fitted."""

UNCERTAIN = 0.2
"""Relative standard deviation above which an estimate counts as unidentifiable."""


@dataclass(frozen=True, eq=False)
class MotorResponse:
    """response: (F,) complex, rad/(N m), at frequencies (F,), Hz.  coherence: (F,), 0 to 1.  windows: their number.
    period: s between samples."""

    frequencies: Array
    response: ComplexArray
    coherence: Array
    windows: int
    period: float

    @property
    def deviation(self) -> Array:
        """Relative standard deviation (F,) of the response's magnitude, and that of its phase, rad, without leakage.

        Bendat and Piersol (2010) section 9.2.
        """
        return np.sqrt((1.0 - self.coherence) / (2.0 * self.windows * self.coherence))


@dataclass(frozen=True, eq=False)
class ResponseFit:
    """masses: the best fit.  deviations: relative standard deviations, by name.
    unidentifiable: what the response does not determine, each with the reason as a sentence."""

    masses: TwoMasses
    deviations: dict[str, float]
    unidentifiable: dict[str, str] = field(default_factory=dict[str, str])


def motor_response(theta: ArrayLike, torque: ArrayLike, period: float, window: float | None = None) -> MotorResponse:
    """Response of theta (N,), rad, to a motor's torque (N,), N m, from cross-spectra over Hann windows (H1).

    Encoder noise averages out; under feedback it is in the torque too and biases the response towards the inverse
    of the controller where coherence is low: excite with much more than the noise.
    window: s; by default an eighth of the recording.  Both signals are differenced to remove drift.

    Raises:
        InputError: shapes that differ, numbers that are not finite, a period or a window out of bounds.
    """
    period = positive("motor_response", "period", period, "s")
    y, u = channels("motor_response", theta=theta, torque=torque)
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        raise InputError("motor_response: theta and torque must be finite: cut out a stretch without gaps")
    length = u.size // WINDOWS if window is None else round(positive("motor_response", "window", window, "s") / period)
    if not 32 <= length <= u.size // 2:
        raise InputError(f"motor_response: a window of {length} samples must have at least 32, and at most half of all")
    shared = {"fs": 1.0 / period, "nperseg": length}
    du, dy = np.diff(u), np.diff(y)
    f, inputs = welch(du, **shared)
    _, outputs = welch(dy, **shared)
    _, crossed = csd(du, dy, **shared)
    used = (f > 0.0) & (f < 0.5 / period) & (inputs > 0.0) & (outputs > 0.0)
    coherence = np.abs(crossed[used]) ** 2 / (inputs[used] * outputs[used])
    count = 2 * du.size // length - 1
    return MotorResponse(
        f[used], (crossed[used] / inputs[used]).astype(np.complex128), coherence.clip(1e-12, 1.0 - 1e-9), count, period
    )


def fit_response(response: MotorResponse, link_inertia: float, low: float = 0.0, high: float = np.inf) -> ResponseFit:
    """Two masses with the same response, for a known link inertia (kg m2 at the joint, other joints as they were held).

    low, high: Hz, the band to be fitted: above the range of dry friction, and below that of other modes.  Deviations
        include by how much a fit differs in which dry friction takes a constant share of the torque.

    Raises:
        InputError: a link inertia that is not positive, or too few coherent frequencies in the band.
    """
    link_inertia = positive("fit_response", "link_inertia", link_inertia, "kg m2")
    f = response.frequencies
    used = (f >= low) & (f <= high) & (response.coherence > COHERENT)
    if used.sum() < FEWEST:
        found = f"{used.sum()} coherent frequencies from {low} Hz to {high} Hz; {FEWEST} are needed"
        raise InputError(f"fit_response: {found}")
    f, measured, weight = f[used], response.response[used], 1.0 / np.hypot(response.deviation[used], LEAKAGE)

    def error(logarithms: Array, dry: float = 0.0) -> Array:
        model = TwoMasses(link_inertia, *np.exp(logarithms)).position_response(f, response.period)
        # friction of constant size, as its first harmonic, takes its share along the speed
        off: Any = np.log(measured / (1.0 - 1.0j * dry * measured / np.abs(measured)) / model)
        return np.concatenate([off.real * weight, off.imag * weight])

    def search(start: Array) -> Any:
        bounds = (start - 12.0, start + 12.0)
        return least_squares(error, start, bounds=bounds, loss="soft_l1", x_scale=0.3, max_nfev=200)

    def beside_dry(start: Array) -> Array:
        found: Any = least_squares(
            lambda x: error(x[:-1], x[-1]), np.append(start, 0.2 * MOST_DRY), loss="soft_l1", max_nfev=200,
            bounds=(np.append(start - 12.0, 0.0), np.append(start + 12.0, MOST_DRY)),
        )  # fmt: skip
        return np.asarray(found.x[:-1])

    places = np.geomspace(f[1], f[-2], STARTS)
    starts = [_start(f, measured, link_inertia, at, friction) for at in places for friction in FRICTIONS]
    starts.sort(key=lambda start: float(np.sum(np.arctan(error(start)) ** 2)))
    found = min(map(search, starts[:SEARCHES]), key=lambda one: float(one.cost))
    masses = TwoMasses(link_inertia, *np.exp(found.x).tolist())
    return _judged(masses, np.asarray(found.jac), error(found.x), beside_dry(found.x) - found.x)


def _start(f: Array, measured: ComplexArray, link: float, antiresonance: float, friction: float) -> Array:
    """Initial rotor inertia, from the response where the link hardly moves, and spring, from the antiresonance."""
    stiffness = link * (2.0 * np.pi * antiresonance) ** 2
    above = f > min(2.0 * antiresonance, f[-f.size // 4])
    rotor = float(np.median(1.0 / (np.abs(measured[above]) * (2.0 * np.pi * f[above]) ** 2)))
    damping = friction * np.sqrt(stiffness * link)
    return np.log([rotor, stiffness, damping, damping, damping])


def _judged(masses: TwoMasses, slopes: Array, left: Array, change: Array) -> ResponseFit:
    """Uncertainties; noise that exceeds the coherence's estimate counts in full.

    change: of the logarithms, by dry friction beside them.
    """
    excess = max(1.0, float(np.mean(np.square(left)))) * NEIGHBOURS
    spread = np.sqrt(np.diag(np.linalg.pinv(slopes.T @ slopes, hermitian=True)) * excess)
    spread = np.hypot(spread, change)
    blind = np.linalg.norm(slopes, axis=0) < 1e-9
    names = TwoMasses._fields[1:]
    deviations = dict(zip(names, np.where(blind, np.inf, spread).tolist(), strict=True))
    why = {
        name: f"{getattr(masses, name):.3g} is uncertain by {100.0 * each:.2g} %: excite more, or longer, near it"
        for name, each in deviations.items()
        if each > UNCERTAIN
    }
    return ResponseFit(masses, deviations, why)

"""A drive's spring, kinematic error and hysteresis, from encoders on both sides and the drive's torque."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.arrays import Array
from cutpoint.door import channels, number, positive, turns_per_turn
from cutpoint.errors import InputError, unknown_name
from cutpoint.identification.conditioning.filtering import HIGHEST, noise_cutoff
from cutpoint.identification.drives.columns import amplitude_errors
from cutpoint.identification.drives.deflection_fit import ELEMENTS, fit_deflections
from cutpoint.identification.drives.deflections import DeflectionFit, Deflections, TorqueReading
from cutpoint.identification.drives.law_choice import block_errors, simplest_law
from cutpoint.identification.drives.scatter import SIGNIFICANT, covariance
from cutpoint.identification.drives.spring_estimate import FEWEST_TURNS, SpringEstimate, estimate_of
from cutpoint.identification.drives.spring_laws import LAWS, SpringLaw, as_stated
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.model.drive import Compliance

HIGHEST_ORDER = 8
"""Waves per turn of the motor that are tried where no orders are stated."""

SMALLEST_WAVE = 0.1
"""Share of the encoders' resolution: smaller waves are left out."""

WIDER = 4.0
"""The band for the deflection's rate is this many times wider than that in which it exceeds its noise: within a quarter
of its cut-off the filter changes nothing."""

LEAST_SAMPLES = 500

AS_STIFF = 0.03
"""Share by which a file's curve may be stiffer or softer than measured, in addition to noise."""

AS_STATED = "the curve stated in the files predicts the deflection as well as any other, and is as stiff: it is kept"

KNOWN = TorqueReading()
"""The reading of a known torque."""

OFFERED = (0, ELEMENTS // 2, ELEMENTS)
"""Elements of hysteresis: none or all, chosen as the law is; the effect of fewer counts as uncertainty."""


def two_encoders(
    theta: ArrayLike,
    q: ArrayLike,
    joint_torque: ArrayLike,
    period: float,
    ratio: float,
    *,
    resolution: float | None = None,
    orders: Sequence[int] | None = None,
    laws: Sequence[str] = tuple(LAWS),
    hysteresis: bool = True,
    damping: bool = True,
    reading: TorqueReading = KNOWN,
    stated: Compliance | None = None,
) -> SpringEstimate:
    """A joint's spring and all other sources of deflection, from channels (N,) on one uniform time; NaN: unknown.

    theta, q: of the encoders on motor (over ratio) and link, rad; joint_torque: of the drive on the link, N m.
    Give all three as sampled, or all through one low-pass filter: `reading` then has its cut-off, and theta before it.
    period: s.  ratio: motor turns per joint turn.  resolution: of both encoders together, rad at the joint's side; by
    default the smallest steps in the samples.  orders: of the kinematic error, waves per turn of the motor; by default
    those up to 8 that are significant.  laws: spring laws to choose from by cross-validation; one with more constants
    must predict ten held-out blocks better, by 2 % of the squares and by more than 92 % of all signs of the blocks'
    gains would make of them, also with its constants searched without each block and the simpler law beside the same
    other components; and each of its stiffnesses must exceed 4 of its standard deviations.
    Elements of hysteresis are unstrained at the first sample.
    reading: how the torque was obtained, and its unknown corrections.
    stated: the spring of a file.  If it has another law than the best, or a catalogue's, but predicts as well and is as
    stiff, it is kept: then "stiffness" is not reported.

    Raises:
        InputError: shapes, an unknown law, too few samples, or channels that do not move.
    """
    period, ratio = positive("two_encoders", "period", period, "s"), turns_per_turn("two_encoders", ratio)
    data = _deflections(theta, q, joint_torque, period, ratio, resolution, reading)
    turns = abs(ratio) * float(np.ptp(data.theta)) / (2.0 * np.pi)
    tried = orders if orders is not None else range(1, HIGHEST_ORDER + 1) if turns >= FEWEST_TURNS else ()
    offered = OFFERED if hysteresis else (0,)
    best, prediction = _best_law(data, laws, tried, offered[-1], damping)
    kept = orders if orders is not None else _standing_out(best, tried, data.resolution)
    rivals = fit_deflections(data, best.law, kept, offered, damping)
    found = estimate_of(
        data, rivals, tuple(kept), tuple(reading.unknowns), turns, prediction, hysteresis=hysteresis, damping=damping
    )
    curve = as_stated(stated) if stated and _says_more(stated, found.compliance) else None
    if curve and _is_as_good(data, curve, rivals[offered[-1]], kept, offered[-1], damping):
        found = replace(found, unidentifiable={"stiffness": AS_STATED, **found.unidentifiable})
    return found


def _deflections(
    theta: ArrayLike,
    q: ArrayLike,
    joint_torque: ArrayLike,
    period: float,
    ratio: float,
    resolution: float | None,
    reading: TorqueReading,
) -> Deflections:
    """The channels of `two_encoders` at the samples at which all are known."""
    unknowns, share = reading.unknowns, reading.transmission
    given: dict[str, ArrayLike] = {"theta": theta, "q": q, "joint_torque": joint_torque, **unknowns}
    if share is not None:
        given["transmission"] = share
    among, (angle, link, load, *own) = _known(channels("two_encoders", **given))
    known = dict(zip(unknowns, own, strict=False))
    return Deflections(
        angle - link,
        angle,
        load,
        period,
        ratio,
        _resolution(angle, link, resolution),
        cutoff=min(WIDER * noise_cutoff(angle - link, period, otherwise=HIGHEST / period), HIGHEST / period),
        reading=replace(
            reading,
            unknowns=known,
            errors=None if reading.errors is None else reading.errors[among],
            transmission=None if share is None else own[-1],
        ),
        among=among,
    )


def smallest_step(values: Array) -> float:
    """The smallest difference between samples: an encoder's resolution, if they are unprocessed; rad."""
    levels = np.unique(values[np.isfinite(values)])
    steps = np.diff(levels)
    steps = steps[steps > 1e-12 * float(np.abs(levels).max(initial=1e-288))]
    return float(steps.min()) if steps.size else 0.0


def _known(arrays: Sequence[Array]) -> tuple[NDArray[np.bool_], list[Array]]:
    """The samples at which all channels are known, and these there, angles of motor and link and torque first."""
    known = np.asarray(np.isfinite(np.column_stack(arrays)).all(axis=1), np.bool_)
    if known.sum() < LEAST_SAMPLES:
        raise InputError(f"two_encoders: {known.sum()} complete samples are too few: {LEAST_SAMPLES} are needed")
    angle, link, load, *others = (x[known] for x in arrays)
    if not (np.ptp(load) and np.ptp(angle - link)):
        raise InputError("two_encoders: torque and deflection must both change to show a spring")
    return known, [angle, link, load, *others]


def _resolution(angle: Array, link: Array, resolution: float | None) -> float:
    """Resolution of both encoders together, rad: as stated, or from the samples."""
    if resolution is None:
        return float(np.hypot(smallest_step(angle), smallest_step(link)))
    step = number("two_encoders", "resolution", resolution, "rad")
    if not (np.isfinite(step) and step >= 0.0):
        raise InputError(f"two_encoders: resolution {resolution} rad must be a number, at least 0")
    return step


def _best_law(
    data: Deflections, laws: Sequence[str], orders: Sequence[int], elements: int, damping: bool
) -> tuple[DeflectionFit, dict[str, float]]:
    """The fit with the law that predicts best; and each law's RMS residual on held-out samples, rad."""
    unknown = [name for name in laws if name not in LAWS]
    if unknown or not laws:
        raise unknown_name("spring law", unknown[0] if unknown else "", LAWS)
    tried = {name: law for name, law in LAWS.items() if name in laws}
    fits = {name: fit_deflections(data, law, orders, [elements], damping)[elements] for name, law in tried.items()}
    errors = {name: block_errors(fit) for name, fit in fits.items()}
    told = {name: fit for name, fit in fits.items() if _tells_stiffness(fit)}
    predictions = {name: float(np.sqrt(np.mean(each))) for name, each in errors.items()}
    return fits[simplest_law(told or fits, errors, data.torque)], predictions


def _says_more(stated: Compliance, found: Compliance) -> bool:
    """Whether a file's curve has more than the one found: another law, or the corners between segments, which only far
    larger torques determine reliably."""
    return type(stated) is not type(found) or isinstance(stated, CatalogueSpring)


def _is_as_good(
    data: Deflections, stated: SpringLaw, best: DeflectionFit, orders: Sequence[int], elements: int, damping: bool
) -> bool:
    """Whether a file's curve predicts held-out samples as well as the best law's fit, and is as stiff."""
    fit = fit_deflections(data, stated, orders, [elements], damping)[elements]
    rivals = {"stated": fit, "best": best}
    errors = {name: block_errors(each) for name, each in rivals.items()}
    if simplest_law(rivals, errors, data.torque) != "stated":
        return False
    spread = float(np.sqrt(covariance(fit.columns, fit.residual)[0, 0]))
    return abs(float(fit.constants[0]) - 1.0) < max(SIGNIFICANT * spread, AS_STIFF)


def _tells_stiffness(fit: DeflectionFit) -> bool:
    """Whether each of the law's stiffnesses is significantly different from zero."""
    among = slice(fit.law.stiffnesses)
    spread = np.sqrt(np.diag(covariance(fit.columns, fit.residual))[among])
    return bool((fit.constants[among] > SIGNIFICANT * spread).all())


def _standing_out(fit: DeflectionFit, orders: Sequence[int], resolution: float) -> list[int]:
    """Orders whose waves are too large to be noise, and large enough to matter."""
    among = fit.places["waves"]
    spread = amplitude_errors(fit.waves, covariance(fit.columns, fit.residual)[among, among])
    size = np.hypot(*fit.waves.reshape(-1, 2).T)
    least = SMALLEST_WAVE * resolution
    return [order for order, a, s in zip(orders, size, spread, strict=True) if a > max(SIGNIFICANT * s, least)]

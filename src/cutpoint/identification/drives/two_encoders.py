"""A drive's spring, kinematic error and hysteresis from encoders on both of its sides and the torque that it exerts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.errors import InputError, unknown_name
from cutpoint.identification.drives.columns import amplitude_errors, slipping, wave_columns, waves
from cutpoint.identification.drives.deflection_fit import ELEMENTS, DeflectionFit, Deflections, fit_deflection
from cutpoint.identification.drives.scatter import covariance
from cutpoint.identification.drives.spring_laws import LAWS
from cutpoint.identification.filtering import noise_cutoff
from cutpoint.model.drive import Compliance, Hysteresis, KinematicError

Array = NDArray[np.float64]

COUNTS = 50.0
"""Of the encoders' resolution: springs that torque winds by less, half of the range, are declared unidentifiable."""

SIGNIFICANT = 4.0
"""Standard deviations above which a wave or damping is told from nothing."""

UNCERTAIN = 0.2
"""Of the spring's deflection: with a standard deviation above that its stiffness counts as unidentifiable."""

HIGHEST_ORDER = 8
"""Waves a turn of the motor that are looked for where no orders are stated."""

SMALLEST_WAVE = 0.1
"""Of the encoders' resolution: smaller waves are left out."""

FEWEST_TURNS = 3.0
"""Of the motor: fewer do not tell waves from the spring."""

WIDER = 4.0
"""Times that the band in which the deflection's rate is taken is wider than what stands out of its noise: within a
quarter of its cut-off the filter changes nothing."""

LEAST_SAMPLES = 500

BLOCKS = 10
"""For cross-validation, one after the other."""

SURE = 2.0
"""Standard errors by which a law with more constants must predict better."""


@dataclass(frozen=True, eq=False)
class SpringEstimate:
    """What two encoders tell of a drive; None where it was not sought, not found, or cannot be told.

    compliance: of the law that predicts best, N m and rad at the joint's side.  damping: N m s/rad.
    kinematic_error, hysteresis: as a Drive takes them.  offset: rad between the encoders' zeros.
    names, values, covariance: of all unknowns, (p,), (p,), (p, p), in SI.
    counts: half the range of the spring's deflection, in steps of the encoders.  scatter: RMS of what is left, rad.
    prediction: for each law that was tried, RMS of what it leaves of samples that it was not fitted to, rad.
    unidentifiable: "stiffness", "kinematic_error", "hysteresis" or "damping", each with the sentence why.
    """

    law: str
    compliance: Compliance
    damping: float | None
    kinematic_error: KinematicError | None
    hysteresis: Hysteresis | None
    offset: float
    names: tuple[str, ...]
    values: Array
    covariance: Array = field(repr=False)
    counts: float
    scatter: float
    prediction: Mapping[str, float]
    unidentifiable: Mapping[str, str]

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each unknown, by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))


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
    torque_unknowns: Mapping[str, Array] | None = None,
) -> SpringEstimate:
    """A joint's spring and all that makes its encoders differ, from channels (N,) on one uniform time; NaN: not known.

    theta, q: of the encoders on motor (over ratio) and link, rad; joint_torque: what the drive exerts on the link, N m.
    Give all three as sampled, or all through one filter.
    period: s.  ratio: motor turns per joint turn.  resolution: of both encoders together, rad at the joint's side; by
    default the smallest steps that the samples show.  orders: of the kinematic error, waves a turn of the motor; by
    default those up to 8 that stand out.  laws: spring laws to choose from by cross-validation; one with more constants
    must predict what it was not fitted to better by two standard errors of the difference.
    Elements of hysteresis start without strain at the first sample.
    torque_unknowns: of what is not known of the torque, by name, its derivatives (N,) by it: corrections to be found.

    Raises:
        InputError: shapes, an unknown law, too few samples, or channels that do not move.
    """
    unknowns = dict(torque_unknowns or {})
    data = _checked(theta, q, joint_torque, [*unknowns.values()], period, ratio, resolution)
    unknown = [name for name in laws if name not in LAWS]
    if unknown or not laws:
        raise unknown_name("spring law", unknown[0] if unknown else "", LAWS)
    turns = abs(ratio) * float(np.ptp(data.theta)) / (2.0 * np.pi)
    tried = orders if orders is not None else range(1, HIGHEST_ORDER + 1) if turns >= FEWEST_TURNS else ()
    fits = {name: fit_deflection(data, LAWS[name], tried, ELEMENTS if hysteresis else 0, damping) for name in laws}
    errors = {name: _block_errors(fit) for name, fit in fits.items()}
    law = LAWS[_simplest(errors)]
    kept = orders if orders is not None else _standing_out(fits[law.name], tried, data.resolution)
    found = fits[law.name]
    if len(kept) < len(tried):
        found = fit_deflection(data, law, kept, ELEMENTS if hysteresis else 0, damping)
    prediction = {name: float(np.sqrt(np.mean(each))) for name, each in errors.items()}
    return _estimate(data, found, tuple(kept), tuple(unknowns), turns, prediction, hysteresis, damping)


def smallest_step(values: Array) -> float:
    """The finest difference between samples: an encoder's resolution, where nothing else was done to them; rad."""
    levels = np.unique(values[np.isfinite(values)])
    steps = np.diff(levels)
    steps = steps[steps > 1e-12 * max(float(np.abs(levels).max()), 1e-300)]
    return float(steps.min()) if steps.size else 0.0


def _checked(
    theta: ArrayLike,
    q: ArrayLike,
    torque: ArrayLike,
    corrections: Sequence[ArrayLike],
    period: float,
    ratio: float,
    resolution: float | None,
) -> Deflections:
    arrays = [np.asarray(x, dtype=np.float64) for x in (theta, q, torque, *corrections)]
    shapes = [x.shape for x in arrays]
    if arrays[0].ndim != 1 or len(set(shapes)) > 1:
        raise InputError(f"two_encoders: theta, q, joint torque, unknowns have shapes {shapes}: each must be (N,)")
    known = np.isfinite(np.column_stack(arrays)).all(axis=1)
    if known.sum() < LEAST_SAMPLES:
        raise InputError(f"two_encoders: {known.sum()} complete samples are too few: {LEAST_SAMPLES} are needed")
    angle, link, load, *others = (x[known] for x in arrays)
    if not (np.ptp(load) and np.ptp(angle - link)):
        raise InputError("two_encoders: neither torque nor deflection may stand still: they show no spring")
    step = float(np.hypot(smallest_step(angle), smallest_step(link))) if resolution is None else float(resolution)
    if not (np.isfinite(step) and step >= 0.0):
        raise InputError(f"two_encoders: resolution {resolution} rad must be a number, at least 0")
    cutoff = min(WIDER * noise_cutoff(angle - link, period), 0.4 / period)
    beside = np.column_stack(others) if others else np.empty((load.size, 0))
    return Deflections(angle - link, angle, load, period, ratio, step, cutoff, beside)


def _standing_out(fit: DeflectionFit, orders: Sequence[int], resolution: float) -> list[int]:
    """Orders whose waves are too large to be noise, and large enough to matter."""
    start = fit.constants.size
    among = slice(start, start + fit.waves.size)
    spread = amplitude_errors(fit.waves, covariance(fit.columns, fit.residual)[among, among])
    size = np.hypot(*fit.waves.reshape(-1, 2).T)
    least = SMALLEST_WAVE * resolution
    return [order for order, a, s in zip(orders, size, spread, strict=True) if a > max(SIGNIFICANT * s, least)]


def _block_errors(fit: DeflectionFit) -> Array:
    """Mean square of what each block's samples are left with by a fit to all others, (BLOCKS,), rad2.

    The law's constants move along their tangents; what slips stays where it was found.
    """
    used = fit.columns.any(axis=0)
    size = np.linalg.norm(fit.columns[:, used], axis=0)
    columns = np.array_split(fit.columns[:, used] / size, BLOCKS)
    targets = np.array_split(fit.residual, BLOCKS)
    grams = [x.T @ x for x in columns]
    sides = [x.T @ y for x, y in zip(columns, targets, strict=True)]
    found = []
    for k, (x, y) in enumerate(zip(columns, targets, strict=True)):
        weights, *_ = np.linalg.lstsq(sum(grams) - grams[k], sum(sides) - sides[k])
        found.append(float(np.mean((y - x @ weights) ** 2)))
    return np.array(found)


def _simplest(errors: Mapping[str, Array]) -> str:
    """The law of the fewest constants unless one with more is surely better."""
    names = [name for name in LAWS if name in errors]
    best = names[0]
    for name in names[1:]:
        gain = errors[best] - errors[name]
        if gain.mean() > SURE * gain.std(ddof=1) / np.sqrt(BLOCKS):
            best = name
    return best


def _estimate(
    data: Deflections,
    fit: DeflectionFit,
    orders: tuple[int, ...],
    unknowns: tuple[str, ...],
    turns: float,
    prediction: Mapping[str, float],
    hysteresis: bool,
    damping: bool,
) -> SpringEstimate:
    names, values = _named(fit, orders, unknowns, damping)
    spread = covariance(fit.columns, fit.residual)
    counts = 0.5 * float(np.ptp(fit.law.deflection(fit.constants, data.torque))) / (data.resolution or np.nan)
    why: dict[str, str] = {}
    if counts < COUNTS:
        why["stiffness"] = (
            f"torque winds the spring by {counts:.3g} steps of the encoders, half its range: {COUNTS:g} are needed; "
            "excite with more torque, or measure more finely"
        )
    elif (share := _uncertainty(data, fit, spread)) > UNCERTAIN:
        why["stiffness"] = (
            f"under the largest torque its deflection is uncertain by {100.0 * share:.2g} %: what else the encoders "
            "differ by outweighs it, or hides it"
        )
    if not orders:
        why["kinematic_error"] = _no_waves(data, fit, turns)
    slips = slipping(fit.stiffness, fit.reaches)
    opening = 2.0 * float(np.sum(fit.stiffness * fit.reaches / np.median(fit.tangent)))
    if hysteresis and opening < data.resolution:
        slips = None
        why["hysteresis"] = (
            f"loops open by {opening:.2g} rad, less than the encoders' step of {data.resolution:.2g} rad"
        )
    damped = fit.damping if damping else None
    if damping and fit.damping < SIGNIFICANT * np.sqrt(spread[-1, -1]):
        damped = None
        why["damping"] = f"{fit.damping:.3g} +- {np.sqrt(spread[-1, -1]):.2g} N m s/rad is not told from none"
    return SpringEstimate(
        fit.law.name,
        fit.law.make(fit.constants),
        damped,
        waves(orders, fit.waves),
        slips,
        fit.offset,
        names,
        values,
        spread,
        counts,
        float(np.sqrt(np.mean(fit.residual**2))),
        prediction,
        why,
    )


def _uncertainty(data: Deflections, fit: DeflectionFit, spread: Array) -> float:
    """Standard deviation of the spring's deflection under the largest torque, over that deflection."""
    largest = np.array([np.abs(data.torque).max()])
    by = fit.law.columns(fit.constants, largest)[0]
    own = spread[: by.size, : by.size]
    return float(np.sqrt(by @ own @ by) / fit.law.deflection(fit.constants, largest)[0])


def _named(
    fit: DeflectionFit, orders: Sequence[int], unknowns: Sequence[str], damping: bool
) -> tuple[tuple[str, ...], Array]:
    waves_of = [f"{wave} {order}" for order in orders for wave in ("sine", "cosine")]
    elements = [f"element {k + 1}" for k in range(fit.stiffness.size)]
    names = [*fit.law.constants, *waves_of, "offset", *unknowns, *elements, *(["damping"] if damping else [])]
    last = [fit.damping] if damping else []
    return tuple(names), np.concatenate([fit.constants, fit.waves, [fit.offset], fit.corrections, fit.stiffness, last])


def _no_waves(data: Deflections, fit: DeflectionFit, turns: float) -> str:
    if turns < FEWEST_TURNS:
        return f"the motor turned {turns:.2g} times: {FEWEST_TURNS:g} are needed to tell its waves from the spring"
    columns = np.column_stack([fit.columns, wave_columns(data.ratio * data.theta, [2])])
    noise = np.sqrt(np.diag(covariance(columns, fit.residual))[-2:].max())
    return f"no wave stands out of the noise: of order 2, one of {SIGNIFICANT * noise:.2g} rad would"

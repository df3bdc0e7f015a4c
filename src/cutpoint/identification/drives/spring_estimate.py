"""What two encoders tell of a drive, and which of it counts as told."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.drives.columns import slipping, wave_columns, waves
from cutpoint.identification.drives.deflections import DeflectionFit, Deflections
from cutpoint.identification.drives.law_choice import block_errors, not_worse, simplest
from cutpoint.identification.drives.scatter import covariance
from cutpoint.identification.drives.torque_noise import without_attenuation
from cutpoint.model.drive import Compliance, Hysteresis, KinematicError

Array = NDArray[np.float64]

COUNTS = 50.0
"""Of the encoders' resolution: springs that torque winds by less, half of the range, are declared unidentifiable."""

UNCERTAIN = 0.2
"""Of the spring's deflection: with a standard deviation above that its stiffness counts as unidentifiable."""

SIGNIFICANT = 4.0
"""Standard deviations above which a wave or damping is told from nothing."""

FEWEST_TURNS = 3.0
"""Of the motor: fewer do not tell waves from the spring."""


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

    def __getitem__(self, name: str) -> float:
        return float(self.values[self.names.index(name)])

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each unknown, by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))


def estimate_of(
    data: Deflections,
    rivals: Mapping[int, DeflectionFit],
    orders: tuple[int, ...],
    unknowns: tuple[str, ...],
    turns: float,
    prediction: Mapping[str, float],
    hysteresis: bool,
    damping: bool,
) -> SpringEstimate:
    """rivals: fits by the elements that they were offered, the fewest or the most of which are taken; whichever do not
    surely predict worse count as uncertainty."""
    errors = {count: block_errors(each) for count, each in rivals.items()}
    best = simplest({count: errors[count] for count in (min(errors), max(errors))})
    fit = rivals[best]
    names, values = _named(fit, orders, unknowns, damping)
    spread = covariance(fit.columns, fit.residual)
    for other in not_worse(errors, best):
        apart = _apart(names, values, *_named(rivals[other], orders, unknowns, damping))
        spread = spread + np.outer(apart, apart)
    fit = without_attenuation(data, fit)
    values = fit.values
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
    reaches = [f"reach {k + 1}" for k in range(fit.stiffness.size if fit.moving else 0)]
    names = [*fit.law.constants, *waves_of, "offset", *unknowns, *reaches, *elements, *(["damping"] if damping else [])]
    return tuple(names), fit.values


def _apart(names: Sequence[str], values: Array, others: Sequence[str], theirs: Array) -> Array:
    """By how much another fit's values differ, (p,); elements, which are others there, do not count."""
    known = {name: x for name, x in zip(others, theirs.tolist(), strict=True) if not name.startswith(("reach", "elem"))}
    return np.array([known.get(name, x) - x for name, x in zip(names, values.tolist(), strict=True)])


def _no_waves(data: Deflections, fit: DeflectionFit, turns: float) -> str:
    if turns < FEWEST_TURNS:
        return f"the motor turned {turns:.2g} times: {FEWEST_TURNS:g} are needed to tell its waves from the spring"
    columns = np.column_stack([fit.columns, wave_columns(data.ratio * data.theta, [2])])
    noise = np.sqrt(np.diag(covariance(columns, fit.residual))[-2:].max())
    return f"no wave stands out of the noise: of order 2, one of {SIGNIFICANT * noise:.2g} rad would"

"""Estimates of a drive from two encoders, and which of them are significant."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.drives.columns import slipping, waves
from cutpoint.identification.drives.deflections import DeflectionFit, Deflections
from cutpoint.identification.drives.law_choice import block_errors, not_worse, simplest
from cutpoint.identification.drives.scatter import SIGNIFICANT, Unknowns, covariance
from cutpoint.identification.drives.torque_noise import attenuation, spread_of_errors, without_attenuation
from cutpoint.model.drive import Compliance, Hysteresis, KinematicError

COUNTS = 20.0
"""Times the encoders' resolution: springs with a smaller deflection, half of the range, are declared unidentifiable."""

FEW, UNEVEN = 50.0, 0.5
"""With so few steps their uneven sizes matter: half a step over half of the deflection's range, one standard deviation.
"""

WITH_DEFLECTION = ("stiffness", "k1", "k2", "k3")
"""Constants of spring laws that decrease as the deflection increases."""

OPEN = 2.0
"""Times the encoders' resolution: narrower loops are declared unidentifiable."""

UNCERTAIN = 0.2
"""Relative standard deviation of the spring's deflection above which its stiffness counts as unidentifiable."""

NEAR_ZERO = 0.1
"""Share of the largest torque: if torque never comes this close to zero, a curve's beginning is extrapolated."""

SURELY = 12.0
"""Standard deviations of a damping beside an undetermined spring: what hides that spring looks like damping."""

AGAINST = -0.5
"""Correlation of the motor's lead with the torque: noise on a spring of the right sign does not cause that."""

TOGETHER = 0.4
"""Correlation of waves with the spring's deflection: over several turns, a kinematic error's is near zero."""

FEWEST_TURNS = 3.0
"""Turns of the motor: fewer do not separate waves from the spring."""


@dataclass(frozen=True, eq=False)
class SpringEstimate(Unknowns):
    """Estimates of a drive from two encoders; None where not sought, not found, or not determined.

    compliance: of the law that predicts best, N m and rad at the joint's side.  damping: N m s/rad.
    kinematic_error, hysteresis: as a Drive takes them.  offset: rad between the encoders' zeros.
    names, values, covariance: of all unknowns, (p,), (p,), (p, p), in SI.
    counts: half the range of the spring's deflection, in steps of the encoders.  scatter: RMS of the residual, rad.
    prediction: for each law tried, RMS residual in cross-validation, rad.
    unidentifiable: "stiffness", "curve near zero torque", "kinematic_error", "hysteresis" or "damping", each with the
    reason.
    """

    law: str
    compliance: Compliance
    damping: float | None
    kinematic_error: KinematicError | None
    hysteresis: Hysteresis | None
    offset: float
    counts: float
    scatter: float
    prediction: Mapping[str, float]
    unidentifiable: Mapping[str, str]

    def torque(self, theta: Array, q: Array, ratio: float) -> Array:
        """Spring torque, N m, (N,), at encoder readings theta and q, rad, without the elements parallel to it."""
        waves = 0.0 if self.kinematic_error is None else self.kinematic_error.value(theta, ratio)
        return np.asarray(self.compliance.torque(theta - q - waves - self.offset))


def estimate_of(
    data: Deflections,
    rivals: Mapping[int, DeflectionFit],
    orders: tuple[int, ...],
    unknowns: tuple[str, ...],
    turns: float,
    prediction: Mapping[str, float],
    *,
    hysteresis: bool,
    damping: bool,
) -> SpringEstimate:
    """Estimates of the fit that predicts best, and which of them are not significant.

    rivals: fits by the number of elements offered; the fewest or the most are taken, and the mean square difference of
    those that do not predict significantly worse counts as uncertainty.
    """
    fit, names, spread = _chosen(rivals, orders, unknowns, damping)
    hidden = attenuation(data, fit)
    fit, spread = without_attenuation(data, fit), spread + np.outer(hidden, hidden) + spread_of_errors(data, fit)
    counts = 0.5 * float(np.ptp(fit.law.deflection(fit.constants, data.torque))) / (data.resolution or np.nan)
    if 0.0 < counts < FEW:
        uneven = np.array([UNEVEN / counts * (name in WITH_DEFLECTION) for name in names]) * fit.values
        spread = spread + np.outer(uneven, uneven)
    weak = _weak(data, fit, spread, counts)
    sentences = {
        "stiffness": weak,
        "curve near zero torque": _bare(data, fit),
        "kinematic_error": _confounded(data, fit, orders) if orders else _no_waves(data, fit, turns),
        "hysteresis": _closed(data, fit) if hysteresis else "",
        "damping": _undamped(fit, float(np.sqrt(spread[-1, -1])), not weak) if damping else "",
    }
    why = {thing: sentence for thing, sentence in sentences.items() if sentence}
    return SpringEstimate(
        law=fit.law.name,
        compliance=fit.law.spring(fit.constants),
        damping=fit.damping if damping and "damping" not in why else None,
        kinematic_error=None if "kinematic_error" in why else waves(orders, fit.waves),
        hysteresis=None if "hysteresis" in why else slipping(fit.stiffness, fit.reaches),
        offset=fit.offset,
        names=names,
        values=fit.values,
        covariance=spread,
        counts=counts,
        scatter=float(np.sqrt(np.mean(fit.residual**2))),
        prediction=prediction,
        unidentifiable=why,
    )


def _chosen(
    rivals: Mapping[int, DeflectionFit], orders: Sequence[int], unknowns: Sequence[str], damping: bool
) -> tuple[DeflectionFit, tuple[str, ...], Array]:
    """The fit that predicts best, with its unknowns' names and covariance."""
    errors = {count: block_errors(each) for count, each in rivals.items()}
    best = simplest({count: errors[count] for count in (min(errors), max(errors))})
    fit, names = rivals[best], _names(rivals[best], orders, unknowns, damping)
    spread = covariance(fit.columns, fit.residual)
    others = [rivals[count] for count in not_worse(errors, best)]
    for other in others:
        differences = _differences(names, fit.values, _names(other, orders, unknowns, damping), other.values)
        # not their sum: of whatever number that is offered, the same elements are often left
        spread = spread + np.outer(differences, differences) / len(others)
    return fit, names, spread


def _weak(data: Deflections, fit: DeflectionFit, spread: Array, counts: float) -> str:
    if counts < COUNTS:
        if (likeness := _likeness(data.lead, data.torque)) < AGAINST:
            against = f"the motor's lead opposes the torque, correlation {likeness:.2f}"
            return f"{against}: are q and theta swapped, or is a sign reversed?"
        steps = f"{counts:.3g} steps" if counts >= 1.0 else "less than a step"
        return (
            f"torque winds the spring, over half its range, by {steps} of the encoders: {COUNTS:g} are needed; "
            "excite with more torque, or measure more finely"
        )
    if (share := _uncertainty(data, fit, spread)) > UNCERTAIN:
        return (
            f"under the largest torque its deflection is uncertain by {100.0 * share:.2g} %: other differences between "
            "the encoders outweigh or hide it"
        )
    return ""


def _likeness(x: Array, y: Array) -> float:
    """Their correlation, 0 if either is constant."""
    x, y = x - x.mean(), y - y.mean()
    return float(x @ y / max(float(np.linalg.norm(x) * np.linalg.norm(y)), np.finfo(float).tiny))


def _bare(data: Deflections, fit: DeflectionFit) -> str:
    size = np.abs(data.torque)
    if fit.law.constants == ("stiffness",) or size.min() < NEAR_ZERO * size.max():
        return ""
    return f"torque was never below {size.min():.3g} N m: the curve there is extrapolated; excite on both sides of zero"


def _closed(data: Deflections, fit: DeflectionFit) -> str:
    if not fit.stiffness.size:
        return "no spring that slips predicts significantly better than one without; damping may stand in for its loss"
    opening = 2.0 * float(np.sum(fit.stiffness * fit.reaches / np.median(fit.tangent)))
    if opening >= OPEN * data.resolution:
        return ""
    return f"loops open by {opening:.2g} rad, less than {OPEN:g} encoder steps of {data.resolution:.2g} rad each"


def _undamped(fit: DeflectionFit, deviation: float, is_spring_told: bool) -> str:
    surely, beside = (SIGNIFICANT, "") if is_spring_told else (SURELY, " while the spring is not told")
    told = fit.damping >= surely * deviation
    return "" if told else f"{fit.damping:.3g} +- {deviation:.2g} N m s/rad cannot be told from zero{beside}"


def _uncertainty(data: Deflections, fit: DeflectionFit, spread: Array) -> float:
    """Standard deviation of the spring's deflection under the largest torque, over that deflection."""
    largest = np.array([np.abs(data.torque).max()])
    by = fit.law.columns(fit.constants, largest)[0]
    counts = np.flatnonzero(by)  # a constant that does not matter at this torque may be undetermined
    own = spread[np.ix_(counts, counts)]
    return float(np.sqrt(by[counts] @ own @ by[counts]) / fit.law.deflection(fit.constants, largest)[0])


def _names(fit: DeflectionFit, orders: Sequence[int], unknowns: Sequence[str], damping: bool) -> tuple[str, ...]:
    """Names of all unknowns, in the order of the fit's values."""
    waves_of = [f"{wave} {order}" for order in orders for wave in ("sine", "cosine")]
    elements = [f"element {k + 1}" for k in range(fit.stiffness.size)]
    reaches = [f"reach {k + 1}" for k in range(fit.stiffness.size if fit.moving else 0)]
    return (*fit.law.constants, *waves_of, "offset", *unknowns, *reaches, *elements, *(["damping"] if damping else []))


def _differences(names: Sequence[str], values: Array, others: Sequence[str], theirs: Array) -> Array:
    """By how much another fit's values differ, (p,); its elements are different ones and do not count."""
    known = {name: x for name, x in zip(others, theirs.tolist(), strict=True) if not name.startswith(("reach", "elem"))}
    return np.array([known.get(name, x) - x for name, x in zip(names, values.tolist(), strict=True)])


def _confounded(data: Deflections, fit: DeflectionFit, orders: Sequence[int]) -> str:
    """Waves that correlate with the spring's deflection, of either sign, cannot be separated from it."""
    waves = data.waves(orders) @ fit.waves
    share = _likeness(waves, fit.law.deflection(fit.constants, data.torque))
    if abs(share) <= TOGETHER:
        return ""
    size = f"waves of {np.std(waves):.2g} rad RMS vary {'with' if share > 0 else 'against'} the spring's deflection"
    remedy = "turn the motor farther, or excite with more torque"
    return f"{size}, correlation {share:.2f}, and cannot be told from it; {remedy}"


def _no_waves(data: Deflections, fit: DeflectionFit, turns: float) -> str:
    if turns < FEWEST_TURNS:
        return f"the motor made {turns:.2g} turns: {FEWEST_TURNS:g} are needed to tell its waves from the spring"
    columns = np.column_stack([fit.columns, data.waves([2])])
    noise = np.sqrt(np.diag(covariance(columns, fit.residual))[-2:].max())
    return f"no wave stands out from the noise: at order 2, one of {SIGNIFICANT * noise:.2g} rad would"

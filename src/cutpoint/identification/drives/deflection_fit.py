"""One spring law fitted to a measured deflection, together with all else that the deflection is made of.

theta - q = deflection(tau_f - slipping - damping) + e(theta) + offset, the law's inverse developed to first order in
what acts beside the spring: less (slipping + damping rate) / tangent.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from cutpoint.identification.drives.columns import merged, strain_columns, wave_columns
from cutpoint.identification.drives.spring_laws import Projection, SpringLaw, fitted
from cutpoint.identification.filtering import derivative, low_pass

Array = NDArray[np.float64]

ROUNDS = 4
"""Times that the spring and what acts beside it are fitted in turn: hysteresis of a tenth of the torque settles."""

ELEMENTS = 8
"""Of hysteresis, offered to the first round."""

LARGEST_REACH = 0.6
"""Of the largest deflection: elements that slip only beyond it are part of the spring, for all that one can see."""


@dataclass(frozen=True, eq=False)
class Deflections:
    """A joint's measured channels, each (N,), without gaps: theta - q and theta in rad, torque in N m; period, s.

    resolution: rad at the joint's side.  cutoff: Hz, of what the deflection's rate and turning points are read from.
    """

    lead: Array
    theta: Array
    torque: Array
    period: float
    ratio: float
    resolution: float
    cutoff: float
    band: float | None = None

    def passed(self, columns: Array) -> Array:
        """Columns (N, ...) in the band in which they are compared, (M, ...), without the ends that a filter loses."""
        if self.band is None:
            return columns
        found = low_pass(columns, self.period, self.band)
        return found[np.isfinite(found.reshape(len(found), -1)).all(axis=1)]

    def smooth(self, values: Array) -> Array:
        """Low-passed, the ends as they are."""
        found = low_pass(values, self.period, self.cutoff)
        return np.where(np.isfinite(found), found, values)


@dataclass(frozen=True, eq=False)
class DeflectionFit:
    """A law's constants, the weights of waves, offset (rad), elements' stiffnesses and damping, and what is left.

    columns: the model's derivatives (N, p) by all of these, in that order.  residual: (N,), rad.  tangent: (N,).
    """

    law: SpringLaw
    constants: Array
    waves: Array
    offset: float
    stiffness: Array
    damping: float
    reaches: Array
    tangent: Array = field(repr=False)
    columns: Array = field(repr=False)
    residual: Array = field(repr=False)


def fit_deflection(data: Deflections, law: SpringLaw, orders: Sequence[int], elements: int, damped: bool) -> DeflectionFit:
    """`elements` of hysteresis at most, 0 for none; `damped` seeks the spring's own damping."""
    raw = np.column_stack([wave_columns(data.ratio * data.theta, orders), np.ones_like(data.theta)])
    free = raw, data.passed(raw)
    found = _first(data, law, free[1])
    reaches = _offered(data, found, elements)
    for turn in range(ROUNDS if elements or damped else 0):
        found = _round(data, replace(found, reaches=reaches), free, damped, search=turn == 1)
        if turn == 0:
            reaches = merged(found.stiffness, reaches)
    return found


def _first(data: Deflections, law: SpringLaw, free: Array) -> DeflectionFit:
    """Without anything beside the spring."""
    constants = fitted(law, data.torque, data.lead, _projection(data, free))
    spring = law.deflection(constants, data.torque)
    target = data.passed(data.lead - spring)
    weights, *_ = np.linalg.lstsq(free, target)
    columns = np.column_stack([data.passed(law.columns(constants, data.torque)), free])
    tangent = np.asarray(law.make(constants).tangent(spring))
    left = target - free @ weights
    nothing = np.empty(0)
    return DeflectionFit(
        law, constants, weights[:-1], float(weights[-1]), nothing, 0.0, nothing, tangent, columns, left
    )


def _round(data: Deflections, before: DeflectionFit, frees: tuple[Array, Array], damped: bool, search: bool) -> DeflectionFit:
    """The spring again with what acted beside it, then that again with the spring."""
    law, constants = before.law, before.constants
    raw, free = frees
    wound = data.smooth(data.lead - raw @ np.append(before.waves, before.offset))
    beside = -strain_columns(wound, before.reaches) / before.tangent[:, None]
    rate = -np.gradient(wound, data.period) / before.tangent
    beside = data.passed(np.column_stack([beside, rate]) if damped else beside)
    if search:
        constants = fitted(law, data.torque, data.lead, _projection(data, np.column_stack([free, beside])))
    target = data.passed(data.lead - law.deflection(constants, data.torque))
    own = data.passed(law.columns(constants, data.torque))
    columns = np.column_stack([own, free, beside])
    count = own.shape[1] + free.shape[1]
    weights = _not_negative(columns, target, count)
    # the law's columns let spring and elements settle between them; the next round searches the constants anew
    left = target - columns @ weights
    change, weights = weights[: own.shape[1]], weights[own.shape[1] :]
    constants = np.maximum(constants + change, 0.5 * constants)
    stiffness = weights[free.shape[1] :][: before.reaches.size]
    return DeflectionFit(
        law,
        constants,
        weights[: free.shape[1] - 1],
        float(weights[free.shape[1] - 1]),
        stiffness,
        float(weights[-1]) if damped else 0.0,
        before.reaches,
        np.asarray(law.make(constants).tangent(wound)),
        columns,
        left,
    )


def _offered(data: Deflections, found: DeflectionFit, elements: int) -> Array:
    """Reaches from the encoders' resolution up to what the deflection comes to, rad."""
    largest = LARGEST_REACH * 0.5 * float(np.ptp(found.law.deflection(found.constants, data.torque)))
    if not elements or largest <= data.resolution:
        return np.empty(0)
    return np.geomspace(max(data.resolution, largest / 30.0), largest, elements)


def _projection(data: Deflections, columns: Array) -> Projection:
    """What of a raw column the others cannot make up, in the band."""
    basis, _ = np.linalg.qr(columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny))

    def project(values: Array) -> Array:
        passed = data.passed(values)
        return passed - basis @ (basis.T @ passed)

    return project


def _not_negative(columns: Array, target: Array, free: int) -> Array:
    """Least-squares weights, those after the first `free` at least 0."""
    size = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    reduced = np.linalg.qr(np.column_stack([columns / size, target]), mode="r")
    lower = np.where(np.arange(size.size) < free, -np.inf, 0.0)
    found = lsq_linear(reduced[:, :-1], reduced[:, -1], (lower, np.inf), method="bvls")
    return np.asarray(found.x / size)

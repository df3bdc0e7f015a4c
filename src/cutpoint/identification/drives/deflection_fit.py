"""Fits one spring law to a measured deflection, together with the deflection's other components.

theta - q = deflection(tau_f - slipping - damping rate) + e(theta) + offset, with the law's inverse expanded to first
order in the torques parallel to the spring and in torque corrections: both are divided by the law's tangent.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.drives.bounded import bounded_weights
from cutpoint.identification.drives.columns import paired, reach_columns, strain_columns
from cutpoint.identification.drives.deflections import DeflectionFit, Deflections
from cutpoint.identification.drives.spring_laws import SpringLaw, beside, fitted

ROUNDS = 4
"""Rounds that fit the spring and the parallel elements in turn: hysteresis of a tenth of the torque converges."""

SEARCHED = 20_000
"""Largest number of samples from which a law's constants are searched."""

ELEMENTS = 8
"""Reaches of hysteresis elements offered to the first round."""

RANGE = 30.0
"""Largest ratio of the longest reach offered to the shortest."""

NEIGHBOURS = 1.01 * RANGE ** (1.0 / (ELEMENTS - 1))
"""Largest ratio of neighbouring reaches offered."""

LARGEST_REACH = 0.6
"""Share of the largest deflection: elements that slip only beyond it are indistinguishable from the spring."""

BESIDE, POSITIVE = ("corrections", "reaches", "elements", "damping"), ("elements", "damping")
"""Components besides the spring, and which of them cannot be negative."""


@dataclass(frozen=True, eq=False)
class _Free:
    """Unbounded components: waves and offset (N, 2 k + 1), rad; derivatives of the torque by the waves, (N, 2 k), and
    what it includes of them already, (N,), as in `Deflections.torque_by_waves`."""

    alone: Array
    torque: Array
    had: Array

    def wound(self, tangent: Array) -> tuple[Array, Array]:
        """These over a spring's tangent (N,): derivatives of the deflection (N, 2 k + 1), what it includes already."""
        columns = self.alone.copy()
        columns[:, :-1] += self.torque / tangent[:, None]
        return columns, self.had / tangent


def fit_deflections(
    data: Deflections, law: SpringLaw, orders: Sequence[int], offered: Sequence[int], damped: bool
) -> dict[int, DeflectionFit]:
    """Fits with at most these numbers of hysteresis elements, 0 for none; `damped` also fits the spring's damping."""
    free = _Free(np.column_stack([data.waves(orders), np.ones_like(data.theta)]), *data.torque_by_waves(orders))
    first = _first(data, law, free.alone)
    return {elements: _with_elements(data, first, free, elements, damped) for elements in offered}


def _with_elements(data: Deflections, found: DeflectionFit, free: _Free, elements: int, damped: bool) -> DeflectionFit:
    """Fits the spring and the elements parallel to it alternately."""
    reaches = _offered(data, found, elements)
    for turn in range(ROUNDS):
        found = _round(data, replace(found, reaches=reaches), free, damped)
        if turn == ROUNDS - 2:
            reaches = reaches[found.stiffness > 0.0]
    return _with_reaches(data, found, free, damped) if found.stiffness.any() else found


def _with_reaches(data: Deflections, before: DeflectionFit, free: _Free, damped: bool) -> DeflectionFit:
    """A fit with fewer elements but free reaches, if its residual is smaller."""
    stiffness, reaches = paired(before.stiffness, before.reaches, NEIGHBOURS)
    found = replace(before, stiffness=stiffness, reaches=reaches, moving=True)
    for _ in range(ROUNDS):
        found = _round(data, found, free, damped)
    return found if float(np.linalg.norm(found.residual)) < float(np.linalg.norm(before.residual)) else before


def _first(data: Deflections, law: SpringLaw, free: Array) -> DeflectionFit:
    """A fit of the spring alone."""
    constants = _searched(law, data.torque, data.lead, free)
    spring = law.deflection(constants, data.torque)
    target = data.lead - spring
    weights = np.linalg.lstsq(free, target, rcond=None)[0].astype(np.float64)
    columns = np.column_stack([law.columns(constants, data.torque), free])
    tangent = np.asarray(law.spring(constants).tangent(spring))
    left = target - free @ weights
    none, zero = np.empty(0), np.zeros_like(left)
    return DeflectionFit(
        law, constants, weights[:-1], float(weights[-1]), none, none, 0.0, none, tangent, zero, columns, left
    )


def _round(data: Deflections, before: DeflectionFit, free: _Free, damped: bool) -> DeflectionFit:
    """Refits the spring given the parallel elements, then these given the spring."""
    constants = before.constants
    unbound, had = free.wound(before.tangent)
    # with free reaches, the step below changes the constants too
    if before.beside.any() and not before.moving:
        constants = _searched(before.law, data.torque, data.lead + had - before.beside, unbound, before.constants)
    wound = data.smooth(data.lead - free.alone @ np.append(before.waves, before.offset))
    blocks = _blocks(data, replace(before, constants=constants), unbound, wound, damped)
    columns = np.column_stack([*blocks.values()])
    target = data.lead + had - before.law.deflection(constants, data.torque)
    weights = bounded_weights(columns, target, sum(blocks[name].shape[1] for name in blocks if name not in POSITIVE))
    ends = np.cumsum([block.shape[1] for block in blocks.values()])
    found = dict(zip(blocks, np.split(weights, ends[:-1]), strict=True))
    # a Gauss-Newton step in the constants, so that spring and elements converge together
    constants, reaches = np.clip(constants + found["constants"], 0.5 * constants, 2.0 * constants), before.reaches
    if before.moving:
        reaches = np.clip(reaches + found["reaches"], 0.7 * reaches, 1.4 * reaches)
    return replace(
        before,
        constants=constants,
        waves=found["waves"],
        offset=float(found["offset"][0]),
        corrections=found["corrections"],
        stiffness=found["elements"],
        damping=float(found["damping"].sum()),
        reaches=reaches,
        tangent=np.asarray(before.law.spring(constants).tangent(wound)),
        beside=np.sum([blocks[name] @ found[name] for name in BESIDE], axis=0),
        columns=columns,
        residual=target - columns @ weights,
    )


def _blocks(data: Deflections, fit: DeflectionFit, free: Array, wound: Array, damped: bool) -> dict[str, Array]:
    """Derivatives of the deflection, (N, k) each, in the order of `DeflectionFit.columns`.  wound: (N,), rad."""
    none, tangent = np.empty((wound.size, 0)), fit.tangent[:, None]
    return {
        "constants": fit.law.columns(fit.constants, data.torque),
        "waves": free[:, :-1],
        "offset": free[:, -1:],
        "corrections": data.corrections / tangent,
        "reaches": -reach_columns(wound, fit.stiffness, fit.reaches) / tangent if fit.moving else none,
        "elements": -strain_columns(wound, fit.reaches) / tangent,
        "damping": -data.rate(wound)[:, None] / tangent if damped else none,
    }


def _offered(data: Deflections, found: DeflectionFit, elements: int) -> Array:
    """Reaches from the encoders' resolution up to the largest deflection, rad."""
    largest = LARGEST_REACH * 0.5 * float(np.ptp(found.law.deflection(found.constants, data.torque)))
    if not elements or largest <= data.resolution:
        return np.empty(0)
    return np.geomspace(max(data.resolution, largest / RANGE), largest, elements)


def _searched(law: SpringLaw, torque: Array, lead: Array, others: Array, near: Array | None = None) -> Array:
    """The law's constants from some evenly spread samples; all samples refine them later.  near: as in `fitted`."""
    thin = slice(None, None, 1 + lead.size // SEARCHED)
    columns = others[thin]
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    return fitted(law, torque[thin], lead[thin], beside(columns), near)

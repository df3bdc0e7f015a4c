"""Cross-validation of several fits of a deflection."""

from collections.abc import Hashable, Mapping
from itertools import product
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.drives.deflections import DeflectionFit
from cutpoint.identification.drives.spring_laws import SpringLaw, beside, fitted

Name = TypeVar("Name", bound=Hashable)

BLOCKS = 10
"""Contiguous blocks for cross-validation."""

SIGNS = np.array(list(product((-1.0, 1.0), repeat=BLOCKS)))
"""All choices of signs of the blocks' gains, the given ones last."""

CHANCE = 0.08
"""Share of them that may gain as much as a law with more constants: that of 1.5 standard errors, if gains are alike."""

LEAST_IMPROVEMENT = 0.02
"""Share of the squared error that it must gain: samples of a repeated motion are not independent."""

SEARCHED = 2000
"""Samples from which a law's constants are searched without a block: filtered ones are not independent."""


def block_errors(fit: DeflectionFit) -> Array:
    """Mean square residual of each block under a fit to all others, (BLOCKS,), rad2.

    The law's constants are linearised; slipping elements stay as estimated.
    """
    used = fit.columns.any(axis=0)
    size = np.linalg.norm(fit.columns[:, used], axis=0)
    columns = np.array_split(fit.columns[:, used] / size, BLOCKS)
    targets = np.array_split(fit.residual, BLOCKS)
    grams = [x.T @ x for x in columns]
    sides = [x.T @ y for x, y in zip(columns, targets, strict=True)]
    found = []
    for k, (x, y) in enumerate(zip(columns, targets, strict=True)):
        weights, *_ = np.linalg.lstsq(sum(grams) - grams[k], sum(sides) - sides[k], rcond=None)
        found.append(float(np.mean((y - x @ weights) ** 2)))
    return np.array(found)


def law_errors(law: SpringLaw, fit: DeflectionFit, torque: Array) -> Array:
    """As `block_errors`, of a law beside the other components of a fit, which may be of another law.

    The law's constants are searched anew without each block: with corners that all blocks chose, a catalogue's law
    fitted the noise of each.  torque: (N,), N m.
    """
    count = fit.constants.size
    others = fit.columns[:, count:][:, fit.columns[:, count:].any(axis=0)]
    others = others / np.linalg.norm(others, axis=0)
    target = fit.law.deflection(fit.constants, torque) + fit.residual
    blocks = np.array_split(np.arange(torque.size), BLOCKS)
    return np.array([_error_without(block, law, others, target, torque) for block in blocks])


def _error_without(block: NDArray[np.intp], law: SpringLaw, others: Array, target: Array, torque: Array) -> float:
    """Mean square residual of a block under a fit of law and other columns (N, k) to all others, rad2."""
    kept = np.delete(np.arange(torque.size), block)
    some = kept[:: 1 + kept.size // SEARCHED]
    constants = fitted(law, torque[some], target[some], beside(others[some]), None)
    left = target - law.deflection(constants, torque)
    weights, *_ = np.linalg.lstsq(others[kept].T @ others[kept], others[kept].T @ left[kept], rcond=None)
    return float(np.mean((left[block] - others[block] @ weights) ** 2))


def simplest_law(fits: Mapping[Name, DeflectionFit], errors: Mapping[Name, Array], torque: Array) -> Name:
    """As `simplest`, of fits with different laws; errors: their `block_errors`.

    A later law must also be better by `law_errors`, with both laws beside its own other components: with other elements
    of hysteresis, the same law predicts differently.
    """
    best, *others = fits
    for name in others:
        if simplest({each: errors[each] for each in (best, name)}) == name:
            best = simplest({each: law_errors(fits[each].law, fits[name], torque) for each in (best, name)})
    return best


def simplest(errors: Mapping[Name, Array]) -> Name:
    """The first of fits ordered by complexity, unless a later one is significantly better."""
    best, *others = errors
    for name in others:
        gain = errors[best] - errors[name]
        if gain.mean() > LEAST_IMPROVEMENT * errors[best].mean() and _by_chance(gain) < CHANCE:
            best = name
    return best


def _by_chance(gain: Array) -> float:
    """Share of all choices of signs with which the gains (BLOCKS,) add up to as much.  Fisher (1935), section 21.

    Their standard error would hide a gain in every block behind a far larger one in a single block.
    """
    sums = SIGNS @ gain
    return float(np.mean(sums >= sums[-1]))


def not_worse(errors: Mapping[Name, Array], best: Name) -> list[Name]:
    """Other fits that do not predict significantly worse than the best, by one standard error of the difference."""
    lost = {name: each - errors[best] for name, each in errors.items() if name != best}
    return [name for name, each in lost.items() if each.mean() <= each.std(ddof=1) / np.sqrt(BLOCKS)]

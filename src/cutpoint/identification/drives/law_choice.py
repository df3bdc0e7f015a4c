"""Cross-validation of several fits of a deflection."""

from collections.abc import Hashable, Mapping
from itertools import product
from typing import TypeVar

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.drives.deflections import DeflectionFit

Name = TypeVar("Name", bound=Hashable)

BLOCKS = 10
"""Contiguous blocks for cross-validation."""

SIGNS = np.array(list(product((-1.0, 1.0), repeat=BLOCKS)))
"""All choices of signs of the blocks' gains, the given ones last."""

CHANCE = 0.08
"""Share of them that may gain as much as a law with more constants: that of 1.5 standard errors, if gains are alike."""

LEAST_IMPROVEMENT = 0.02
"""Share of the squared error that it must gain: samples of a repeated motion are not independent."""


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
        weights, *_ = np.linalg.lstsq(sum(grams) - grams[k], sum(sides) - sides[k])
        found.append(float(np.mean((y - x @ weights) ** 2)))
    return np.array(found)


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

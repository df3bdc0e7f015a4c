"""Update laws for estimated parameters, one period at a time.  s is the power error per unit of a parameter, W.

Both make a quadratic or log-like distance to the true parameters shrink; they differ in the constraints they enforce:
bounds on single numbers, or physically consistent bodies.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from cutpoint.mechanics.bodies.pseudo_inertia import parameters_of_pseudo_inertia, pseudo_inertia
from cutpoint.scalars import Scalar, absolute, clip, maximum, sqrt, where

Matrix = list[list[Scalar]]

_LONGEST = 2.0
"""Size of X in a step of `natural`: the estimate changes by a factor of at most e^2 a period."""


def projected(p: Scalar, s: Scalar, rate: Scalar, low: Scalar, high: Scalar, period: Scalar) -> Scalar:
    """p' = rate s, stopped at its bounds.  Zhu (2010) section 2.10, the projection function P, sampled."""
    return clip(p + period * rate * s, low, high)


def unless_saturated(learnt: Any, before: Any, torque: Any, limits: Any) -> Any:
    """The parameters learnt in a period, or those before it if any motor's command exceeded its limit: tracking errors
    are then no evidence against the model."""
    within: Scalar = 1
    for u, most in zip(torque, limits, strict=True):
        within = where(absolute(u) > most, 0, within)
    return _chosen(within, learnt, before)


def _chosen(condition: Scalar, first: Any, second: Any) -> Any:
    if isinstance(first, list):
        return [_chosen(condition, *pair) for pair in zip(first, second, strict=True)]
    return where(condition > 0, first, second)


def factor(p: Sequence[float]) -> Matrix:
    """C with L = C C^T, for a physical body; for a point or a rod L is singular, and stays so."""
    values, vectors = np.linalg.eigh(np.array(pseudo_inertia(p), float))
    return (vectors * np.sqrt(np.maximum(values, 0.0))).tolist()


def inertial_of_factor(C: Matrix) -> list[Scalar]:
    """The ten parameters of L = C C^T, physically consistent for any C."""
    return parameters_of_pseudo_inertia(_product(C, _transposed(C)))


def natural(C: Matrix, s: Sequence[Scalar], rate: Scalar, period: Scalar) -> Matrix:
    """L' = rate L S L on the factor C of L, where tr(S L) is s^T p.  Lee, Kwon and Park (2018).

    A step of the exponential map, L exp(X) with X = period rate C^T S C, its root taken as (1 + (1 + X/2)^2) / 2, which
    is positive definite for every X, and falls where X does down to X = -2: a longer step is shortened to that size.
    """
    X = _product(_transposed(C), _product(power_matrix(s), C))
    size = sqrt(sum(x * x for row in X for x in row)) * (period * rate)
    step = period * rate * (_LONGEST / maximum(size, _LONGEST))
    half = [[step / 2 * x + int(i == j) for j, x in enumerate(row)] for i, row in enumerate(X)]
    square = _product(half, half)
    return _product(C, [[(x + int(i == j)) / 2 for j, x in enumerate(row)] for i, row in enumerate(square)])


def power_matrix(s: Sequence[Scalar]) -> Matrix:
    """S, symmetric, with tr(S L) = s^T p."""
    m, hx, hy, hz, xx, xy, xz, yy, yz, zz = s
    return [
        [yy + zz, -xy / 2, -xz / 2, hx / 2],
        [-xy / 2, xx + zz, -yz / 2, hy / 2],
        [-xz / 2, -yz / 2, xx + yy, hz / 2],
        [hx / 2, hy / 2, hz / 2, m],
    ]


def _product(A: Matrix, B: Matrix) -> Matrix:
    columns = _transposed(B)
    return [[sum((a * b for a, b in zip(row, column, strict=True)), 0) for column in columns] for row in A]


def _transposed(A: Matrix) -> Matrix:
    return [list(column) for column in zip(*A, strict=True)]

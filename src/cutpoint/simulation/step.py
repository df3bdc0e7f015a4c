"""One integration step between two control samples."""

from itertools import product

import numpy as np

from cutpoint.scalars import Scalar

GAMMA = 1 / 4

TABLEAU = np.array([
    [1 / 2, 1 / 6, -1 / 4, 7 / 32, 1 / 16],
    [1 / 2, 1 / 3, -23 / 32, -1 / 16, 0.0],
    [1.0, 1 / 3, 0.0, 0.0, 0.0],
    [0.0, 1 / 6, 0.0, 0.0, 0.0],
])  # fmt: skip
"""A linearly implicit step, a row a stage: how far to go for the next stage, this stage's weight, and how much of its
accelerations the next three stages take into their implicit part.

A W-method, Steihaug and Wolfbrandt (1979): its order does not depend on how well the implicit part follows friction.
Without friction it is the classical Runge-Kutta step of order 4.  The rest is ours, made so that GAMMA = 1/4 gives
order 3 for any resistance, also one that changes from stage to stage as mass and friction do; friction however fast
is damped out in one step (L-stable), and no stage overshoots.  `tests/simulation/test_step.py` holds it to that.
"""


def stage(
    k: list[Scalar], origin: list[Scalar], total: list[Scalar], row: list[Scalar], h: Scalar
) -> tuple[list[Scalar], list[Scalar]]:
    """The next stage's state, and the step's result so far, from the rates k.  Hairer et al. (1993) section II.1."""
    ahead, weight = row[0] * h, row[1] * h
    y = [x + ahead * r for x, r in zip(origin, k, strict=True)]
    return y, [x + weight * r for x, r in zip(total, k, strict=True)]


def handed_on(accelerations: list[Scalar], earlier: list[Scalar], row: list[Scalar], h: Scalar) -> list[Scalar]:
    """Speeds that this stage and those before add in the next stages' implicit parts, stage by stage."""
    waiting = [*earlier[len(accelerations) :], *[0] * len(accelerations)]
    return [x + share * h * k for x, (share, k) in zip(waiting, product(row[2:], accelerations), strict=True)]

"""One integration step between two control samples."""

from itertools import product

import numpy as np

from cutpoint.scalars import Scalar

GAMMA = 1 / 4

TABLEAU = np.array([
    [1 / 2, 1 / 6, -1 / 4, 7 / 32, 1 / 16, 1 / 3, 0.0, 1 / 6, 0.0],
    [1 / 2, 1 / 3, -23 / 32, -1 / 16, 0.0, 1 / 6, 4 / 21, 1 / 7, 0.0],
    [1.0, 1 / 3, 0.0, 0.0, 0.0, 15 / 28, -5 / 14, -1 / 28, 6 / 7],
    [0.0, 1 / 6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
])  # fmt: skip
"""A linearly implicit step, a row a stage: how far to go for the next stage, this stage's weight, how much of its
accelerations the next three stages take into their implicit part, and by which speeds coordinates go to the next stage:
the step's first, this stage's, the next stage's, the step's last as far as it is known.

A W-method, Steihaug and Wolfbrandt (1979): its order does not depend on how well the implicit part follows friction.
Without friction speeds take the classical Runge-Kutta step of order 4; coordinates go between stages as a Nystrom
method's may, by speeds that were chosen so that what swings on springs loses no amplitude in steps up to 2.9 / omega,
and of its phase 56 times less; van der Houwen and Sommeijer (1987).  The rest is ours, made so that GAMMA = 1/4 gives
order 3 for any resistance, also one that changes from stage to stage as mass and friction do; friction however fast is
damped out in one step (L-stable), and no stage overshoots.  `tests/simulation/test_step.py` holds it to that.
"""


def stage(
    state: list[Scalar], k: list[Scalar], origin: list[Scalar], total: list[Scalar], row: list[Scalar], h: Scalar
) -> tuple[list[Scalar], list[Scalar]]:
    """The next stage's state, and the step's result so far, from the state's rates k.

    Hairer et al. (1993) sections II.1, II.14.  Coordinates whose rate is a speed of the state use a Nystrom method.
    """
    ahead, weight, *shares = (h * x for x in (*row[:2], *row[5:]))
    y = [x + ahead * r for x, r in zip(origin, k, strict=True)]
    total = [x + weight * r for x, r in zip(total, k, strict=True)]
    speeds = {id(x): j for j, x in enumerate(state)}  # by identity: such a rate is the state's own number
    for i, rate in enumerate(k):
        if (j := speeds.get(id(rate))) is not None:
            y[i] = sum((share * x[j] for share, x in zip(shares, (origin, state, y, total), strict=True)), origin[i])
    return y, total


def added_speeds(accelerations: list[Scalar], earlier: list[Scalar], row: list[Scalar], h: Scalar) -> list[Scalar]:
    """Speeds that this and earlier stages add in the next stages' implicit parts, stage by stage."""
    waiting = [*earlier[len(accelerations) :], *[0] * len(accelerations)]
    return [x + share * h * k for x, (share, k) in zip(waiting, product(row[2:5], accelerations), strict=True)]

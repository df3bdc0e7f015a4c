"""A user's own trajectory whose derivatives are not those of its positions is believed, but not in silence."""

import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cutpoint import simulate
from cutpoint.studies.sizing import sizing
from cutpoint.trajectories import cycloid
from robot_library import robot

ARM = robot("xia2019")
MOTION = cycloid(np.full(6, 0.3), 0.2)

Change = Callable[[np.ndarray], None]


class Own:
    """The motion, with something changed in its (order + 1, N, 6) numbers."""

    duration, size = MOTION.duration, MOTION.size

    def __init__(self, change: Change) -> None:
        self.change = change

    def derivatives(self, t: Any, order: int) -> np.ndarray:
        found = np.array(MOTION.derivatives(t, order))
        self.change(found)
        return found


def scaled(order: int, joint: int, factor: float) -> Change:
    def change(x: np.ndarray) -> None:
        x[order, :, joint] *= factor

    return change


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (scaled(1, 1, 180.0 / np.pi), "velocity of 'joint2' is 57.3 times the rate of the position"),
        (scaled(2, 4, -1.0), "acceleration of 'joint5' is -1 times the rate of the velocity"),
        (scaled(1, 3, 0.0), "velocity of 'joint4' is 0 times the rate of the position"),
        (scaled(3, 3, 0.0), "jerk of 'joint4' is 0 times the rate of the acceleration"),
        (scaled(4, 0, 0.5), "snap of 'joint1' is 0.5 times the rate of the jerk"),
    ],
)
@pytest.mark.parametrize("study", [lambda move: simulate(ARM, None, move), lambda move: sizing(ARM, move)])
def test_derivatives_that_contradict_one_another_are_named(change: Change, told: str, study: Callable[[Any], object]):
    with pytest.warns(UserWarning, match=f"the trajectory contradicts itself: .*the {re.escape(told)}"):
        study(Own(change))


def jumps(x: np.ndarray) -> None:
    """From one set point to the next, at rest on each."""
    x[0] = np.round(x[0], 1)
    x[1:] = 0.0


def drops(x: np.ndarray) -> None:
    x[0, x.shape[1] // 2 :] -= 0.2


def trapezoidal(x: np.ndarray) -> None:
    """Constant accelerations, of which the second has the other sign."""
    t, half = np.linspace(0.0, MOTION.duration, x.shape[1])[:, None], 0.5 * MOTION.duration
    x[2], x[3:] = np.where(t < half, 3.0, -3.0), 0.0
    x[1] = 3.0 * np.minimum(t, MOTION.duration - t)
    x[0] = np.where(t < half, 1.5 * t**2, 3.0 * half**2 - 1.5 * (MOTION.duration - t) ** 2)


def cruises(x: np.ndarray) -> None:
    """At constant speed, which rounding changes in every sample."""
    x[0] = np.linspace(0.0, 0.1 * MOTION.duration, x.shape[1])[:, None]
    x[1] = 0.1 + 1e-15 * np.arange(x.shape[1])[:, None]
    x[2:] = 0.0


@pytest.mark.parametrize("change", [lambda x: None, jumps, drops, trapezoidal, cruises])
def test_nothing_is_said_of_good_ones_nor_of_steps(change: Change):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(ARM, None, Own(change))

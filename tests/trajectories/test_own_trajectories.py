"""A user's own trajectory is looked at: what is no trajectory is refused, and what contradicts itself is named."""

import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, simulate, simulate_many
from cutpoint.studies.sizing import sizing
from cutpoint.trajectories import cycloid, retimed
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


def still(t: Any, order: int) -> np.ndarray:
    return np.zeros((order + 1, *np.shape(t), 6))


def moving(**parts: Any) -> Any:
    """An object with duration, size and derivatives, some of them others."""
    given = {"duration": 0.02, "size": 6, "derivatives": staticmethod(still)} | parts
    return type("Mine", (), given)()


STUDIES = {
    "simulate": lambda move: simulate(ARM, None, move),
    "simulate_many: run 0": lambda move: simulate_many(ARM, None, [move]),
    "sizing": lambda move: sizing(ARM, move),
    "retimed": lambda move: retimed(move, 0.02).derivatives(np.arange(3.0)),
}


@pytest.mark.parametrize("who", STUDIES)
@pytest.mark.parametrize(
    ("move", "message"),
    [
        (moving(derivatives=lambda self, t: still(t, 4)), r"trajectory.derivatives must take \(t, order\), but takes"),
        (moving(derivatives=lambda self, t, *, order: 0), r"must take \(t, order\), but takes \(t, \*, order\)"),
        (moving(derivatives=3), r"trajectory.derivatives must be a function of \(t, order\), got 3"),
        (moving(derivatives=lambda self, t, order: None), r"derivatives\(times, 4\) must be numbers of .*, got None"),
        (moving(derivatives=lambda self, t, order: 0.0), r"derivatives\(times, 4\) has shape \(\)"),
        (moving(derivatives=lambda self, t, order: still(t, 2)), r"has shape \(3, \d+, 6\): it must be \(5, \d+, 6\)"),
        (moving(derivatives=lambda self, t, order: still(t, 9)), r"has shape \(10, \d+, 6\): it must be \(5, \d+, 6\)"),
        (moving(derivatives=lambda self, t, order: still(t[1:], order)), r"has shape \(5, \d+, 6\): it must be"),
        (moving(derivatives=lambda self, t, order: still(t, order) * np.nan), "is nan: every number must be finite"),
        (moving(derivatives=lambda self, t, order: still(t, order) * 1j), "must be numbers of .* of complex128"),
        (type(moving()), r"trajectory Mine is a class; pass an instance, Mine\(...\)"),
    ],
)
def test_what_is_no_trajectory_is_refused_by_everything_that_takes_one(who: str, move: Any, message: str):
    with pytest.raises(InputError, match=f"{who}: .*{message}"):
        STUDIES[who](move)


def test_joints_that_are_no_names_are_refused():
    for who in ("simulate", "simulate_many: run 0", "sizing"):
        with pytest.raises(InputError, match=f"{who}: trajectory.joints must be names, .* got 6"):
            STUDIES[who](moving(joints=6))


@pytest.mark.parametrize("duration", [None, "1", np.ones(1)])
def test_a_duration_is_one_number(duration: Any):
    for who in ("simulate", "simulate_many", "sizing", "retimed"):
        study = STUDIES["simulate_many: run 0" if who == "simulate_many" else who]
        with pytest.raises(InputError, match=f"{who}: trajectory.duration must be one number, s, got"):
            study(moving(duration=duration))


@pytest.mark.parametrize("duration", [0.0, -1.0, np.inf, np.nan])
def test_what_has_no_duration_cannot_be_retimed(duration: float):
    with pytest.raises(InputError, match=f"retimed: trajectory.duration {duration} s must be positive and finite"):
        retimed(moving(duration=duration), 1.0)


@pytest.mark.parametrize("study", [{}, {"accuracy": "reference"}, {"hold": False}])
def test_lists_and_numbers_of_any_kind_do(study: dict[str, Any]):
    expected = simulate(ARM, None, moving(), **study)["q"]
    for kind in (lambda x: x.tolist(), tuple, np.float32, np.int64):
        own = moving(derivatives=lambda self, t, order, kind=kind: kind(still(t, order)), size=np.int64(6))
        assert np.array_equal(simulate(ARM, None, own, **study)["q"], expected)
    endless = moving(duration=np.inf)
    assert np.array_equal(simulate(ARM, None, endless, 0.02, **study)["q"], expected)


@pytest.mark.parametrize("who", STUDIES)
def test_a_function_of_one_time_is_told_that_it_is_given_many(who: str):
    def of_one_time(self: object, t: Any, order: int) -> Any:
        return still(t, order) if t > 0 else 0.0

    with pytest.raises(ValueError, match="truth value") as failed:
        STUDIES[who](moving(derivatives=of_one_time))
    assert "trajectory.derivatives is given all times at once, an array of shape" in failed.value.__notes__[0]

"""Properties of every kind of trajectory."""

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutpoint.errors import InputError
from cutpoint.trajectories import Trajectory, cycloid, from_samples, quintic, retimed, septic, waypoints

START = [0.2, 0.3, -0.7]
END = [1.5, -0.4, -0.7]
DURATION = 2.5
SAMPLED = np.linspace(0.0, DURATION, 60)
KINDS: dict[str, Trajectory] = {
    "cycloid": cycloid(END, DURATION, start=START),
    "quintic": quintic(END, DURATION, start=START),
    "septic": septic(END, DURATION, start=START),
    "waypoints": waypoints([0.0, 0.8, 1.4, DURATION], [START, [0.9, 0.1, -0.7], [1.1, 0.2, -0.7], END]),
    "samples": from_samples(SAMPLED, quintic(END, DURATION, start=START)(SAMPLED).q),
    "samples in motion": from_samples(
        SAMPLED, START + np.sin(3.0 * SAMPLED)[:, None] * np.subtract(END, START), at_rest=False
    ),
    "retimed": retimed(quintic(END, 0.7 * DURATION, start=START), DURATION),
}
kinds = pytest.mark.parametrize("trajectory", KINDS.values(), ids=KINDS.keys())


@kinds
@given(u=st.floats(0.0, 1.0))
def test_each_derivative_is_the_slope_of_the_one_before(trajectory: Trajectory, u: float):
    # by the mean value theorem a central difference is the derivative at a place at most h away
    h = 1e-4 * DURATION
    t = h + u * (DURATION - 2.0 * h)
    before, after = trajectory.derivatives([t - h, t + h], 6).swapaxes(0, 1)
    slope = (after - before)[:6] / (2.0 * h)
    near = np.abs(trajectory.derivatives(np.linspace(t - h, t + h, 9), 7)).max(axis=1)
    # each derivative of a spline multiplies rounding by up to twice its degree over its knot spacing
    steepest = 14.0 / getattr(trajectory, "unit", DURATION)
    rounding = 1e-15 * steepest ** np.arange(6.0)[:, None] / h
    # the fifth derivative of a quintic spline, and the seventh of the smoothed one, may jump
    orders = 4 if trajectory is KINDS["waypoints"] else 6
    wrong = np.abs(slope - trajectory.derivatives(t, 6)[1:])
    assert (wrong <= 1.1 * h * near[2:] + rounding)[:orders].all()


@kinds
@pytest.mark.parametrize("t", [0.7, -1.0, [], [0.0, 1.0, 9.0], [[0.1, 0.2, 0.3], [DURATION, np.inf, -np.inf]]])
def test_a_batch_of_times_is_each_time_alone(trajectory: Trajectory, t: object):
    times = np.asarray(t, dtype=float)
    found = trajectory.derivatives(times, 14)
    assert found.shape == (15, *times.shape, trajectory.size)
    for index in np.ndindex(times.shape):
        assert np.array_equal(found[(slice(None), *index)], trajectory.derivatives(times[index], 14))


@kinds
def test_a_call_gives_position_to_snap(trajectory: Trajectory):
    sample = trajectory(SAMPLED)
    assert sample._fields == ("q", "v", "a", "jerk", "snap")
    assert np.array_equal(np.stack(sample), trajectory.derivatives(SAMPLED, 4))


@kinds
@given(early=st.floats(max_value=-1e-300), late=st.floats(1e-9, 1e300))
def test_it_stands_still_outside_its_duration(trajectory: Trajectory, early: float, late: float):
    found = trajectory.derivatives([early, DURATION + late], 9)
    assert np.array_equal(found[0], trajectory([0.0, DURATION]).q)
    assert not found[1:].any()


@kinds
def test_a_joint_that_is_told_to_stay_stays(trajectory: Trajectory):
    found = trajectory.derivatives(SAMPLED, 4)[..., 2]
    assert np.allclose(found[0], -0.7, rtol=0.0, atol=1e-15)
    assert not found[1:].any()


@kinds
def test_it_survives_pickling(trajectory: Trajectory):
    copy = pickle.loads(pickle.dumps(trajectory))
    assert np.array_equal(copy.derivatives(SAMPLED), trajectory.derivatives(SAMPLED))


@kinds
def test_a_time_that_is_no_number_is_refused(trajectory: Trajectory):
    with pytest.raises(InputError, match="time t is NaN"):
        trajectory([0.0, np.nan])
    with pytest.raises(InputError, match="time t must be an array of numbers"):
        trajectory("soon")  # pyright: ignore[reportArgumentType]


@kinds
def test_a_negative_order_is_refused(trajectory: Trajectory):
    with pytest.raises(InputError, match="derivatives: order -1 must be a whole number, at least 0"):
        trajectory.derivatives(0.0, -1)


@pytest.mark.parametrize("order", [2.5, np.nan, "2", None, True])
def test_an_order_that_is_no_whole_number_is_refused(order: Any):
    with pytest.raises(InputError, match=r"derivatives: order .* must be a whole number, at least 0"):
        cycloid([1.0], 1.0).derivatives(0.3, order)


@pytest.mark.parametrize("duration", [1e-300, 1e-90])
@pytest.mark.parametrize("make", [cycloid, septic, lambda end, duration: waypoints([0.0, duration], [[0.0], end])])
def test_a_motion_whose_derivatives_no_float_holds_is_refused(make: Any, duration: float):
    with pytest.raises(InputError, match=rf"duration {duration} s is too short for derivatives up to order 4"):
        make([1.0], duration)(0.0)
    assert make([1.0], duration).derivatives(duration, 0) == 1.0


@pytest.mark.parametrize("make", [cycloid, septic, lambda end, duration: waypoints([0.0, duration], [[0.0], end])])
def test_a_motion_may_be_as_slow_as_numbers_go(make: Any):
    found = make([1.0], 1e15).derivatives(5e14, 4)
    assert abs(found[0] - 0.5) < 1e-12 and np.abs(found[2:]).max() < 1e-29


@pytest.mark.parametrize("far", [1e200, -1e308, np.inf, np.nan])
def test_positions_that_no_machine_has_are_refused_and_time_is_not_blamed(far: float):
    t, q = np.linspace(0.0, 1.0, 9), np.zeros((9, 2))
    q[4, 1] = far
    for make, told in (
        (lambda: cycloid([0.0, far], 1.0), "end of joint 1 is"),
        (lambda: septic([0.0, 0.0], 1.0, [0.0, far]), "start of joint 1 is"),
        (lambda: waypoints(t, q), "joint 1: position"),
        (lambda: from_samples(t, q), "joint 1: position"),
    ):
        with pytest.raises(InputError, match=rf"{told} .* must be finite and within 1e\+15"):
            make()


@kinds
@pytest.mark.parametrize("duration", [0.3, DURATION, 40.0])
def test_in_another_time_it_goes_the_same_way(trajectory: Trajectory, duration: float):
    slower, share = duration / DURATION, np.linspace(0.0, 1.0, 33)
    found = retimed(trajectory, duration).derivatives(share * duration, 4)
    expected = trajectory.derivatives(share * DURATION, 5)
    # a time that is rounded moves a derivative by the next one; each derivative of a spline multiplies rounding itself
    steepest = 14.0 / getattr(trajectory, "unit", DURATION)
    rounding = 1e-14 * (DURATION * np.abs(expected[1:]).max(axis=(1, 2)) + steepest ** np.arange(5.0))
    wrong = np.abs(found * slower ** np.arange(5.0)[:, None, None] - expected[:5])
    assert (wrong.max(axis=(1, 2)) <= rounding).all()


def test_only_a_motion_can_be_retimed_and_only_to_a_time_that_is_one():
    with pytest.raises(InputError, match=r"retimed: trajectory must be a trajectory: one of cutpoint.trajectories"):
        retimed(START, 1.0)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match=r"retimed: duration 0.0 s must be positive"):
        retimed(KINDS["cycloid"], 0.0)


def test_a_motion_too_fast_for_any_machine_may_be_retimed_to_one_that_is_not():
    found = retimed(cycloid([1.0], 1e-5), 1.0).derivatives(0.3, 4)
    assert np.allclose(found, cycloid([1.0], 1.0).derivatives(0.3, 4), rtol=1e-12)

"""Splines through points."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from cutpoint.errors import InputError
from cutpoint.trajectories import Trajectory, waypoints

REAL = st.floats(-3.0, 3.0, allow_subnormal=False)


@st.composite
def routes(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray, Trajectory]:
    """Times, points, and the motion through them, at every scale of time."""
    count = draw(st.integers(2, 12))
    steps = draw(hnp.arrays(float, count - 1, elements=st.floats(0.3, 3.0)))
    times = draw(REAL) + draw(st.sampled_from([1e-3, 1.0, 1e3])) * np.concatenate([[0.0], np.cumsum(steps)])
    points = draw(hnp.arrays(float, (count, 2), elements=REAL))
    try:
        return times, points, waypoints(times, points)
    except InputError as error:
        assume("swing" not in str(error))
        raise


def rounding(times: np.ndarray, points: np.ndarray) -> np.ndarray:
    """What rounding may do to derivatives 0 to 4: each multiplies by twice the degree over the knot spacing."""
    steepest = 2.0 * 5.0 / (np.diff(times).min() / 3.0)
    return 1e-14 * max(np.abs(points).max(), 1e-200) * steepest ** np.arange(5.0)


@given(routes())
def test_the_motion_passes_through_its_points(route: tuple[np.ndarray, np.ndarray, Trajectory]):
    times, points, trajectory = route
    assert trajectory.duration == times[-1] - times[0]
    assert np.allclose(trajectory(times - times[0]).q, points, rtol=0.0, atol=1e-12)


@given(routes())
def test_it_starts_and_ends_at_rest_up_to_the_snap(route: tuple[np.ndarray, np.ndarray, Trajectory]):
    times, points, trajectory = route
    ends = np.abs(trajectory.derivatives([0.0, trajectory.duration])).max(axis=(1, 2))
    assert (ends <= rounding(times, points))[1:].all()


@given(routes())
def test_four_derivatives_are_continuous_at_the_points(route: tuple[np.ndarray, np.ndarray, Trajectory]):
    times, points, trajectory = route
    step = 1e-6 * float(np.diff(times).min())
    inner = (times - times[0])[1:-1]
    jumps = np.abs(trajectory.derivatives(inner + step) - trajectory.derivatives(inner - step))
    steepest = np.abs(trajectory.derivatives(np.linspace(0.0, trajectory.duration, 400), 5)).max(axis=(1, 2))[1:]
    assert (jumps.max(axis=(1, 2), initial=0.0) <= 4.0 * step * steepest + rounding(times, points)).all()


@given(routes(), st.sampled_from([0.25, 8.0]))
def test_a_slower_motion_has_smaller_derivatives_by_the_power(
    route: tuple[np.ndarray, np.ndarray, Trajectory], slower: float
):
    times, points, trajectory = route
    slow = waypoints(slower * times, points)
    at = np.linspace(0.1, 0.9, 7) * trajectory.duration
    power = slower ** np.arange(5.0)[:, None, None]
    wrong = np.abs(slow.derivatives(slower * at) * power - trajectory.derivatives(at))
    assert (wrong.max(axis=(1, 2)) <= rounding(times, points)).all()


@given(routes())
def test_it_swings_past_its_points_by_no_more_than_their_range(route: tuple[np.ndarray, np.ndarray, Trajectory]):
    _, points, trajectory = route
    reached = trajectory(np.linspace(0.0, trajectory.duration, 1000)).q
    beyond = 1.01 * np.ptp(points, axis=0) + 1e-8 * np.abs(points).max()
    assert (reached <= points.max(axis=0) + beyond).all()
    assert (reached >= points.min(axis=0) - beyond).all()


def test_a_motion_of_two_points_is_the_same_in_both_directions():
    there, back = waypoints([0.0, 2.0], [[0.0], [1.0]]), waypoints([0.0, 2.0], [[1.0], [0.0]])
    at = np.linspace(0.0, 2.0, 21)
    assert np.allclose(there(at).q, back(2.0 - at).q, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize(
    ("times", "points", "message"),
    [
        ([0.0], [[1.0]], r"1 point found: at least 2 are needed"),
        ([0.0, 1.0], [[0.0], [np.nan]], r"joint 0: position nan at index 1 must be finite"),
        ([0.0, np.inf], [[0.0], [1.0]], r"time at index 1 is inf: it must be finite"),
        ([0.0, 1e300], [[0.0], [1.0]], r"time at index 1 is 1e\+300: it must be finite and within 1e\+15 s"),
        ([0.0, 1e-90, 1.0], [[0.0], [1.0], [2.0]], r"1e-90 s between two times of 1 s in all are too uneven"),
        ([0.0, 2.0, 1.0], [[0.0], [1.0], [2.0]], r"time 1.0 s at index 2 must be later than 2.0 s, the one before it"),
        ([0.0, 0.0], [[0.0], [1.0]], r"time 0.0 s at index 1 must be later than 0.0 s"),
        ([0.0, 1.0, 2.0], [[0.0], [1.0]], r"times of shape \(3,\) and positions of shape \(2, 1\) must be"),
        ([0.0, 1.0], [0.0, 1.0], r"positions of shape \(2,\) must be \(N,\) and \(N, joints\)"),
        ([0.0, 1.0], [[], []], r"positions of shape \(2, 0\)"),
        ([0.0, 1.0], [[0.0], [1.0, 2.0]], r"positions must be an array of numbers"),
        (
            [0.0, 1e-3, 1.0],
            [[0.0], [1.0], [0.0]],
            r"joint 0: the curve would swing .* past its points.*give far",
        ),
    ],
)
def test_what_cannot_be_a_motion_is_refused(times: list, points: list, message: str):
    with pytest.raises(InputError, match=message):
        waypoints(times, points)

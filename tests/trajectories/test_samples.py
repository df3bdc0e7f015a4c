"""Motions near samples."""

from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import trapezoid

from cutpoint.errors import InputError
from cutpoint.trajectories import Trajectory, cycloid, from_samples

TIMES = np.linspace(0.0, 4.0, 801)


@pytest.mark.parametrize("frequency", [0.0, 1.0, 2.5, 5.0, 10.0, 20.0])
def test_it_filters_as_it_says_without_phase(frequency: float):
    wave = np.stack([np.cos(2 * np.pi * frequency * TIMES), np.sin(2 * np.pi * frequency * TIMES)], axis=1)
    found = from_samples(TIMES, wave, bandwidth=10.0, at_rest=False)(TIMES).q
    middle = slice(200, 600)
    gain = 1.0 / (1.0 + (frequency / 10.0) ** 8)
    assert np.allclose(found[middle], gain * wave[middle], rtol=0.0, atol=1e-5)


@given(
    coefficients=st.lists(st.integers(-2000, 2000).map(lambda n: n / 1000.0), min_size=4, max_size=4),
    bandwidth=st.floats(0.1, 5.0),
    seed=st.integers(0, 100),
)
def test_a_cubic_is_left_as_it_is_however_uneven_its_samples(coefficients: list[float], bandwidth: float, seed: int):
    times = np.cumsum(np.random.default_rng(seed).uniform(0.01, 0.1, 200))
    times -= times[0]
    cubic = np.polynomial.Polynomial(coefficients)
    found = from_samples(times, cubic(times)[:, None], bandwidth=bandwidth, at_rest=False)
    # the equations have a condition of about 1e7; a derivative of degree 7 multiplies by 14 over the knot spacing
    rounding = 1e-8 * np.abs(coefficients).sum() * (1.0 + times[-1]) ** 3
    for k in range(4):
        wrong = found.derivatives(times, 4)[k, :, 0] - cubic.deriv(k)(times)
        assert np.abs(wrong).max() <= rounding * (14.0 / found.unit) ** k


def test_what_it_leaves_its_samples_by_has_no_mean_and_no_trend():
    times = np.cumsum(np.random.default_rng(3).uniform(0.01, 0.1, 100))
    wave = np.cos(9.0 * times)[:, None]
    off = (from_samples(times, wave, bandwidth=1.0, at_rest=False)(times - times[0]).q - wave)[:, 0]
    assert np.abs(off).max() > 0.1
    # cubics cost no snap, so that the integral cannot be made smaller by adding one
    for power in range(4):
        assert abs(trapezoid(off * (times / times[-1]) ** power, times)) < 1e-8


def test_a_slow_motion_keeps_its_derivatives():
    truth = cycloid([1.0, -0.5], TIMES[-1])
    found = from_samples(TIMES, truth(TIMES).q)
    middle = np.linspace(0.5, 3.5, 100)
    wrong = np.abs(found.derivatives(middle) - truth.derivatives(middle)).max(axis=(1, 2))
    assert (wrong < [1e-8, 1e-7, 1e-5, 1e-3, 1e-1]).all()


def test_noise_above_the_bandwidth_fades():
    noise = np.random.default_rng(1).normal(scale=1e-3, size=(TIMES.size, 1))
    found = from_samples(TIMES, noise, bandwidth=2.0)
    assert found(TIMES).q.std() < 0.3 * noise.std()


def test_a_joint_at_rest_under_noise_is_a_motion():
    found = from_samples(TIMES, 0.3 + np.random.default_rng(1).normal(scale=1e-5, size=(TIMES.size, 1)))
    assert np.allclose(found(TIMES).q, 0.3, rtol=0.0, atol=3e-5)


@pytest.mark.filterwarnings("ignore:to start and end at rest")
@pytest.mark.parametrize("count", [4, 5, 9, 801])
def test_it_starts_and_ends_at_rest_up_to_the_snap(count: int):
    times = np.linspace(0.0, 2.0, count)
    found = from_samples(times, np.sin(3.0 * times)[:, None], bandwidth=min(10.0, (count - 1) / 8))
    largest = np.abs(found.derivatives(np.linspace(0.0, 2.0, 500))).max(axis=(1, 2))
    ends = np.abs(found.derivatives([0.0, 2.0])).max(axis=(1, 2))
    assert (ends[1:] <= 1e-10 * largest[1:]).all()


def test_it_keeps_moving_at_its_ends_if_told_so():
    found = from_samples(TIMES, TIMES[:, None], at_rest=False)
    assert np.allclose(found([0.0, 4.0]).v, 1.0, rtol=1e-6)


def test_samples_that_count_from_another_time_give_the_same_motion():
    wave = cycloid([1.0], TIMES[-1])(TIMES).q
    shifted, same = (from_samples(times, wave) for times in (TIMES + 1024.0, TIMES))
    assert shifted.duration == TIMES[-1]
    assert np.allclose(shifted(TIMES).q, same(TIMES).q, rtol=0.0, atol=1e-10)


def test_the_deviation_is_told_and_nothing_is_printed(capsys: pytest.CaptureFixture[str]):
    wave = np.stack([np.sin(TIMES), np.sin(40.0 * TIMES)], axis=1)
    found = from_samples(TIMES, wave, bandwidth=10.0, at_rest=False, joints=["shoulder", "elbow"])
    errors = found(TIMES).q - wave
    assert np.allclose(found.deviation.max, np.abs(errors).max(axis=0), rtol=1e-12)
    assert np.allclose(found.deviation.rms, np.sqrt((errors**2).mean(axis=0)), rtol=1e-12)
    assert capsys.readouterr().out == ""
    assert str(found).startswith("motion of 4 s, smoothed to 10 Hz: deviates from its samples by at most ")
    assert f"{found.deviation.max[1]:.3g} rad (m)" in str(found)
    assert "joint 'elbow'" in str(found)


def ramps(pause: float) -> tuple[np.ndarray, np.ndarray]:
    """1 m in 1 s, faster, at one speed and slower at 4.5 m/s^2, between two pauses; and its times, s."""
    times = np.arange(0.0, 1.0 + 2 * pause + 5e-4, 1e-3)
    t = np.clip(times - pause, 0.0, 1.0)
    third = 1.0 / 3.0
    q = np.select([t < third, t < 2 * third], [2.25 * t**2, 1.5 * t - 0.25], 1.0 - 2.25 * (1.0 - t) ** 2)
    return times, q[:, None]


def test_a_motion_that_sets_out_at_once_hurries_and_says_so():
    def peak(found: Trajectory) -> float:
        return float(np.abs(found(np.linspace(0.0, found.duration, 4001)).a).max())

    told = r"to start and end at rest the .* takes 1.47 times the acceleration at joint 0: begin and end"
    with pytest.warns(match=told):
        at_once = from_samples(*ramps(0.0))
    free = from_samples(*ramps(0.0), at_rest=False)
    assert at_once.hurry == pytest.approx(peak(at_once) / peak(free), rel=0.03)  # it looks at knots
    assert at_once.hurry > 1.3
    rested = from_samples(*ramps(1.0 / at_once.bandwidth))  # the pause that it asks for
    assert peak(rested) < 1.1 * 4.5


@pytest.mark.parametrize(("rate", "chosen"), [(1000.0, 10.0), (20.0, 5.0), (4.0, 1.0)])
def test_the_default_bandwidth_follows_the_sampling_rate(rate: float, chosen: float):
    times = np.arange(50) / rate
    assert from_samples(times, np.zeros((50, 1))).bandwidth == pytest.approx(max(chosen, 0.5 / times[-1]), rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"bandwidth": 1000.0},
            r"bandwidth 1000.0 Hz \(--smoothing\) must lie between .* and 100 Hz, half of the sampling rate",
        ),
        ({"bandwidth": 0.1}, r"bandwidth 0.1 Hz \(--smoothing\) must lie between 0.125 Hz, half a period in 4 s"),
        ({"bandwidth": np.nan}, r"bandwidth nan Hz \(--smoothing\) must lie between"),
        ({"bandwidth": "10"}, r"bandwidth must be one number, Hz, got '10'"),
        ({"joints": 3}, r"joints must be names, such as robot.joints, got 3"),
        ({"joints": ["a", "b"]}, r"2 joint names must match the number of positions, 1"),
        ({"times": TIMES[::-1]}, r"time 3.995 s at index 1 must be later than 4.0 s"),
        ({"q": np.full((801, 1), np.nan), "joints": ["a"]}, r"joint 'a': position nan at index 0 must be finite"),
        ({"times": TIMES * 1e300}, r"time at index 1 is 5.*e\+297: it must be finite and within 1e\+15 s"),
        ({"times": np.r_[TIMES[:-1], 1e12]}, r"no single motion is near all samples; .* between 3.995 and 1e\+12 s"),
        ({"times": TIMES[:3], "q": np.zeros((3, 1))}, r"3 points found: at least 4 are needed"),
        (
            {"times": TIMES[:6] * 20, "q": np.deg2rad([0, 20, 60, 80, 40, 0.0])[:, None], "joints": ["a"]},
            r"smoothed to 2.5 Hz the motion leaves its samples by 0.702 rad \(m\), where joint 'a' moves by 1.4: give",
        ),
    ],
)
def test_what_cannot_be_smoothed_is_refused(arguments: dict, message: str):
    with pytest.raises(InputError, match=message):
        from_samples(**{"times": TIMES, "q": np.zeros((801, 1)), **arguments})


@pytest.mark.parametrize("bandwidth", [None, 5.0, 1.0])
def test_a_pause_in_which_the_motion_would_fly_off_is_refused(bandwidth: float | None):
    times = np.concatenate([TIMES / 4.0, 11.0 + TIMES / 4.0])
    positions = np.where(times < 5.0, 0.25 * (1.0 - np.cos(np.pi * times)), 0.5)[:, None]
    with pytest.raises(InputError, match=r"there are none between 1 and 11 s.*: cut them there, or add some"):
        from_samples(times, positions, bandwidth=bandwidth)


def test_a_joint_that_would_swing_is_named():
    times = np.concatenate([TIMES / 4.0, 11.0 + TIMES / 4.0])
    elbow = np.where(times < 5.0, 0.25 * (1.0 - np.cos(np.pi * times)), 0.5)
    with pytest.raises(InputError, match=r"joint 'elbow': the curve would swing"):
        from_samples(times, np.column_stack([0 * times, elbow]), bandwidth=1.0, joints=["shoulder", "elbow"])


def test_a_gap_among_samples_is_told_where_it_leaves_room_for_waves():
    t = np.arange(600) * 5e-3
    motion = np.sin(t)[:, None]
    for start, end, told in ((1.0, 2.0, True), (1.0, 1.05, False)):
        kept = (t <= start) | (t >= end)
        guess = "there are no samples from 1 to 2 s: the smoothed motion is a guess there"
        with pytest.warns(match=guess) if told else nullcontext():
            found = from_samples(t[kept], motion[kept], at_rest=False)
        assert (found.gap == pytest.approx((start, end))) if told else (found.gap is None)
    assert from_samples(t[::100], motion[::100], at_rest=False).gap is None


def test_masked_samples_are_refused():
    masked = np.ma.masked_greater(np.sin(TIMES)[:, None], 0.9)
    with pytest.raises(InputError, match=r"positions has masked entries, .*: fill them in"):
        from_samples(TIMES, masked)

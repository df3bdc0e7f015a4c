"""Recordings: what they hold, how they are cut, and how they come to a uniform time."""

import re
from collections.abc import Callable

import numpy as np
import pytest
from machine_logs import JOINTS, PERIOD, positions, recording, times

from cutpoint.errors import InputError
from cutpoint.identification import Recording

T = times(400)


def test_parts_of_a_recording_keep_its_samples():
    whole = recording(400)
    part = whole.between(0.1, 0.2)
    assert part.time[0] == 0.1
    assert np.array_equal(part["torque"], whole["torque"][100:201])
    assert np.array_equal(whole.joint("elbow")["q"], whole["q"][:, 1:])
    assert whole.joint("elbow").joints == ("elbow",)
    turned = whole.in_order(["elbow", "shoulder"])
    assert turned.joints == ("elbow", "shoulder") and np.array_equal(turned["q"], whole["q"][:, ::-1])
    with pytest.raises(InputError, match=r"no joint is named 'wrist'; there are: 'shoulder', 'elbow'"):
        whole.joint("wrist")
    with pytest.raises(InputError, match=r"fewer than two samples from 0.5 s to 0.6 s: the recording runs from 0 s"):
        whole.between(0.5, 0.6)


def test_a_channel_that_was_not_recorded_is_an_error_that_lists_the_others():
    with pytest.raises(InputError, match=r"no recorded channel is named 'current'; there are: 'q', 'theta', 'v'"):
        recording(10)["current"]


def test_nobody_writes_to_a_recording():
    with pytest.raises(ValueError, match=r"read-only"):
        recording(10)["q"][0] = 0.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"time": T[::-1], "q": positions(T)}, r"must be \(N,\), N at least 2, finite and increasing"),
        ({"time": T[:1], "q": positions(T[:1])}, r"N at least 2"),
        ({"time": T, "q": positions(T)[:, :1]}, r"channel 'q' has shape \(400, 1\): it must be \(400, 2\)"),
        ({"time": T, "v": np.full((400, 2), np.inf)}, r"channel 'v' holds infinite numbers: mark unknown ones"),
        ({"time": T}, r"a recording needs at least one of q, theta, v"),
        ({"time": T, "joints": ("a", "a"), "q": positions(T)}, r"joints \('a', 'a'\) must be distinct names"),
    ],
)
def test_what_is_no_recording_is_refused(fields: dict[str, object], message: str):
    with pytest.raises(InputError, match=message):
        Recording(**({"joints": JOINTS} | fields))  # type: ignore[arg-type]


@pytest.mark.parametrize("period", [PERIOD, 0.7 * PERIOD, 2.3 * PERIOD])
def test_uneven_samples_come_to_a_uniform_time(period: float):
    uneven = T + 0.3 * PERIOD * np.random.default_rng(3).uniform(-1.0, 1.0, T.size)
    found = Recording(uneven, JOINTS, q=positions(uneven)).resampled(period)
    assert found.period == pytest.approx(period)
    # a cubic spline of step h errs by 5/384 h^4 |q''''| inside, by h^4 |q''''| at the ends; here q'''' < 7e3
    assert np.allclose(found["q"], positions(found.time), rtol=0.0, atol=7e3 * (1.6 * PERIOD) ** 4)


def late(time: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Every twentieth sample right before the next."""
    stamps = time.copy()
    some = np.arange(3, time.size - 1, 20)
    stamps[some] = stamps[some + 1] - 5e-3 * PERIOD
    return stamps


def jittery(time: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return np.unique(time + 0.25 * PERIOD * rng.normal(size=time.size))


@pytest.mark.parametrize("stamps", [late, jittery])
def test_noise_of_uneven_samples_does_not_grow(stamps: Callable[..., np.ndarray]):
    rng = np.random.default_rng(0)
    time = stamps(times(4000), rng)
    noise = 0.01 * rng.normal(size=(time.size, 2))
    found = Recording(time, JOINTS, q=noise).resampled(PERIOD)
    assert np.nanstd(found["q"]) < 1.1 * noise.std()
    assert np.nanmax(np.abs(found["q"])) < 1.6 * np.abs(noise).max()
    assert re.search(
        r"with steps from \S+ to 0.00\d+ s; averaged with the one right before: \d+ samples", found.notes[0]
    )
    smooth = Recording(time, JOINTS, q=positions(time)).resampled(PERIOD)["q"]
    known = np.isfinite(smooth)
    # of two that count as one, a quarter of a period apart at most, the mean errs by 1/8 of that squared times |q''|
    assert np.abs(smooth - positions(time[0] + times(len(smooth))))[known].max() < 60.0 * (0.25 * PERIOD) ** 2


def test_nothing_is_known_in_a_gap_and_all_is_known_beside_it():
    kept = np.r_[0:100, 150:400]
    found = Recording(T[kept], JOINTS, q=positions(T[kept])).resampled(PERIOD)
    in_gap = (found.time > 0.0995) & (found.time < 0.1495)
    assert np.array_equal(~found.complete(), in_gap)
    assert np.allclose(found["q"][~in_gap], positions(found.time[~in_gap]), rtol=0.0, atol=7e3 * PERIOD**4)


@pytest.mark.parametrize(("lost", "unknown"), [((200,), 0), ((200, 201), 2), ((200, 201, 202), 3), ((0,), 1)])
def test_one_lost_sample_is_bridged_and_more_are_not(lost: tuple[int, ...], unknown: int):
    q = positions(T)
    q[list(lost), 0] = np.nan
    found = Recording(T, JOINTS, q=q).resampled(PERIOD)
    assert np.isnan(found["q"]).sum(axis=0).tolist() == [unknown, 0]


def test_a_channel_that_was_sampled_less_often_is_filled_in():
    q = positions(T)
    q[np.arange(T.size) % 4 > 0, 1] = np.nan
    found = Recording(T, JOINTS, q=q).resampled(PERIOD)
    assert np.isnan(found["q"][:, 1]).sum() == 3  # behind the last
    assert np.allclose(found["q"][:397], positions(T[:397]), rtol=0.0, atol=7e3 * (4.0 * PERIOD) ** 4)


def test_uneven_times_have_no_period_and_say_how_to_get_one():
    uneven = Recording(T**1.1, JOINTS, q=positions(T))
    with pytest.raises(InputError, match=r"times are not uniform: steps from .* use recording.resampled\(0.00\d+\)"):
        _ = uneven.period


@pytest.mark.parametrize("period", [0.0, -1.0, np.nan, np.inf, 1.0, 1e-12])
def test_a_period_that_is_none_is_refused(period: float):
    with pytest.raises(InputError, match=r"period .* s must be positive, and at most the 0.399 s"):
        recording(400).resampled(period)

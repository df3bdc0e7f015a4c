"""Frames that a logger repeated while the robot moved on are not taken for a robot that stood still."""

import numpy as np
import pytest
from arm_logs import LAW, TIME, TRUTH, channels

from cutpoint import Drive, Robot
from cutpoint.identification import Recording, identify
from cutpoint.identification.logs.repeats import only_new_rows, without_repeats


def recorded(frames: np.ndarray) -> Recording:
    """The good log, of whose samples these stand at each time."""
    return Recording(TIME, TRUTH.joints, **{name: x[frames] for name, x in channels().items()})


def repeated(where: np.ndarray, run: int) -> np.ndarray:
    frames = np.arange(TIME.size)
    for k in where:
        frames[k : k + run] = k - 1
    return frames


@pytest.mark.parametrize("run", [1, 5])
def test_few_repeats_in_a_row_are_unknown_and_counted(run: int):
    where = np.arange(100, TIME.size - 100, 131)
    found = without_repeats(recorded(repeated(where, run)))
    count = where.size * run
    assert found.notes == (f"{count} samples of 5000 repeat the one before in every channel, and are not used",)
    unknown = np.isnan(found["q"]).any(axis=1)
    assert unknown.sum() == count and unknown[where].all()
    assert np.array_equal(found["torque"][~unknown], channels()["torque"][~unknown])


def test_a_robot_at_rest_and_single_channels_that_repeat_are_left():
    at_rest = recorded(repeated(np.array([1000]), 600))
    assert without_repeats(at_rest) is at_rest
    q = channels()["q"][(np.arange(TIME.size) // 2) * 2]
    coarse = Recording(TIME, TRUTH.joints, q=q, torque=channels()["torque"])
    assert without_repeats(coarse) is coarse


@pytest.mark.parametrize("times", [2, 10])
def test_of_a_log_faster_than_what_it_records_only_new_rows_are_used(times: int):
    new = np.arange(0, TIME.size, times)
    found = only_new_rows(recorded((np.arange(TIME.size) // times) * times))
    told = "repeat the one before in every channel: the log is faster than what it records, and only rows that are new"
    assert found.notes == (f"{TIME.size - new.size} samples of 5000 {told} are used",)
    assert np.array_equal(found.time, TIME[new])
    assert all(np.array_equal(found[name], x[new]) for name, x in channels().items())
    slow = recorded(np.arange(TIME.size))
    assert only_new_rows(slow) is slow


def test_a_log_that_holds_each_sample_is_identified_as_one_without_repetitions():
    robot = Robot(TRUTH.mechanism, {joint: Drive(link_friction=LAW) for joint in TRUTH.joints})
    new = np.arange(0, TIME.size, 2)
    slow = Recording(TIME[new], TRUTH.joints, **{name: x[new] for name, x in channels().items()})
    held = recorded((np.arange(TIME.size) // 2) * 2)
    errors = [identify(robot, log, friction="stated").errors.rms("after", held_out=True) for log in (slow, held)]
    np.testing.assert_allclose(*errors, rtol=1e-6)


def test_a_log_with_repeats_is_filtered_as_the_log_without_them():
    robot = Robot(TRUTH.mechanism, {joint: Drive(link_friction=LAW) for joint in TRUTH.joints})
    rng = np.random.default_rng(1)
    where = np.sort(rng.choice(np.arange(5, TIME.size - 5), 60, replace=False))
    good, bad = (
        identify(robot, recorded(frames), friction="stated") for frames in (np.arange(TIME.size), repeated(where, 1))
    )
    assert bad.rigid.cutoff == pytest.approx(good.rigid.cutoff, rel=0.2)
    assert np.all(bad.errors.rms("after", held_out=True) < 0.015)  # a sample's noise is 0.01

"""Time stamps as loggers write them: whatever was done to them, the motion is the one that was."""

import numpy as np
import pytest
from machine_logs import JOINTS, positions, times

from cutpoint.errors import InputError
from cutpoint.identification import Channel, Recording, Table, parse_mapping, recording_of

T = times(400)
Q = positions(T)


def read(stamps: np.ndarray, q: np.ndarray) -> Recording:
    log = Table("log", {"t": Channel(stamps), "q": Channel(q, JOINTS)})
    return recording_of(log, parse_mapping("version: 1\nq: q"))


def assert_true(found: Recording, least: int) -> None:
    """Every sample is one that was taken, at its time."""
    assert found.time.size >= least
    assert np.allclose(found["q"], positions(found.time), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("start", [0.0, 0.25, -3.0])
def test_time_counts_from_the_first_sample(start: float):
    found = read(T + start, Q)
    assert found.notes == ()
    assert np.allclose(found.time, T, rtol=0.0, atol=1e-12)


def test_shuffled_samples_are_sorted_and_said_to_be():
    shuffled = np.random.default_rng(1).permutation(T.size)
    found = read(T[shuffled], Q[shuffled])
    assert_true(found, T.size)
    assert "time steps go back; samples were sorted by time" in found.notes[0]


def test_samples_written_twice_count_once():
    twice = np.sort(np.concatenate([np.arange(T.size), np.arange(0, T.size, 3)]))
    found = read(T[twice], Q[twice])
    assert_true(found, T.size)
    assert found.notes == ("q: written twice and counted once: 134 samples",)


def test_samples_without_a_time_or_at_that_of_another_are_left_out_if_they_are_few():
    stamps = T.copy()
    stamps[[7, 50]] = np.nan, np.inf
    stamps[200] = stamps[199]
    stamps[300] = stamps[299] + 1e-9
    found = read(stamps, Q)
    assert_true(found, T.size - 4)
    assert found.notes == (
        "q: samples without a time: 2 of 400 were left out",
        "q: samples at the same time as another, or right after it: 2 of 398 were left out",
    )


def test_gaps_are_noted_with_the_longest():
    kept = np.r_[0:100, 101:200, 230:400]
    found = read(T[kept], Q[kept])
    assert_true(found, kept.size)
    assert found.notes == ("q: 1 gap above 0.0025 s; the longest, 0.031 s, is at 0.199 s",)


def test_a_clock_that_leaps_ahead_leaves_ten_seconds_of_which_nothing_is_known():
    leapt = read(T + np.where(np.arange(T.size) < 250, 0.0, 3600.0), Q)
    assert np.allclose(leapt.time, T + np.where(np.arange(T.size) < 250, 0.0, 10.0 - 1e-3), rtol=0.0, atol=1e-9)
    assert np.array_equal(leapt["q"], Q)
    assert leapt.notes[1] == (
        "time: 1 gap above 10 s, the first of 3600 s at 0.249 s; each was cut to 10 s, and later samples were moved "
        "earlier"
    )
    assert np.isfinite(leapt.resampled(1e-3)["q"]).sum() == Q.size


@pytest.mark.parametrize("gap", [9.9, 1.0])
def test_a_shorter_gap_stays_as_long_as_it_was(gap: float):
    found = read(T + np.where(np.arange(T.size) < 250, 0.0, gap), Q)
    assert found.time[-1] == pytest.approx(T[-1] + gap)
    assert len(found.notes) == 1


def test_channels_of_their_own_times_stay_together_across_a_long_gap():
    stamps = T + np.where(np.arange(T.size) < 250, 0.0, 3600.0)
    own = stamps[::2] + 0.25e-3
    log = Table("log", {"q": Channel(Q, JOINTS, stamps=stamps), "v": Channel(positions(own), JOINTS, stamps=own)})
    found = recording_of(log, parse_mapping("version: 1\nq: q\nv: v"))
    both = found.complete()
    # positions(t) stand for both; a spline of step h errs by h^4 |q| at most, and q < 7e3
    motion = positions(stamps)
    assert both.sum() > 390
    assert np.allclose(found["v"][both], motion[both], rtol=0.0, atol=7e3 * 2e-3**4)


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_a_period_that_is_another_units_is_refused(factor: float, unit: str):
    told = rf"too long for a log of a moving machine: are the times in {unit}\?  If so, state .*unit: {unit}}}"
    with pytest.raises(InputError, match=told):
        read(factor * T, Q)


@pytest.mark.parametrize(
    ("stamps", "message"),
    [
        (
            np.concatenate([T[:250], T[:150]]),
            r"q: time goes back by 0.249 s at sample 250: a clock was set back, "
            r".*; split the log there, and give the parts as several logs",
        ),
        (np.floor(T / 4e-3) * 4e-3, r"q: samples at the same time as another, .*: 300 of 400, more than 5%"),
        (np.where(np.arange(400) % 4, T, np.nan), r"q: samples without a time: 100 of 400, more than 5%: take another"),
        (np.zeros(400), r"q: time does not advance: every stamp is 0 s"),
        (np.full(400, np.nan), r"q: samples without a time: 400 of 400"),
    ],
)
def test_stamps_that_nothing_can_be_made_of_are_refused(stamps: np.ndarray, message: str):
    with pytest.raises(InputError, match=message):
        read(stamps, Q)


def test_stamps_closer_than_any_log_has_them_are_noted():
    (note,) = read(1e-3 * T, Q).notes
    assert note.startswith("q: a period of 1e-06 s is too short for a log") and "are the times in a longer unit" in note


@pytest.mark.parametrize("count", [2, 3])
def test_too_few_samples_are_refused(count: int):
    with pytest.raises(InputError, match=rf"q: only {count} samples: at least 4 are needed"):
        read(T[:count], Q[:count])

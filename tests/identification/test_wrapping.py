"""Sensors that start anew: the motion comes out whole, and nothing else is touched."""

import math
import re

import numpy as np
import pytest
from machine_logs import positions, times

from cutpoint import Robot
from cutpoint.identification import Channel, Recording, Table, parse_mapping, recording_of
from cutpoint.model import Joint, Link
from cutpoint.model.build import build

T = times(6000)
TURN = 2.0 * math.pi
MOTION = 3.0 + 2.0 * positions(T)[:, :1]
"""rad: a joint that passes half a turn several times."""


def read(values: np.ndarray, fields: str = "unit: rad", name: str = "q", robot: Robot | None = None) -> Recording:
    log = Table("log", {"t": Channel(T), "x": Channel(values)})
    return recording_of(log, parse_mapping(f"version: 1\nratio: -50\n{name}: {{channels: x, {fields}}}"), robot)


def wrapped(x: np.ndarray, span: float) -> np.ndarray:
    """Within half a span on both sides of zero."""
    return (x + 0.5 * span) % span - 0.5 * span


def assert_whole(found: Recording, motion: np.ndarray, atol: float, name: str = "q") -> None:
    """The motion itself, but for a whole number of turns, wherever it is known."""
    off = found[name] - motion
    assert np.nanmax(off) - np.nanmin(off) <= atol
    assert sum("were unwrapped" in note for note in found.notes) == 1


@pytest.mark.parametrize(("fields", "turn"), [("unit: rad", TURN), ("unit: deg", 360.0), ("unit: rev", 1.0)])
def test_an_angle_of_one_turn_is_put_together(fields: str, turn: float):
    found = read(wrapped(MOTION * turn / TURN, turn), fields)
    assert_whole(found, MOTION, 1e-12)
    jumps = (np.abs(np.diff(wrapped(MOTION, TURN)[:, 0])) > math.pi).sum()
    assert found.notes[0] == f"q of 'joint_0': {jumps} jumps by a turn, 6.283 rad at the joint, were unwrapped"


@pytest.mark.parametrize("start", [0, 700, 1500])
@pytest.mark.parametrize("turns", [-3.0, 0.0, 0.5, 2.0])
def test_wherever_a_log_begins_a_joint_is_on_the_turn_that_is_nearest_to_zero(start: int, turns: float):
    motion = MOTION + turns * TURN
    values = wrapped(motion, TURN)
    values[:start] = np.nan
    found = read(values)["q"][start:, 0]
    assert abs(0.5 * (found.min() + found.max())) <= math.pi
    off = (found - motion[start:, 0]) / TURN
    assert np.allclose(off, round(off[0]), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("bits", "ratio", "side"), [(8, 1.0, "link"), (16, 60.0, "link"), (12, -50.0, "motor"), (16, -50.0, "motor")]
)
def test_a_counter_that_starts_anew_is_put_together(bits: int, ratio: float, side: str):
    gear = ratio if side == "motor" else 1.0
    counts = np.round(MOTION * ratio / TURN * 4096)
    found = read(counts % 2**bits, f"unit: counts, counts_per_turn: {4096 * ratio / gear}, side: {side}", "theta")
    assert_whole(found, MOTION, TURN / 4096, "theta")
    assert re.search(r"were unwrapped; .* if it had jumped before, state 'offset'", found.notes[0])


def test_a_motor_that_turns_nearly_half_a_turn_each_sample_is_put_together():
    turns = 0.45e3 * T[:, None] + 4.0 * np.sin(3.0 * T[:, None])
    found = read(wrapped(turns, 1.0), "unit: rev, side: motor", "theta")
    # of 2700 turns each is kept to 1e-16 of itself
    assert_whole(found, turns * TURN / -50.0, 1e-11, "theta")


@pytest.mark.parametrize("noise", [1e-5, 1e-3])
def test_a_joint_that_rests_where_its_sensor_starts_anew_is_put_together(noise: float):
    rest = math.pi + noise * np.random.default_rng(4).standard_normal((T.size, 1))
    assert_whole(read(wrapped(rest, TURN)), rest, 1e-12)


def test_missing_samples_at_a_jump_and_elsewhere_do_not_matter():
    values = wrapped(MOTION, TURN)
    jumps = np.flatnonzero(np.abs(np.diff(values[:, 0])) > math.pi)
    values[np.add.outer(jumps[::2], np.arange(-2, 4)).ravel()] = np.nan
    values[np.random.default_rng(5).random(T.size) < 0.02] = np.nan
    assert_whole(read(values), MOTION, 1e-12)


@pytest.mark.parametrize("jump", [6.0, 6.2, 3.0, 5.5, 12.0])
def test_jumps_that_are_no_turn_stay(jump: float):
    leapt = positions(T)[:, :1] + np.where(T[:, None] < 3.0, 0.0, jump)
    assert np.array_equal(read(leapt)["q"], leapt)
    spike = positions(T)[:, :1] + np.where(np.arange(T.size)[:, None] == 3000, jump, 0.0)
    assert np.array_equal(read(spike)["q"], spike)


def test_counts_that_leap_by_less_than_a_counter_holds_stay():
    counts = np.round(1e4 * positions(T)[:, :1])
    counts[3000:] += 256
    assert np.array_equal(read(counts, f"unit: counts, gain: {TURN / 2**20}")["q"], counts * (TURN / 2**20))


def test_whether_a_joint_turned_on_in_a_long_gap_is_not_guessed():
    values = 0.01 * MOTION
    values[3000:] += TURN
    values[2900:3000] = np.nan
    assert np.array_equal(read(values)["q"], values, equal_nan=True)


@pytest.mark.parametrize("speed", [0.6, 0.9, 1.0, 3.0])
def test_a_motor_that_turns_far_each_sample_and_is_counted_on_stays(speed: float):
    turns = speed * 1e3 * T[:, None] + 4.0 * np.sin(3.0 * T[:, None])
    found = read(turns, "unit: rev, side: motor", "theta")
    assert np.allclose(found["theta"], turns * TURN / -50.0, rtol=1e-15, atol=0.0)


@pytest.mark.parametrize("kind", ["noise", "zeros", "walk"])
def test_what_is_no_sensor_of_turns_stays(kind: str):
    rng = np.random.default_rng(6)
    values = {
        "noise": rng.uniform(-math.pi, math.pi, (T.size, 1)),
        "zeros": np.zeros((T.size, 1)),
        "walk": rng.standard_normal((T.size, 1)).cumsum(axis=0),
    }[kind]
    assert np.array_equal(read(values)["q"], values)


ALONG = Joint("slide", "prismatic", "base", "carriage", axis=np.array([1.0, 0.0, 0.0]))
SLIDE = Robot(build("slide", [Link("base"), Link("carriage", 1.0, np.zeros(3), np.eye(3))], [ALONG]))


def test_a_turn_of_the_motor_of_a_joint_that_slides_is_a_length():
    found = read(wrapped(50.0 * MOTION, TURN), "unit: rad, side: motor", "theta", SLIDE)
    assert_whole(found, -MOTION, 1e-12, "theta")
    assert re.search(r"'slide': \d+ jumps by a turn, 0\.1257 m at the joint, were unwrapped", found.notes[0])


def test_links_that_slide_have_no_turns():
    metres = wrapped(MOTION, TURN)
    assert np.array_equal(read(metres, "unit: m")["q"], metres)
    assert np.array_equal(read(metres, robot=SLIDE)["q"], metres)
    assert np.allclose(read(metres, "unit: mm", robot=SLIDE)["q"], 1e-3 * metres, rtol=1e-15, atol=0.0)
    assert_whole(read(metres), MOTION, 1e-12)

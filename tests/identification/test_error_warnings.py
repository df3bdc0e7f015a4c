"""Warnings on torque errors in the held-out part of a log."""

import re

import numpy as np
import pytest
from two_joints import two_joints

from cutpoint import Drive, Motor
from cutpoint.identification.output.error_warnings import unit_notes, warnings_of
from cutpoint.identification.output.pictures import torque_picture
from cutpoint.identification.output.torque_errors import TorqueErrors

TIME = 0.01 * np.arange(4000)
HELD = TIME >= 28.0
NOISE = np.random.default_rng(0).normal(size=(3, TIME.size))
TORQUE = 20.0 * np.cos(1.3 * TIME)
MOVES = np.sin(2.0 * TIME)
RESTS = HELD & (np.abs(np.modf(TIME / 4.0)[0] - 0.5) < 0.05)
STUCK = np.where(RESTS, 2.0, 0.1)


def said(after: object = 0.1, plain: object = 0.1, before: object = 1.0, speed: object = MOVES) -> list[str]:
    """Of a joint whose models err by noise times these."""
    models = [(TORQUE - noise * size)[:, None] for noise, size in zip(NOISE, (before, after, plain), strict=True)]
    v = np.broadcast_to(np.asarray(speed), TIME.shape)[:, None]
    return warnings_of(TorqueErrors(TIME, TORQUE[:, None], *models, 0.0 * v, v, 0.0 * v, HELD, 10.0), {"elbow": "N m"})


def test_torque_is_drawn_where_the_models_are() -> None:
    """Not at the ends of the log, where filters leave the motion unknown; a gap stays one."""
    model = np.where((TIME > 1.0) & (TIME < 39.0) & (np.abs(TIME - 20.0) > 1.0), TORQUE, np.nan)
    model, torque = (np.repeat(x[:, None], 2, axis=1) for x in (model, TORQUE))
    still = np.zeros_like(model)
    errors = TorqueErrors(TIME, torque, *[model] * 3, still, still, still, HELD, 10.0)
    panel = torque_picture(errors, two_joints()).axes[0]
    measured, *models = (line.get_xydata() for line in panel.get_lines())
    for drawn in models:
        known = np.isfinite(drawn[:, 1])
        assert drawn[known][0, 0] == measured[0, 0] and drawn[known][-1, 0] == measured[-1, 0]
    assert np.isfinite(measured).all() and np.ptp(panel.get_xlim()) == pytest.approx(38.0, abs=0.1)


def test_a_model_that_carries_over_is_not_spoken_of():
    assert said() == []
    assert said(plain=0.05) == []
    assert said(before=0.0999) == []
    assert said(after=np.where(np.abs(TIME - 12.5) < 0.3, 0.5, 0.05), plain=1.0) == []  # 1 % of the torque
    assert said(after=STUCK / 20.0, plain=STUCK / 20.0, speed=np.where(RESTS, 0.0, 1.0)) == []  # 0.7 % of the torque


def test_errors_at_rest_where_dry_friction_is_unknown_are_no_contact():
    brief = np.abs(TIME - 12.5) < 0.3
    notes = [said(after=np.where(brief, 5.0, 0.1), speed=speed) for speed in (1.0, np.where(brief, 0.01, 1.0))]
    assert [any(note.startswith("half of") for note in each) for each in notes] == [True, False]


def test_errors_while_a_joint_moves_are_no_contact_where_it_stands_still_on_the_part_held_out():
    events = np.where(np.abs(TIME - 12.5) < 0.3, 5.0, 0.1)
    assert not any(note.startswith("half of") for note in said(after=events, speed=np.where(HELD, 0.0, MOVES)))


def test_nothing_is_said_of_the_torque_that_holds_a_joint_still():
    assert said(after=10.0, plain=10.0, before=5.0, speed=0.0) == []


@pytest.mark.parametrize(
    ("errors", "words"),
    [
        (
            {"speed": np.where(HELD, 0.01, 1.0) * MOVES},
            r"errors on the part held out prove nothing of joints that hardly move there: elbow",
        ),
        ({"after": np.where(HELD, 0.3, 0.1), "plain": 0.3}, r"elbow: .* is 3\.\d times that on the fitted part"),
        (
            {"after": np.where(HELD, 3.0 / NOISE[1], 0.1), "plain": 5.0},
            r"elbow: .* is \d+\.\d times that on the fitted part: its torque there is 3\.?\d* N m more in the "
            r"mean, by a payload, .*; intervals are for one machine that stays as it is",
        ),
        ({"after": 2.0}, r"elbow: .* held out is 1\d\.\d\d to 2\d\.\d\d times that of plain least squares: check"),
        (
            {"after": 10.0, "plain": 10.0},
            r"elbow: the model misses its torque by 9\.\d+ N m RMS, out of 14\.\d: check",
        ),
        (
            {"after": 10.0, "plain": 10.0, "before": 2.0 * TORQUE / NOISE[0] + 0.5},
            r"elbow: the model misses its torque by 9\..*: it opposes what the files predict: is the sign of",
        ),
        (
            {"after": (0.1 * TIME - 1.4) * np.sign(MOVES) / NOISE[1], "plain": 0.1},
            r"elbow: friction takes 2\.\d+ N m more at the end of the log than at its beginning, as if warming up",
        ),
        ({"before": 0.05}, r"elbow: the identified model explains its torque worse than the files did"),
        (
            {
                "after": np.where(RESTS, 2.0, 0.1),
                "plain": np.where(RESTS, 2.0, 0.1),
                "speed": np.where(RESTS, 0.0, 1.0),
            },
            r"most of the squared torque error .* occurs at rest, .*: elbow 9\d% in \d+% of the time",
        ),
        (
            {"after": np.where(np.abs(TIME - 12.5) < 0.3, 5.0, 0.1)},
            r"half of .* occurs in a short time, as by a contact, .*: elbow within 0\.[23]\d* s from 12\.[2-6]\d* s on",
        ),
    ],
)
def test_each_thing_that_is_wrong_is_said_with_its_joint(errors: dict[str, object], words: str):
    assert any(re.match(words, note) for note in said(**errors)), said(**errors)


@pytest.mark.parametrize(
    ("scale", "said"),
    [
        ([1.3, 1.0, 0.7], None),
        ([1e3, 1e3, 1e3], "pan 1e+03 times, lift 1e+03 times, roll 1e+03 times"),
        ([1.0, 0.01, 1.0], "lift 0.01 times"),
        ([1e3, 1e3, np.nan], "pan 1e+03 times, lift 1e+03 times"),
        ([1.0, 1.0, np.nan], None),
    ],
)
def test_torques_in_another_unit_are_named_with_the_factor(scale: list[float], said: str | None):
    files = np.column_stack([TORQUE, 5.0 * np.sin(0.7 * TIME), 3.0 * np.sin(2.9 * TIME)])
    found = of_size(files, scale, dict.fromkeys(("pan", "lift", "roll"), Drive()))
    words = "torques are far from what the robot's files predict for this motion, "
    assert found == ([] if said is None else [f"{words}{said}: {found[0].partition(': ')[2]}"])


def of_size(files: np.ndarray, scale: list[float], drives: dict[str, Drive], **kind: bool) -> list[str]:
    measured, v = files * scale, np.tile(MOVES[:, None], 3)
    errors = TorqueErrors(TIME, measured, files, measured, measured, 0.0 * v, v, 0.0 * v, HELD, 10.0)
    return unit_notes(errors, drives, **kind)


@pytest.mark.parametrize(
    ("scale", "currents", "said"),
    [
        ([0.11, 0.13, 0.3], False, "pan, lift, roll would fit in amperes, .*: map them as 'current: {channels: "),
        ([1.2, 0.09, 1.1], False, "they would fit in amperes, by .* map them .*, with a list that states it"),
        ([0.013, 0.014, 0.02], False, "they would fit in N m at the motor's shaft: map them as 'torque: {.* side: m"),
        ([1.2e3, 1.4e3, 900.0], False, "they would fit in mN m: map them as 'torque: {channels: ..., unit: mN m}'"),
        ([0.013, 0.014, 0.02], True, "they would fit if the torque constants .* motor's shaft: multiply them by"),
        ([40.0, 40.0, 40.0], False, "check their unit, such as amperes, and whether they are at the motor's shaft"),
        ([4.0, 0.3, 1.3], False, None),
    ],
)
def test_units_that_explain_the_size_of_torques_are_named(scale: list[float], currents: bool, said: str | None):
    files = np.column_stack([TORQUE, 5.0 * np.sin(0.7 * TIME), 3.0 * np.sin(2.9 * TIME)])
    drives = {
        joint: Drive(ratio, motor=Motor(0.1)) for joint, ratio in {"pan": 100.0, "lift": -90.0, "roll": 50}.items()
    }
    found = of_size(files, scale, drives, from_currents=currents)
    assert len(found) == (said is not None) and all(re.search(f" times: {said}", note) for note in found), found

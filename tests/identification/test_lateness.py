"""Torques that are late against the motion are named, and friction that looks like that is not."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from judged_arms import recorded, with_springs
from simulated_logs import Known, known_arm
from simulated_logs import recorded as rigidly_recorded

from cutpoint import Coulomb
from cutpoint.identification import Recording, identify, identify_rigid

FRICTION = Coulomb(coulomb=10.0, viscous=1.0, smoothing=0.02)


@cache
def arm(on_motors: bool) -> tuple[Known, Recording]:
    """An arm of two joints that bend, with dry friction on both sides or on the links' alone."""
    known = with_springs(known_arm(4, 2), 4)
    if on_motors:
        drives = {joint: replace(x, motor_friction=FRICTION) for joint, x in known.robot.drives.items()}
        known = Known(known.robot.with_drives(drives), known.file)
    return known, recorded(known.robot, 4)


def told(known: Known, recording: Recording, cutoff: float | None = None) -> list[str]:
    doubts = identify_rigid(known.file, recording, cutoff=cutoff).doubts
    return [doubt for doubt in doubts if "than the motion they belong to" in doubt]


@pytest.mark.parametrize(("samples", "when"), [(4, "later"), (-4, "earlier")])
def test_torques_of_another_time_than_the_motion_are_named(samples: int, when: str):
    known, log = arm(on_motors=False)
    assert told(known, log) == []
    (note,) = told(known, replace(log, torque=np.roll(log["torque"], samples, axis=0)))
    words = re.match(r"torques come ([\d.]+) \+- 1 ms (later|earlier) than the motion", note)
    assert words is not None
    assert words[2] == when
    # a command that is held acts half a period later than it is stamped
    assert float(words[1]) == pytest.approx(abs(samples - 0.5), abs=0.5)
    assert "without an encoder" not in note


def test_a_log_too_short_to_judge_delays_is_said_to_be():
    known, log = arm(on_motors=False)
    notes = [
        [note for note in identify_rigid(known.file, each).notes if "not judged" in note]
        for each in (log, log.between(0.0, 0.1 * log.time[-1]))
    ]
    assert notes[0] == [] and len(notes[1]) == 1
    words = re.search(r"of (\d+) means only (\d+) are away from .*: a log ([\d.]+) times as long would do", notes[1][0])
    assert words is not None and int(words[2]) < int(words[1]) and 1.0 < float(words[3]) < 5.0


@pytest.mark.parametrize("unseen", ["none", "theta", "q"])
def test_friction_of_motors_that_reverse_before_their_links_is_no_lateness(unseen: str):
    known, log = arm(on_motors=True)
    assert told(known, log if unseen == "none" else replace(log, **{unseen: None})) == []


def test_where_one_side_was_measured_friction_of_the_other_is_named_as_what_else_it_may_be():
    known, log = arm(on_motors=True)
    notes = told(known, replace(log, theta=None, torque=np.roll(log["torque"], -4, axis=0)))
    assert "earlier than the motion" in notes[0]
    assert notes[-1].endswith("dry friction on the drives' side without an encoder looks the same")


@pytest.mark.parametrize(("seed", "joints", "cutoff"), [(3, 2, 8.0), (5, 3, 12.0)])
def test_dry_friction_that_a_low_cutoff_spreads_over_time_is_no_lateness_and_hides_none(
    seed: int, joints: int, cutoff: float
):
    known = known_arm(seed, joints)
    law = Coulomb(coulomb=4.0, viscous=0.5, smoothing=0.005)
    drives = {joint: replace(drive, link_friction=law) for joint, drive in known.robot.drives.items()}
    log = rigidly_recorded(known.robot.with_drives(drives), seed)
    assert told(known, log, cutoff) == []
    (note,) = told(known, replace(log, torque=np.roll(log["torque"], -4, axis=0)), cutoff)
    words = re.match(r"torques come ([\d.]+) \+- [\d.]+ ms earlier than the motion", note)
    assert words is not None
    assert float(words[1]) == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize(
    ("samples", "words"),
    [
        (3, r"springs show that torques act [\d.]+ ms earlier than stamped, not 0.5 ms later \(joint0 -.*"),
        (0, r"all springs seem damped by ([\d.]+) ms of their stiffness, or torques act [\d.]+ ms later than .*"),
    ],
)
def test_springs_tell_when_torques_act(samples: int, words: str):
    """Their damping is 1 ms of their stiffness, which looks like torques that act as much later."""
    known, log = arm(on_motors=False)
    found = identify(known.file, replace(log, torque=np.roll(log["torque"], samples, axis=0)), torque_delay=5e-4)
    assert found.drives is not None
    delays = [each.delay for each in found.drives.joints.values() if each.delay]
    assert len(delays) == 2
    for delay in delays:
        assert abs(delay.value - (1.5e-3 - samples * 1e-3)) < 2.0 * delay.deviation
    assert min(delay.deviation for delay in delays) < 1.5e-4
    assert len([doubt for doubt in found.doubts if re.match(words, doubt)]) == 1

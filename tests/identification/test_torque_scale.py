"""Torques of one joint on another scale than the others' are named, and other disturbances are not taken for it."""

import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from judged_arms import recorded as elastically_recorded
from judged_arms import with_springs
from simulated_logs import Known, known_arm, recorded

from cutpoint import Coulomb
from cutpoint.identification import Recording, identify, identify_rigid


@cache
def arm(seed: int, joints: int) -> tuple[Known, Recording]:
    known = known_arm(seed, joints)
    return known, recorded(known.robot, seed)


def named(known: Known, recording: Recording, **how: Any) -> dict[str, float]:
    """Joints and factors in the doubt about the scale of torques."""
    doubts = [x for x in identify_rigid(known.file, recording, **how).doubts if "of the others suggest" in x]
    assert len(doubts) <= 1
    return {joint: float(x) for joint, x in re.findall(r"of (\S+) (?:are )?about (\S+) times", "".join(doubts))}


@pytest.mark.parametrize(("joint", "factor"), [(0, 0.5), (0, 1.2), (1, 0.85), (2, 1.2), (3, 0.85), (3, 2.0)])
def test_a_joint_whose_torque_constant_is_wrong_is_named_with_the_factor(joint: int, factor: float):
    known, log = arm(3, 4)
    scale = np.ones(4)
    scale[joint] = factor
    found = named(known, replace(log, torque=log["torque"] * scale))
    assert found[known.robot.joints[joint]] == pytest.approx(factor, rel=0.03)


def test_of_two_joints_that_bear_the_same_bodies_either_may_be_wrong():
    known, log = arm(5, 3)
    found = named(known, replace(log, torque=log["torque"] * [1.0, 2.0, 1.0]))
    assert found == pytest.approx({"joint1": 2.0, "joint2": 0.5}, rel=0.03)


@pytest.mark.parametrize(("seed", "joints"), [(1, 2), (3, 4), (5, 3), (6, 1)])
def test_torques_of_one_scale_are_not_doubted_whatever_it_is(seed: int, joints: int):
    known, log = arm(seed, joints)
    for factor in (1.0, 1.2):
        assert named(known, replace(log, torque=log["torque"] * factor)) == {}


@pytest.mark.parametrize("samples", [-8, 4, 8])
def test_torques_of_another_time_are_not_taken_for_another_scale(samples: int):
    known, log = arm(5, 3)
    assert named(known, replace(log, torque=np.roll(log["torque"], samples, axis=0))) == {}


@pytest.mark.parametrize("unseen", ["none", "theta", "q"])
def test_springs_and_friction_of_drives_are_not_taken_for_another_scale(unseen: str):
    known = with_springs(known_arm(4, 2), 4)
    law = Coulomb(coulomb=10.0, viscous=1.0, smoothing=0.02)
    drives = {joint: replace(drive, motor_friction=law) for joint, drive in known.robot.drives.items()}
    known = Known(known.robot.with_drives(drives), known.file)
    log = elastically_recorded(known.robot, 4)
    assert named(known, log if unseen == "none" else replace(log, **{unseen: None})) == {}


@pytest.mark.parametrize("unseen", ["theta", "q"])
def test_where_springs_bend_unseen_a_joint_is_named_without_a_factor(unseen: str):
    known = with_springs(known_arm(4, 3), 4)
    log = replace(elastically_recorded(known.robot, 4), **{unseen: None})
    doubts = identify_rigid(known.file, replace(log, torque=log["torque"] * [1.0, 0.5, 1.0])).doubts
    told = rf"torques of {known.robot.joints[1]} are less than those of the others suggest[:,]"
    assert any(re.match(told, doubt) for doubt in doubts), doubts


def test_a_factor_that_contradicts_the_joints_excess_is_not_told():
    known, log = arm(2, 6)
    load = log["torque"].std(axis=0) * np.sin(2.0 * log["q"] + 1.0)  # of no body
    assert named(known, replace(log, torque=log["torque"] + 0.5 * load), friction="stated") == {}


def test_a_base_that_is_mounted_at_an_angle_is_doubted():
    known, log = arm(5, 3)
    tilted = known.file.with_gravity([0.5, 0.3, -9.79])
    doubts = identify_rigid(tilted, log).doubts
    assert any("how the base is mounted" in doubt for doubt in doubts), doubts


def test_channels_that_contradict_each_other_are_told_once():
    known, log = arm(5, 3)
    both = replace(log, theta=log["q"] * [1.0, 1.0, -1.0])
    found = identify(known.file, both)
    words = [x for x in (*found.doubts, *found.notes) if "theta of" in x and "times q" in x]
    assert len(words) == 1


def test_friction_that_looks_one_sided_is_still_a_law():
    known, log = arm(2, 6)
    found = identify_rigid(known.file, replace(log, torque=log["torque"] * [0.1, 1.0, 1.0, 1.0, 1.0, 1.0]))
    assert found.doubts

"""The paper's arm, whose joints shake as they turn back, from its own files with wrong numbers: what is not fitted."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drive_benches import PERIOD, measured, supposed_arm
from simulated_logs import known_arm
from simulated_logs import recorded as simulated

import cutpoint
from cutpoint.identification import Recording, low_pass
from cutpoint.identification.conditioning.motion import motion_of
from cutpoint.identification.output import Identification, identify
from cutpoint.identification.output.torque_errors import TorqueErrors, stated_torque
from cutpoint.identification.rigid.bodies import with_parameters
from robot_library import shoulder

NOISE = 0.05
"""N m, white, of each torque sample: 0.5 % of the second joint's, 16 % of the sixth's."""


WHOLE, FIRST = cutpoint.robots.xia2019(), shoulder()


def recorded(arm: cutpoint.Robot, seed: int) -> Recording:
    found = measured(arm, 12.0, seed)
    torque = np.asarray(found["torque"])
    return replace(found, torque=torque + NOISE * np.random.default_rng(seed).normal(size=torque.shape))


def wrong_files(arm: cutpoint.Robot) -> cutpoint.Robot:
    """Links heavier by 30 %, friction larger by half, springs and rotors of other sizes."""
    supposed = supposed_arm(arm)
    drives = {}
    for joint, drive in supposed.drives.items():
        law: Any = drive.link_friction
        larger = law.with_coefficients([1.5 * getattr(law, name) for name in law.coefficients])
        drives[joint] = replace(drive, link_friction=larger)
    return cutpoint.Robot(with_parameters(supposed.mechanism, 1.3 * supposed.inertial_parameters), drives)


def true_error(found: Identification) -> np.ndarray:
    """(n,), RMS of what the first joints' own numbers leave of the torques held out, through the same filters."""
    true, errors = FIRST, found.errors
    motion = motion_of(true, found.recording, found.rigid.cutoff)
    left = errors.measured - low_pass(stated_torque(true, motion), motion.period, errors.bandwidth)
    return np.sqrt(np.nanmean(left[errors.held_out] ** 2, axis=0))


@pytest.mark.parametrize(("friction", "motion"), [("stated", 12), ("choose", 1)])
def test_torques_held_out_are_missed_by_twice_as_much_as_the_true_arm_misses_at_most(friction: Any, motion: int):
    found = identify(wrong_files(FIRST), recorded(FIRST, motion), friction=friction, torque_delay=0.5 * PERIOD)
    assert (found.errors.rms("after", held_out=True) < 2.0 * true_error(found)).all()


def test_shapes_of_friction_are_found_although_joints_shake():
    found = identify(wrong_files(WHOLE), recorded(WHOLE, 3), springs=False, torque_delay=0.5 * PERIOD)
    for choice, drive in zip(found.rigid.friction[:3], WHOLE.drives.values(), strict=False):
        law, true = choice.law, drive.link_friction
        assert isinstance(law, cutpoint.Stribeck)
        assert isinstance(true, cutpoint.Stribeck)
        assert law.stribeck_velocity == pytest.approx(true.stribeck_velocity, rel=0.03)
        assert law.smoothing == pytest.approx(true.smoothing, rel=0.1)


def test_torques_are_as_large_as_on_the_part_that_was_fitted():
    torque, held = np.array([[1.0], [3.0], [50.0], [50.0]]), np.array([False, False, True, True])
    errors = TorqueErrors(np.arange(4.0), *[torque] * 7, held_out=held, bandwidth=1.0)
    assert errors.size() == pytest.approx([1.0])


def test_torques_held_out_are_filtered_as_in_the_fit():
    # of noisy positions a part and the whole suggest other cut-offs
    arm = known_arm(0, 2)
    log = simulated(arm.robot, 0)
    shaken = log["q"] + 1e-3 * np.random.default_rng(0).normal(size=log["q"].shape)
    found = identify(arm.file, replace(log, q=shaken), friction="stated")
    assert any(f"torques explained up to {found.errors.bandwidth:.4g} Hz" in note for note in found.notes)

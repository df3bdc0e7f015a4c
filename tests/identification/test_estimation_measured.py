"""Real machines: a slide whose authors published its parameters, and an arm that predicts the rest of its own log."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import yaml
from measured import EMPS, UR10, UR10_MAPPING, emps_mapping

from cutpoint import Coulomb, Robot
from cutpoint.identification import Recording, low_pass, read_recording
from cutpoint.identification.output import Identification, identify
from cutpoint.identification.rigid.identify_rigid import identify_rigid
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import load

SIGN = Coulomb(1.0, 0.0, smoothing=1e-4)
"""As good as sgn(v), which the authors take."""

PAN, LIFT, WRIST_2 = "shoulder_pan_joint", "shoulder_lift_joint", "wrist_2_joint"


def slide() -> Robot:
    along = Joint("slide", "prismatic", "base", "carriage", axis=np.array([1.0, 0.0, 0.0]))
    return Robot(build("emps", [Link("base"), Link("carriage", 90.0, np.zeros(3), np.eye(3))], [along]))


def test_the_slide_has_the_mass_and_the_friction_that_its_authors_published():
    # by least squares, as the authors did
    log = read_recording(EMPS, emps_mapping())
    found = identify_rigid(slide(), log, friction={"slide": SIGN}, method="weighted")
    # Janot, Gautier, Brunot (2019): kg, N s/m, N, N
    assert found.parameters[0].value == pytest.approx(95.1089, rel=0.01)
    assert found["viscous.slide"].value == pytest.approx(203.5034, rel=0.01)
    assert found["coulomb.slide"].value == pytest.approx(20.39, rel=0.02)
    assert found["offset.slide"].value == pytest.approx(-3.16, rel=0.02)


@cache
def recording() -> Recording:
    """Of the arm; what is called currents has the size of its torques."""
    mapping = yaml.safe_load(UR10_MAPPING)
    return read_recording(UR10, mapping).resampled(8e-3)


def identified(friction: Any = "choose") -> Identification:
    robot = load("ur10_robot.urdf")
    return identify(robot, recording(), friction=friction, torque_constants=dict.fromkeys(robot.joints, 1.0))


@cache
def arm() -> Identification:
    return identified()


def laws(other: Mapping[str, Any]) -> dict[str, Any]:
    """Friction as it was chosen, but in some joints."""
    return {choice.joint: choice.law for choice in arm().rigid.friction} | dict(other)


def plain_laws() -> dict[str, Any]:
    """Coulomb friction that changes its sign at once, as plain least squares have it."""
    return {joint: Coulomb(1.0, 0.0, 0.02 * speed) for joint, speed in zip(joints(), arm().errors.speed(), strict=True)}


def joints() -> tuple[str, ...]:
    return arm().robot.joints


def better(ratios: Any) -> set[str]:
    """Joints whose torques the first model surely tells better."""
    return {joint for joint, ratio in zip(joints(), ratios, strict=True) if ratio.is_less}


def better_than(friction: Any) -> set[str]:
    """Joints whose torques are surely told better than by other friction."""
    other = identified(friction).errors.after
    return better(replace(arm().errors, plain=other).to_plain())


def test_no_joint_of_an_arm_is_surely_told_worse_than_by_plain_least_squares():
    errors = arm().errors
    assert not [joint for joint, ratio in zip(joints(), errors.to_plain(), strict=True) if ratio.is_more]
    assert better(errors.to_plain()) == {PAN, LIFT, WRIST_2}
    assert (errors.rms("after", held_out=True)[:5] < 0.15 * errors.size()[:5]).all()


def test_the_pan_is_told_better_since_friction_changes_its_sign_over_a_range_of_speeds():
    assert PAN in better_than(laws({PAN: plain_laws()[PAN]}))


def test_the_lift_is_told_better_since_its_friction_grows_with_load():
    chosen = laws({})[LIFT]
    assert chosen.per_load is not None
    assert LIFT in better_than(laws({LIFT: replace(chosen, per_load=None)}))


def test_the_second_wrist_is_told_better_since_torques_weigh_by_their_noise_and_bodies_exist():
    # all that is left beside plain least squares once friction is theirs
    assert WRIST_2 in better(identified(plain_laws()).errors.to_plain())


def test_the_third_wrist_errs_most_while_it_rests():
    time, squares = arm().errors.resting()
    assert time[5] < 0.1 and squares[5] > 0.5
    assert any("occurs at rest" in note and "wrist_3_joint" in note for note in arm().doubts)


def test_the_slide_predicts_its_other_log_whose_pulses_are_in_its_command():
    found = identify_rigid(slide(), read_recording(EMPS, emps_mapping()), friction={"slide": SIGN})
    new = read_recording(EMPS.with_name("DATA_EMPS_PULSES.mat"), emps_mapping())
    errors = low_pass(found.prediction(new, 60.0) - new["torque"], new.period, 10.0)
    known = np.isfinite(errors)
    assert np.sqrt(np.mean(errors[known] ** 2)) < 0.05 * np.sqrt(np.mean(new["torque"][known] ** 2))

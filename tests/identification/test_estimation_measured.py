"""Real machines: a slide whose authors published its parameters, and an arm that predicts the rest of its own log."""

from pathlib import Path

import numpy as np
import pytest
from measured import EMPS, UR10, UR10_MAPPING, emps_mapping

from cutpoint import Coulomb, Robot
from cutpoint.identification import low_pass, read_recording
from cutpoint.identification.rigid.identify_rigid import identify_rigid
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import load

SIGN = Coulomb(1.0, 0.0, smoothing=1e-4)
"""As good as sgn(v), which the authors take."""


def slide() -> Robot:
    along = Joint("slide", "prismatic", "base", "carriage", axis=np.array([1.0, 0.0, 0.0]))
    return Robot(build("emps", [Link("base"), Link("carriage", 90.0, np.zeros(3), np.eye(3))], [along]))


def test_the_slide_has_the_mass_and_the_friction_that_its_authors_published():
    found = identify_rigid(slide(), read_recording(EMPS, emps_mapping()), friction={"slide": SIGN})
    # Janot, Gautier, Brunot (2019): kg, N s/m, N, N
    assert found.parameters[0].value == pytest.approx(95.1089, rel=0.01)
    assert found["viscous.slide"].value == pytest.approx(203.5034, rel=0.01)
    assert found["coulomb.slide"].value == pytest.approx(20.39, rel=0.02)
    assert found["offset.slide"].value == pytest.approx(-3.16, rel=0.02)


def test_a_chosen_friction_law_predicts_an_arm_better_than_a_stated_one(tmp_path: Path):
    mapping = tmp_path / "ur10.yaml"
    mapping.write_text(UR10_MAPPING)
    recording, robot = read_recording(UR10, mapping).resampled(8e-3), load("ur10_robot.urdf")
    half = 0.6 * recording.time[-1]
    known, new = recording.between(0.0, half), recording.between(half, recording.time[-1])
    # what is called currents has the size of the arm's torques
    constants = dict.fromkeys(robot.joints, 1.0)
    missed = {}
    for friction in ("stated", "choose"):
        found = identify_rigid(robot, known, friction=friction, torque_constants=constants, cutoff=10.0)  # type: ignore[arg-type]
        errors = found.prediction(new, 10.0) - new["current"]
        missed[friction] = np.sqrt(np.nanmean(errors**2, axis=0))
    torque = np.sqrt(np.mean(new["current"] ** 2, axis=0))
    assert (missed["choose"][:5] < 0.15 * torque[:5]).all()
    assert (missed["choose"][:3] < 0.8 * missed["stated"][:3]).all()


def test_the_slide_predicts_its_other_log_whose_pulses_are_in_its_command():
    found = identify_rigid(slide(), read_recording(EMPS, emps_mapping()), friction={"slide": SIGN})
    new = read_recording(EMPS.with_name("DATA_EMPS_PULSES.mat"), emps_mapping())
    errors = low_pass(found.prediction(new, 60.0) - new["torque"], new.period, 10.0)
    known = np.isfinite(errors)
    assert np.sqrt(np.mean(errors[known] ** 2)) < 0.05 * np.sqrt(np.mean(new["torque"][known] ** 2))

"""A kinematic error varies the motor's share of the load from tooth to tooth: links are identified without it."""

from dataclasses import replace

import numpy as np
import pytest
from simulated_logs import NOISE, known_arm, recorded

from cutpoint import Harmonic, KinematicError
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.motion import motion_of
from cutpoint.identification.rigid.identify_rigid import identify_rigid
from cutpoint.identification.rigid.rigid_robot import link_torques

CUTOFF = 40.0
ERROR = KinematicError((Harmonic(2, 8e-4, 0.7),))


@pytest.mark.parametrize("seed", [1, 3])
@pytest.mark.parametrize("friction", ["stated", "choose"])
def test_links_are_told_as_well_as_without_a_kinematic_error(seed: int, friction):
    arm = known_arm(seed, 2)
    log = recorded(arm.robot, seed)
    motion = motion_of(arm.robot, log, CUTOFF)
    load = link_torques(arm.robot, motion, arm.robot.inertial_parameters)
    reaction = np.nan_to_num(ERROR.slope(motion.theta, 100.0) * load)
    shaken = replace(log, torque=log["torque"] - reaction)
    errors = dict.fromkeys(arm.file.joints, ERROR)
    smooth = identify_rigid(arm.file, log, friction=friction, cutoff=CUTOFF)
    found = identify_rigid(arm.file, shaken, friction=friction, cutoff=CUTOFF, kinematic_errors=errors)
    unaware = identify_rigid(arm.file, shaken, friction=friction, cutoff=CUTOFF)
    assert (unaware.noise > 2.0 * smooth.noise).any() and (found.noise < NOISE).all()
    assert found.noise == pytest.approx(smooth.noise, rel=0.1)
    deviations = np.array([(p.high - p.low) / 4.0 for p in smooth.parameters])
    values = [np.array([p.value for p in each.parameters]) for each in (smooth, found)]
    told = np.array([p.told for p in smooth.parameters])
    assert (np.abs(values[0] - values[1])[told] < deviations[told]).all()
    # the model has the reaction, too
    missed, floor = found.prediction(log, CUTOFF) - shaken["torque"], smooth.prediction(log, CUTOFF) - log["torque"]
    assert np.nanstd(missed) < 1.01 * np.nanstd(floor)


def test_what_is_no_kinematic_error_of_a_joint_is_refused():
    arm = known_arm(1, 2)
    log = recorded(arm.robot, 1)
    with pytest.raises(InputError, match=r"kinematic_errors\['joint0'\] must be a KinematicError, got 3"):
        identify_rigid(arm.file, log, kinematic_errors={"joint0": 3})  # type: ignore[dict-item]
    with pytest.raises(InputError, match="no driven joint is named 'wrist'"):
        identify_rigid(arm.file, log, kinematic_errors={"wrist": ERROR})

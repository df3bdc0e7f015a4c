"""Margins of loops: what they say is where `slowest_pole` has a pole on the unit circle."""

from dataclasses import replace

import numpy as np
import pytest
from law_library import elbow

import cutpoint
from cutpoint import Drive, InputError, Robot, Rotor, Sensors
from cutpoint.control import PD, VDC, Margins, margins, slowest_pole, tune
from cutpoint.formats import parse_urdf

PERIOD = 1e-3
LEANING = np.array([0.8, -0.5])

SLIDE = """
<robot name="slide"><link name="base"/>
  <link name="cart"><inertial><mass value="2"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
  <limit lower="-9" upper="9" effort="1e4" velocity="9"/></joint></robot>
"""


def cart() -> Robot:
    """2 kg on a level slide, with a rotor of 1 kg at the joint."""
    return Robot(parse_urdf(SLIDE), {"slide": Drive(10.0, Rotor(1e-2))})


def test_a_cart_has_the_margins_that_its_transfer_function_has() -> None:
    m, kp, kd, T = 3.0, 600.0, 90.0, 0.01
    found = margins(cart(), PD([kp], [kd], side="link"), [0.0], T)
    turns = np.geomspace(1e-4, np.pi, 200_000)
    z = np.exp(1j * turns)
    L = kp * T**2 / (2 * m) * (z + 1) / (z - 1) ** 2 + kd * T / (m * (z - 1))
    lag = np.interp(0.0, -np.log(np.abs(L)), np.angle(L) + np.pi)
    turn = np.interp(0.0, -np.log(np.abs(L)), turns)
    # the pole at half of sampling's frequency: (z - 1)^2 + g (kp T^2 / 2m (z + 1) + kd T / m (z - 1)) = 0 at z = -1
    assert found.gain == pytest.approx(2 * m / (kd * T), rel=1e-9)
    assert found.least_gain == 0.0
    assert found.phase == pytest.approx(np.rad2deg(lag), rel=1e-6)
    assert found.delay == pytest.approx(lag / turn * T, rel=1e-6)
    assert found.sensitivity == pytest.approx(np.max(1 / np.abs(1 + L)), rel=1e-3)


@pytest.mark.parametrize("sensors", [None, Sensors(delay=2e-3), Sensors(speeds="differenced")])
def test_a_command_that_is_as_much_larger_or_smaller_rings(sensors: Sensors | None) -> None:
    robot, q = elbow(), LEANING
    law = tune(robot, 4.0, PD, q=q, sensors=sensors)
    found = margins(robot, law, q, PERIOD, sensors=sensors)
    for joint in range(2):
        for factor in (found.gain[joint], found.least_gain[joint]):
            if factor == 0:
                continue
            gains = np.ones(2)
            gains[joint] = factor
            rings = replace(law, kp=gains * law.kp, kd=gains * law.kd)
            assert slowest_pole(robot, rings, q, PERIOD, sensors=sensors).size == pytest.approx(1.0, abs=1e-7)


def test_weight_that_pushes_over_must_be_borne() -> None:
    robot, q = elbow(), np.zeros(2)  # upright
    stiff = tune(robot, 4.0, PD, q=q)
    found = margins(robot, stiff, q, PERIOD)
    assert (found.least_gain > 0).all() and (found.least_gain < 1).all()
    weak = replace(stiff, kp=0.9 * found.least_gain * stiff.kp, kd=0.9 * found.least_gain * stiff.kd)
    with pytest.raises(InputError, match=r"margins: the law does not hold the robot there, .*: what is moved grows"):
        margins(robot, weak, q, PERIOD)


@pytest.mark.parametrize("periods", [1, 2, 3])
def test_what_comes_late_already_is_taken_off_the_delay(periods: int) -> None:
    law, T = PD([60.0], [30.0], side="link"), 0.01
    at_once, late = (margins(cart(), law, [0.0], T, sensors=Sensors(delay=k * T)) for k in (0, periods))
    assert at_once.delay > 4 * T
    assert late.delay == pytest.approx(at_once.delay - periods * T, rel=1e-9)


def test_vdc_has_margins_too() -> None:
    arm = cutpoint.robots.xia2019()
    found = margins(arm, tune(arm, 4.0, VDC), arm.neutral(), PERIOD)
    assert isinstance(found, Margins) and all(x.shape == (6,) for x in found)
    assert (found.gain > 1).all() and (found.least_gain < 1).all() and (found.sensitivity >= 1).all()

"""Margins of loops: what they say is where `slowest_pole` has a pole on the unit circle."""

from dataclasses import replace

import numpy as np
import pytest
from law_library import LAWS, elbow
from scipy.linalg import expm

import cutpoint
from cutpoint import Drive, InputError, LinearSpring, Robot, Rotor, Sensors
from cutpoint.control import PD, VDC, GravityCompensation, Guard, Margins, SuperTwisting, margins, slowest_pole, tune
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
PENDULUM = """
<robot name="pendulum"><link name="base"/>
  <link name="bob"><inertial><origin xyz="0 0 {height}"/><mass value="1"/>
  <inertia ixx="{inertia}" iyy="{inertia}" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="bob"/><axis xyz="0 1 0"/>
  <limit lower="-9" upper="9" effort="1e6" velocity="99"/></joint></robot>
"""


def cart() -> Robot:
    """2 kg on a level slide, with a rotor of 1 kg at the joint."""
    return Robot(parse_urdf(SLIDE), {"slide": Drive(10.0, Rotor(1e-2))})


def pendulum(height: float, inertia: float, drive: Drive | None = None) -> Robot:
    """1 kg so far above its axis, of so much inertia about its centroid."""
    text = PENDULUM.format(height=height, inertia=inertia)
    return Robot(parse_urdf(text), {"hinge": drive or Drive(100.0, Rotor(1e-4))})


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
    with pytest.raises(InputError, match=r"margins: the law does not hold the robot there .*: a deviation grows"):
        margins(robot, weak, q, PERIOD)


@pytest.mark.parametrize("periods", [1, 2, 3])
def test_what_comes_late_already_is_taken_off_the_delay(periods: int) -> None:
    law, T = PD([60.0], [30.0], side="link"), 0.01
    at_once, late = (margins(cart(), law, [0.0], T, sensors=Sensors(delay=k * T)) for k in (0, periods))
    assert at_once.delay > 4 * T
    assert late.delay == pytest.approx(at_once.delay - periods * T, rel=1e-9)


@pytest.mark.parametrize("period", [1e-3, 1e-4, 1e-5])
def test_damping_hides_no_weight_that_pushes_over(period: float) -> None:
    weight, kp = 9.81 * 0.5, 50.0
    found = margins(pendulum(0.5, 0.8), PD([kp], [10.0], side="link"), [0.0], period)
    assert found.least_gain == pytest.approx(weight / kp, rel=1e-6)


def test_a_narrow_dip_of_a_loop_counts() -> None:
    """Where the link swings against a motor that stands still L dips below 1, and by little."""
    J, Jm, K, kp, kd, T = 2.31, 2.82, 2607.0, 566206.975, 2364.259, 3.6e-4
    robot = pendulum(0.0, J, Drive(100.0, Rotor(Jm / 100**2), LinearSpring(K)))
    found = margins(robot, PD([kp], [kd]), [0.0], T)
    A = np.array([[0, 1, 0, 0], [-K / J, 0, K / J, 0], [0, 0, 0, 1], [K / Jm, 0, -K / Jm, 0]])
    moved = expm(np.block([[A, np.array([[0], [0], [0], [1 / Jm]])], [np.zeros((1, 5))]]) * T)
    turns = np.linspace(0.005, 0.02, 400_000)
    apart = np.exp(1j * turns)[:, None, None] * np.eye(4) - moved[:4, :4]
    L = np.linalg.solve(apart, np.broadcast_to(moved[:4, 4:], (len(turns), 4, 1)))[..., 0] @ [0, 0, kp, kd]
    crosses = np.flatnonzero(np.diff(np.abs(L) > 1))
    lag = np.rad2deg((np.angle(L[crosses]) + np.pi) % (2 * np.pi)).min()
    assert len(crosses) == 2 and found.phase == pytest.approx(lag, rel=1e-3)
    assert found.sensitivity == pytest.approx(np.max(1 / np.abs(1 + L)), rel=1e-4)


@pytest.mark.parametrize("name", [name for name in LAWS if name != "super-twisting"])
def test_no_margin_is_larger_than_the_sensitivity_lets_it_be(name: str) -> None:
    robot = elbow()
    found = margins(robot, LAWS[name](robot), LEANING, PERIOD)
    by_phase = 1 / (2 * np.sin(np.deg2rad(np.minimum(found.phase, 180.0)) / 2))
    by_gain = 1 / (1 - 1 / found.gain)
    by_least = 1 / (1 / np.maximum(found.least_gain, 1e-12) - 1)
    assert (found.sensitivity >= np.max([by_phase, by_gain, by_least], axis=0) * (1 - 1e-9)).all()


def test_a_law_without_slopes_at_rest_has_no_margins_wherever_it_is() -> None:
    robot = elbow()
    law = tune(robot, 2.0, SuperTwisting, q=LEANING)
    for each in (law, Guard(robot, law), law + GravityCompensation(robot)):
        with pytest.raises(InputError, match=r"margins: SuperTwisting jumps where errors vanish, .* by simulation"):
            margins(robot, each, LEANING, PERIOD)


def test_vdc_has_margins_too() -> None:
    arm = cutpoint.robots.xia2019()
    found = margins(arm, tune(arm, 4.0, VDC), arm.neutral(), PERIOD)
    assert isinstance(found, Margins) and all(x.shape == (6,) for x in found[:-1])
    assert found.joints == tuple(arm.joints)
    assert [line.split()[0] for line in repr(found).splitlines()] == ["joint", *arm.joints]
    assert (found.gain > 1).all() and (found.least_gain < 1).all() and (found.sensitivity >= 1).all()

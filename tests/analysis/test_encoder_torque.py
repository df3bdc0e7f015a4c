"""Torque from two encoders: the bound covers, and is not idle."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import cutpoint
from cutpoint import InputError, LinearSpring, Sensors, simulate
from cutpoint.analysis import followed_hysteresis, torque_bound
from cutpoint.analysis.encoder_torque import COVERED
from cutpoint.control import PD, Feedforward
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.presliding import ElastoPlastic
from cutpoint.model import Harmonic, Motor
from robot_library import driven_by, robot, shoulder

SPRING = CatalogueSpring(10e3, 14e3, 16e3, 3.9, 12.0)
PARTS = {
    "everything": {
        "compliance": SPRING,
        "damping": 2.0,
        "link_friction": ElastoPlastic(cutpoint.Stribeck(0.5, 1.5, 0.2, 0.1, 0.02), 2e-4, 4.0, 0.7),
        "hysteresis": MaxwellSlip.smooth(1.4, 2.9e-4),
        "kinematic_error": KinematicError((Harmonic(2, 1.5e-4, 0.4),)),
        "motor_friction": ElastoPlastic(cutpoint.Coulomb(1.5, 3.0, 0.02, per_load=0.1), 3e-4, 3.0, 0.7),
        "motor": Motor(0.1, bandwidth=500.0, ripple=(Harmonic(12, 0.02),), cogging=(Harmonic(24, 0.004),)),
    },
    "no hysteresis": {"compliance": SPRING, "kinematic_error": KinematicError((Harmonic(2, 1.5e-4, 0.4),))},
}
ENCODERS = {
    "17 bits on the link": Sensors(link_resolution=2 * np.pi / 2**17, motor_resolution=2 * np.pi / 2**13 / 100),
    "alike and noisy": Sensors(
        link_resolution=2 * np.pi / 2**20, motor_resolution=2 * np.pi / 2**20, link_noise=2e-6, motor_noise=1e-6
    ),
}


@cache
def recorded(parts: str, encoders: str) -> tuple[cutpoint.Robot, cutpoint.Log]:
    arm = shoulder().with_payload(20.0, [0.3, 0.0, 0.0], 0.1 * np.eye(3), "link3")
    arm = arm.with_drives({name: replace(drive, **PARTS[parts]) for name, drive in arm.drives.items()})
    move = cutpoint.trajectories.cycloid(end=np.radians([90, 60, 60]), duration=3.0)
    law = PD([2e3, 2e3, 1e3], [60, 60, 35]) + Feedforward(arm)
    return arm, simulate(arm, law, move, sensors=ENCODERS[encoders])


@pytest.mark.parametrize("encoders", ENCODERS)
@pytest.mark.parametrize("parts", PARTS)
def test_the_bound_covers_999_of_1000_readings_and_is_hardly_larger_than_it_must_be(parts, encoders):
    arm, log = recorded(parts, encoders)
    theta, q = log["measured_theta"], log["measured_q"]
    speed = np.abs(log["theta_dot"] - log["v"]) + 2e-3  # two encoders' speeds, and what they may be off by
    bound = torque_bound(arm, theta, q, ENCODERS[encoders], winding_speed=speed, record=True)
    share = np.abs(arm.drive_torque(theta, q) - log["joint_torque"]) / bound.total
    assert (share < 1).mean() >= 0.999
    assert np.percentile(share, 99.9) > 1 / 1.5
    step = SPRING.k3 * np.max(ENCODERS[encoders].link_resolution)
    shown = [k for k in range(3) if np.ptp(log["joint_torque"][:, k]) > 10 * step]
    assert len(shown) >= 2
    for k in shown:
        assert np.percentile(share[:, k], 99.9) > 1 / 1.5


def test_following_the_elements_takes_hysteresis_out_of_the_reading():
    encoders = "alike and noisy"
    arm, log = recorded("everything", encoders)
    theta, q = log["measured_theta"], log["measured_q"]
    read = arm.drive_torque(theta, q)
    plain, followed = read - log["joint_torque"], read + followed_hysteresis(arm, theta, q) - log["joint_torque"]
    assert np.abs(followed).max() < 0.5 * np.abs(plain).max()
    assert torque_bound(arm, theta, q, ENCODERS[encoders], winding_speed=0.0).largest_part == ["hysteresis"] * 3


def test_a_damped_spring_needs_its_winding_speed():
    damped = {name: replace(d, damping=5.0) for name, d in robot("xia2019").drives.items()}
    arm, at = robot("xia2019").with_drives(damped), np.zeros((3, 6))
    with pytest.raises(InputError, match=r"the spring of 'joint1' is damped, .* give winding_speed, the largest"):
        torque_bound(arm, at, at, Sensors())
    assert (torque_bound(arm, at, at, Sensors(), winding_speed=0.0).total == 0).all()


def test_a_rigid_drive_is_not_read():
    arm = robot("xia2019").with_drives({"joint3": cutpoint.Drive()})
    bound = torque_bound(arm, np.zeros((5, 6)), np.zeros(6), Sensors(link_resolution=1e-4))
    assert bound.total.shape == (5, 6)
    assert (bound.total[:, 2] == 0).all()
    assert (bound.total[:, [0, 1, 3, 4, 5]] > 0).all()


@pytest.mark.parametrize("shape", [(6,), (3, 6), (2, 3, 6), (0, 6)])
def test_the_largest_part_is_told_for_readings_of_any_shape_and_is_none_where_nothing_is_off(shape):
    arm, at = robot("xia2019").with_drives({"joint3": cutpoint.Drive()}), np.zeros(shape)
    off = torque_bound(arm, at, at, Sensors(link_resolution=1e-5, link_noise=1e-5)).largest_part
    assert off == (["noise", "noise", "none", *["noise"] * 3] if at.size else ["none"] * 6)
    assert torque_bound(arm, at, at, Sensors()).largest_part == ["none"] * 6


AT = np.zeros((3, 6))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"theta": np.zeros(5)}, r"torque_bound: theta has shape \(5,\): its last axis must be 6"),
        ({"q": np.zeros((2, 6))}, r"shapes do not fit together: theta \(3, 6\), q \(2, 6\), winding_speed \(6,\)"),
        ({"q": None}, r"torque_bound: q must be numbers of shape \(\.\.\., 6\), got None"),
        ({"theta": np.full(6, np.nan)}, r"theta\[0\] is nan: every number must be finite"),
        (
            {"theta": AT[0], "q": AT[0], "record": True},
            r"readings have shape \(6,\), those of a motion are \(N, drives\)",
        ),
        ({"winding_speed": np.inf}, r"winding_speed\[0\] is inf"),
        ({"winding_speed": "fast"}, r"winding_speed must be numbers"),
        ({"sensors": None}, r"sensors must be Sensors, such as cutpoint.Sensors\(link_resolution=1e-5\), got None"),
        ({"sensors": Sensors(sides="motor")}, r"torque_bound: sensors.sides is 'motor'; a torque is read from .* both"),
        ({"sensors": Sensors(motor_noise=[1e-5] * 5)}, r"motor_noise .* one number, or one for each of 6 drives"),
    ],
)
def test_readings_that_make_no_sense_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        torque_bound(robot("xia2019"), **{"theta": AT, "q": AT, "sensors": Sensors(), **given})


def test_motions_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match=r"followed_hysteresis: readings have shape \(6,\), those of a motion are"):
        followed_hysteresis(robot("xia2019"), AT[0], AT[0])
    with pytest.raises(InputError, match=r"followed_hysteresis: q has shape \(3, 5\): its last axis must be 6"):
        followed_hysteresis(robot("xia2019"), AT, AT[:, :5])
    assert followed_hysteresis(robot("xia2019"), AT[:0], AT[:0]).shape == (0, 6)


def test_one_encoder_may_be_known_without_the_other():
    known = torque_bound(robot("xia2019"), AT, AT, Sensors(link_resolution=1e-4))
    assert torque_bound(robot("xia2019"), AT[:0], AT[:0], Sensors(), record=True).total.shape == (0, 6)
    assert (known.resolution > 0).all()
    assert (known.noise == 0).all()


def test_winding_either_way_counts_as_fast_and_springs_that_soften_where_they_are_wound_least():
    softening = CatalogueSpring(12e3, 6e3, 3e3, 2.0, 7.0)
    arm = robot("xia2019")
    drives = {name: replace(d, compliance=softening, damping=5.0) for name, d in arm.drives.items()}
    arm, at = arm.with_drives(drives), np.full((1, 6), 0.1)
    there, back = (torque_bound(arm, at, at, Sensors(), winding_speed=x).damping for x in (0.5, -0.5))
    assert (there == 2.5).all() and np.array_equal(there, back)
    # wound by 1e-3 rad, beyond both corners, and read wrong by so much that it may not be wound at all
    coarse = torque_bound(arm, at + 1e-3, at, Sensors(link_resolution=4e-3), winding_speed=0.0)
    assert coarse.resolution == pytest.approx(np.full((1, 6), 2 * softening.torque(1e-3)))


@pytest.mark.parametrize("stiffness", [(5e3, 30e3, 6e3), (10e3, 14e3, 11e3), (12e3, 6e3, 3e3), (3e3, 6e3, 12e3)])
def test_no_spring_is_read_farther_off_than_its_bound(stiffness):
    spring, step = CatalogueSpring(*stiffness, 2.0, 5.0), 5e-4
    arm = robot("xia2019")
    arm = arm.with_drives({name: replace(d, compliance=spring) for name, d in arm.drives.items()})
    read = np.linspace(-2e-3, 2e-3, 101)[:, None] + np.zeros(6)
    bound = torque_bound(arm, read, 0 * read, Sensors(link_resolution=step)).total
    off = [np.abs(spring.torque(read + x) - spring.torque(read)) for x in np.linspace(-step / 2, step / 2, 41)]
    assert np.max(off, axis=0) == pytest.approx(bound, rel=1e-12)


def test_what_the_motors_encoder_is_off_by_counts_with_the_steepest_wave():
    """Waves of slope 0.5: 1.5 times, where the output runs ahead most; there two encoders half a step off read that."""
    motor, link, K = 2e-6, 3e-6, 8e3
    waves = KinematicError((Harmonic(2, 0.5 / (2 * 100.0)),))
    arm = driven_by(compliance=LinearSpring(K), kinematic_error=waves)
    bound = torque_bound(arm, AT, AT, Sensors(link_resolution=link, motor_resolution=motor)).total
    assert bound == pytest.approx(np.full(AT.shape, K * (1.5 * motor + link) / 2), rel=1e-14)
    theta = np.linspace(0.0, 2 * np.pi / (2 * 100.0), 401)[:, None] + np.zeros(6)
    off = np.abs(arm.drive_torque(theta + motor / 2, theta - link / 2) - arm.drive_torque(theta, theta))
    # a slope falls by (order ratio motor / 2)^2 / 6 of itself over half a step; angles of 0.03 rad are rounded
    assert off.max(axis=0) == pytest.approx(bound[0], rel=(200 * motor / 2) ** 2 / 6 + 2e-16 * 0.1 / motor)
    noise = torque_bound(arm, AT, AT, Sensors(link_noise=link, motor_noise=motor)).noise
    assert noise == pytest.approx(np.full(AT.shape, K * COVERED * np.hypot(1.5 * motor, link)), rel=1e-14)


def test_elements_may_be_strained_by_twice_the_error_of_a_reading_that_stands_still():
    """Both ends of its way may be 2e-6 rad off; by 4e-6 rad the shorter of two elements has slipped."""
    slips = MaxwellSlip((2e3, 5e3), (1e-3, 1e-6))
    arm = driven_by(compliance=LinearSpring(8e3), hysteresis=slips)
    sensors = Sensors(link_resolution=3e-6, motor_resolution=1e-6)
    bound = torque_bound(arm, AT, AT, sensors, record=True).hysteresis
    assert bound == pytest.approx(np.full(AT.shape, 2e3 * 4e-6 + 5e3 * 1e-6), rel=1e-14)

"""The simulated stand-in for the experiment of section IV.C: what is wrong with it is what is stated, and no more."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutpoint import Robot
from cutpoint.control import PD, Feedforward
from cutpoint.robots import xia2019
from cutpoint.simulation import simulate
from cutpoint.studies.paper.imperfections import (
    ALL,
    FARTHEST,
    Chance,
    Imperfections,
    actual_drive,
    actual_mechanism,
    ripple_of,
)
from cutpoint.studies.paper.stand_in import KD, KP, StandIn, locked

MASSES = ALL.only("mass", "centroid", "moment")
RATIO = np.array([100.0, -80.0])
seeds = st.integers(0, 2**32 - 1)


@pytest.fixture(scope="module")
def stand_in():
    return StandIn(xia2019())


def test_the_load_of_wrong_masses_is_that_of_an_arm_that_has_them(stand_in):
    """Beyond the start, which is at rest in one and settles in the other."""
    chance, arm, model = Chance.of(3), xia2019(), stand_in.model
    drives = {name: actual_drive(drive, MASSES, chance, k) for k, (name, drive) in enumerate(model.drives.items())}
    heavier = Robot(locked(actual_mechanism(arm.mechanism, MASSES, chance)), drives)
    controller = PD(KP, KD, side="motor") + Feedforward(model, "elastic")
    log = simulate(heavier, controller, stand_in.reference).between(2.0, 30.0)
    loaded = stand_in.run(MASSES, 3)
    for told, found in ((log["position_error"], loaded.position_error), (log["feedback_torque"], loaded.feedback)):
        np.testing.assert_allclose(found[2000:], told, atol=2e-3 * np.abs(told).max())


def test_locked_joints_bear_what_the_whole_arm_would_at_zero(stand_in):
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1, 1, (3, 20, 2))
    whole = [np.pad(x, ((0, 0), (0, 4))) for x in (q, v, a)]
    np.testing.assert_allclose(
        stand_in.model.inverse_dynamics(q, v, a), xia2019().inverse_dynamics(*whole)[:, :2], rtol=1e-12, atol=1e-12
    )


def test_a_run_starts_where_the_loop_holds_the_arm_still(stand_in):
    run = stand_in.run(ALL.only("mass", "centroid", "stiffness", "friction", "motor_share", "damping"), 1)
    start = run.position_error[:50]
    assert np.abs(start[0]).max() > 1e-5
    np.testing.assert_allclose(start, np.broadcast_to(start[0], start.shape), atol=1e-8)


def test_a_seed_is_one_arm_and_another_is_another(stand_in):
    first, again, other = (stand_in.run(ALL, seed).position_error for seed in (5, 5, 6))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-5


@given(seeds)
def test_without_imperfections_the_drives_are_the_models(seed):
    for k, drive in enumerate(list(xia2019().drives.values())[:2]):
        actual = actual_drive(drive, Imperfections(), Chance.of(seed), k)
        speed = np.linspace(-1, 1, 7)
        np.testing.assert_array_equal(actual.link_friction.torque(speed), drive.link_friction.torque(speed))
        assert not actual.motor_friction.torque(speed).any()
        assert actual.compliance == drive.compliance and actual.rotor == drive.rotor
        assert not np.any(actual.kinematic_error.value(speed, actual.ratio))


@given(seeds)
def test_friction_may_change_sides_but_not_its_sum(seed):
    drive = xia2019().drives["joint1"]
    actual = actual_drive(drive, ALL.only("motor_share"), Chance.of(seed), 0)
    speed = np.linspace(-0.3, 0.3, 7)
    total = actual.link_friction.torque(speed) + actual.motor_friction.torque(speed)
    np.testing.assert_allclose(total, drive.link_friction.torque(speed), rtol=1e-12)


@given(seeds)
def test_no_arm_is_farther_off_than_stated(seed):
    nominal, chance = xia2019().mechanism, Chance.of(seed)
    for body, actual in zip(nominal.bodies, actual_mechanism(nominal, ALL, chance).bodies, strict=True):
        assert abs(actual.mass / body.mass - 1) <= FARTHEST * ALL.mass + 1e-12
        assert np.abs(actual.com - body.com).max() <= FARTHEST * ALL.centroid + 1e-12


@settings(max_examples=30)
@given(seeds, st.floats(-3, 3), st.floats(-3, 3))
def test_ripple_repeats_every_rotor_turn_and_keeps_to_its_amplitudes(seed, first, second):
    ripple, theta = ripple_of(ALL, Chance.of(seed), RATIO), np.array([first, second])
    np.testing.assert_allclose(ripple.torque(theta + 2 * np.pi / RATIO), ripple.torque(theta), atol=1e-9)
    assert np.abs(ripple.torque(theta)).max() <= sum(ALL.ripple) + 1e-12

"""Drives with everything on, in the loop: holding, breaking away, sticking and slipping, lagging, losing energy."""

from dataclasses import replace
from functools import cache
from unittest.mock import Mock

import numpy as np
import pytest

import cutpoint
from cutpoint import Coulomb, Drive, InputError, LinearSpring, Robot, Rotor, State, Stribeck, simulate
from cutpoint.control import PD, Command, Feedforward, Law, tune
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.presliding import ElastoPlastic, LuGre
from cutpoint.model import Harmonic, Motor
from cutpoint.simulation import adaptive
from cutpoint.trajectories import cycloid
from robot_library import Array, assert_close, robot

SPRING = CatalogueSpring(10e3, 14e3, 16e3, 3.9, 12.0)
GEAR = Coulomb(1.5, 3.0, 0.02, per_load=0.1)
POSE = np.array([0.3, 0.6, -0.8, 0.4, 0.9, -0.2])


def with_each(arm: Robot, **parts: object) -> Robot:
    """The arm with these parts in every drive."""
    return arm.with_drives({name: replace(drive, **parts) for name, drive in arm.drives.items()})


@cache
def bare() -> Robot:
    return with_each(robot("xia2019"), compliance=SPRING, link_friction=None)


@cache
def whole(backend: str = "llvm") -> Robot:
    """Hysteresis, kinematic error, bristles on both sides, load, a motor with everything."""
    waves = (Harmonic(12, 0.02, 0.3),), (Harmonic(24, 0.004),)
    arm = with_each(
        bare(),
        hysteresis=MaxwellSlip.smooth(1.4, 2.9e-4),
        kinematic_error=KinematicError((Harmonic(2, 1.5e-4, 0.4), Harmonic(1, 2e-5))),
        link_friction=ElastoPlastic(Stribeck(0.3, 0.8, 0.15, 0.1, 0.02), 2e-4, 3.0, 0.7),
        motor_friction=LuGre(replace(GEAR, asymmetry=0.1), 3e-4, 3.0),
        motor=Motor(0.1, 1.0, 500.0, 1.5e-4, 15.0, 48.0, *waves),
    )
    return Robot(arm.mechanism, arm.drives, backend=backend)


def move(duration: float) -> cutpoint.trajectories.Trajectory:
    return cutpoint.trajectories.cycloid(end=np.radians([20, 15, 10, 20, 10, 20]), duration=duration)


# one truth, however it is computed


def test_drives_side_by_side_in_machine_code_are_those_of_numpy():
    logs = []
    for backend in ("llvm", "numpy"):
        arm = whole(backend)
        law = tune(arm, 5.0) + Feedforward(arm)
        logs.append(simulate(arm, law, move(0.02), substeps=2))
    for channel in ("q", "theta", "motor_torque", "joint_torque", "hysteresis_torque", "link_strain", "motor_strain"):
        assert_close(logs[0][channel], logs[1][channel], 1e-10)


def test_one_drive_of_another_kind_changes_how_the_loop_is_computed_and_nothing_else():
    """A kinematic error of nothing on one joint keeps drives from running side by side."""
    arm = with_each(whole(), kinematic_error=None)
    name = arm.joints[3]
    odd = arm.with_drives({name: replace(arm.drives[name], kinematic_error=KinematicError((Harmonic(2, 0.0),)))})
    logs = [simulate(r, tune(r, 5.0), move(0.3), substeps=10) for r in (arm, odd)]
    assert np.ptp(logs[0]["q"][:, 3]) > 0.05
    for channel in ("q", "theta", "motor_torque", "hysteresis_torque"):
        assert_close(logs[0][channel], logs[1][channel], 1e-9)


def test_the_fixed_steps_converge_to_the_adaptive_ones():
    """Those follow bristles by their differential equation and stop wherever a spring turns back."""
    arm = whole()
    law = tune(arm, 5.0) + Feedforward(arm)
    hasty = cutpoint.trajectories.cycloid(end=[0.02] * 6, duration=0.04)
    truth = simulate(arm, law, hasty, accuracy="reference")["q"]
    errors = [np.abs(simulate(arm, law, hasty, substeps=n)["q"] - truth).max() for n in (10, 40, 160)]
    assert errors[0] < 2e-5
    assert errors[1] < errors[0] / 3
    assert errors[2] < errors[1] / 3


def test_the_log_says_what_set_the_steps():
    arm = whole()
    assert "of 'joint" in simulate(arm, None, duration=0.01).meta["steps_set_by"]
    slow = with_each(arm, motor=replace(arm.drives["joint1"].motor, bandwidth=5e4))
    assert simulate(slow, None, duration=0.01).meta["steps_set_by"].startswith("the current loop of 'joint")


# holding


class Constant(Law):
    """Constant torques, N m."""

    def __init__(self, torque: Array) -> None:
        self.torque = torque

    def step(self, memory, measurement, reference):
        return memory, Command(self.torque)


def held(law: object, share: float, duration: float) -> cutpoint.Log:
    """The arm under gravity, its weight carried by constant motor torques but for a share of static friction."""
    arm = with_each(bare(), link_friction=law, damping=5.0)
    torque = arm.gravity_forces(POSE) + share * np.array([2.0] * 6)
    return simulate(arm, Constant(torque), duration=duration, initial=State(q=POSE))


STATIC = Stribeck(1.0, 2.0, 0.2, 0.05, 0.02)
HOLDING = ElastoPlastic(STATIC, 2e-4, 4.0, 0.7)


def test_an_arm_at_rest_under_gravity_stays_there_for_100_s():
    log = held(HOLDING, 0.5, 100.0)
    late = log["q"][len(log.time) // 2 :]
    assert np.ptp(late, axis=0).max() < 1e-12
    assert np.abs(log["q"] - POSE).max() < 2 * HOLDING.distance  # a load put on at once winds up twice as far


def test_smoothed_friction_would_have_crept():
    log = held(STATIC, 0.5, 2.0)
    assert np.abs(log["q"][-1] - POSE).min() > 5e-3


@cache
def table() -> Robot:
    """A single joint about the vertical: no gravity."""
    arm = robot("xia2019").with_gravity([0.0, 0.0, 0.0])
    drive = Drive(100.0, cutpoint.Rotor(1.14e-5), LinearSpring(16e3), damping=10.0)
    return arm.with_drives({name: drive for name in arm.joints})


DAMPED = replace(HOLDING, damping=60.0)


def pushed(share: float) -> cutpoint.Log:
    """Joint 1 under a torque that grows to a share of breakaway in 1 s, is held for 2 s and then let go."""
    arm = table().with_drives({"joint1": replace(table().drives["joint1"], link_friction=DAMPED)})

    class Push(Law):
        def step(self, memory, measurement, reference):
            torque = share * 2.0 * cutpoint.clip(measurement.time, 0.0, 1.0)
            on = cutpoint.where(measurement.time < 3.0, torque, 0.0)
            return memory, Command(np.array([on, *[0.0] * 5]))

    return simulate(arm, Push(), duration=5.0)


def test_below_breakaway_a_joint_winds_up_and_comes_back():
    log = pushed(0.65)
    assert 1e-4 < log["q"][2900, 0] < 2e-4
    assert np.ptp(log["q"][2000:2900, 0]) < 1e-9
    assert abs(log["q"][-1, 0]) < 1e-7


def test_between_elastic_share_and_breakaway_it_gives_way_a_little_and_then_holds():
    log = pushed(0.9)
    assert np.ptp(log["q"][2000:2900, 0]) < 1e-6
    assert abs(log["q"][-1, 0]) > 1e-6


def test_above_breakaway_it_slides():
    assert pushed(1.1)["q"][2900, 0] > 0.1


def test_stick_slip_at_a_degree_a_second_does_not_depend_on_the_step():
    """A soft servo drags joint 1 along: it sticks, slips and sticks again."""
    arm = table().with_drives({"joint1": replace(table().drives["joint1"], link_friction=HOLDING)})
    law = PD([60.0] + [100.0] * 5, [4.0] + [10.0] * 5)

    class Drag(Law):
        def step(self, memory, measurement, reference):
            theta = np.array([np.radians(1.0) * measurement.time, *[0.0] * 5])
            speed = np.array([np.radians(1.0), *[0.0] * 5])
            return law.step(memory, measurement, reference._replace(theta=theta, theta_dot=speed))

    logs = [simulate(arm, Drag(), duration=6.0, substeps=n) for n in (8, 32)]
    sticks = np.abs(logs[1]["v"][:, 0]) < np.radians(0.02)
    slips = np.diff(sticks[500:].astype(int))
    assert (slips == -1).sum() >= 3, "it must stick and slip"
    travelled = np.ptp(logs[1]["q"][:, 0])
    assert np.sqrt(np.mean((logs[0]["q"][:, 0] - logs[1]["q"][:, 0]) ** 2)) < 1e-3 * travelled


# energy


@pytest.mark.parametrize(
    "parts",
    [
        {"compliance": SPRING, "kinematic_error": KinematicError((Harmonic(2, 1.5e-4, 0.4),))},
        {"compliance": cutpoint.Flexspline(16e3, 0.0464)},
        {"compliance": Backlash(LinearSpring(1e4), 2e-3)},
    ],
    ids=["catalogue with kinematic error", "flexspline", "backlash"],
)
def test_conservative_drives_conserve_energy(parts):
    arm = with_each(bare(), **parts).with_gravity([0.0, 0.0, 0.0])
    start = State(q=POSE, v=np.full(6, 0.3), theta_dot=np.full(6, 0.1))
    log = simulate(arm, duration=0.05, initial=start, accuracy="reference")
    energy = arm.kinetic_energy(log["q"], log["v"]) + arm.elastic_energy(log["q"], log["theta"], log["theta_dot"])
    assert np.ptp(energy) < 1e-9 * energy[0]


def test_turning_points_are_looked_for_where_there_is_hysteresis_alone(monkeypatch: pytest.MonkeyPatch):
    """A rigid joint's winding is zero all the time, which would count as turning points everywhere."""
    drive = Drive(100.0, compliance=SPRING, rotor=Rotor(1e-5), hysteresis=MaxwellSlip((5e3,), (2.9e-4,)))
    arm = robot("xia2019").with_drives({"joint1": Drive(100.0, rotor=Rotor(1e-5)), "joint2": drive})
    solved = Mock(wraps=adaptive.solve_ivp)
    monkeypatch.setattr(adaptive, "solve_ivp", solved)
    simulate(arm, PD(np.full(6, 500.0), np.full(6, 20.0)), cycloid(np.full(6, 0.3), 1.5), 5e-3, accuracy="reference")
    assert 5 <= solved.call_count < 50


@pytest.mark.parametrize("seed", range(5))
def test_a_free_arm_with_whole_drives_only_loses_energy(seed):
    """Links, rotors, springs, elements and bristles together; no motor, no gravity, any start."""
    rng = np.random.default_rng(seed)
    arm = with_each(whole(), motor=None, hysteresis=MaxwellSlip((5e3,), (2.9e-4,))).with_gravity([0.0, 0.0, 0.0])
    start = State(POSE, rng.normal(size=6), POSE + 1e-3 * rng.normal(size=6), rng.normal(size=6))
    log = simulate(arm, duration=0.5, initial=start, accuracy="fine")
    strains = np.concatenate([log["link_strain"], log["motor_strain"], log["hysteresis_torque"] / 5e3], axis=1)
    energy = arm.kinetic_energy(log["q"], log["v"])
    energy = energy + arm.elastic_energy(log["q"], log["theta"], log["theta_dot"], strains)
    assert (np.diff(energy) < 1e-6 * energy[0]).all()
    assert energy[-1] < 0.5 * energy[0]


# motors


def test_the_current_loop_lags_and_the_delay_delays():
    motor = Motor(0.1, bandwidth=100.0, delay=5e-4)
    arm = table().with_drives({"joint1": replace(table().drives["joint1"], motor=motor)})
    log = simulate(arm, Constant(np.array([1.0, *[0.0] * 5])), duration=0.02, substeps=20)
    since = np.maximum(log.time - 5e-4, 0.0)
    assert_close(log["motor_torque"][:, 0], 1 - np.exp(-2 * np.pi * 100.0 * since), 1e-6)


def test_a_motor_whose_current_is_given_was_told_that_current():
    arm = with_each(bare(), motor=Motor(0.1, bandwidth=100.0, delay=1e-3))
    still = Constant(np.zeros(6))
    held = simulate(arm, still, duration=0.01)["motor_torque"]
    slack = simulate(arm, still, duration=0.01, initial=State(current=np.zeros(6)))["motor_torque"]
    assert np.abs(held[:2]).max() > 1.0 and (held[1] == held[0]).all()
    assert not slack.any()


def test_a_delay_longer_than_a_period_is_refused():
    arm = with_each(bare(), motor=Motor(0.1, delay=2e-3))
    with pytest.raises(InputError, match=r"its motor's delay 0\.002 s must not exceed the control period, 0\.001 s"):
        simulate(arm, duration=0.1)


def test_current_and_voltage_bound_the_torque():
    """Torque-speed curve: at stall the current limit, near no-load speed hardly any torque."""
    motor = Motor(0.1, 1.0, current_limit=8.0, voltage_limit=24.0)
    arm = table().with_drives({"joint1": replace(table().drives["joint1"], motor=motor)})
    log = simulate(arm, Constant(np.array([1e3, *[0.0] * 5])), duration=2.0)
    torque, speed = log["motor_torque"][:, 0], log["theta_dot"][:, 0]
    assert torque[0] == pytest.approx(8.0 * 0.1 * 100.0)
    voltage = torque / 10.0 * 1.0 + 10.0 * speed
    assert voltage.max() <= 24.0 * (1 + 1e-9)
    assert voltage[-100:] == pytest.approx(24.0)


def test_feedforward_takes_ripple_cogging_and_hysteresis_into_account():
    arm = with_each(
        bare(),
        hysteresis=MaxwellSlip.smooth(1.4, 2.9e-4),
        motor=Motor(0.1, ripple=(Harmonic(12, 0.02, 0.3),), cogging=(Harmonic(24, 0.004),)),
    )
    errors = {}
    for known in (arm, with_each(arm, motor=None), with_each(arm, hysteresis=None), bare()):
        law = PD([2e3] * 6, [60.0] * 6) + Feedforward(known)
        errors[known] = simulate(arm, law, move(1.0)).rms("position_error")
    with_all, *without = errors.values()
    for other in without:
        assert np.linalg.norm(with_all) < 0.7 * np.linalg.norm(other)

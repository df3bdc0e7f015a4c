"""Causes of short steps besides modes at rest: waves of the motor, hardening springs, play."""

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import cutpoint
from cutpoint import (
    Backlash,
    Coulomb,
    Drive,
    ElastoPlastic,
    Flexspline,
    Harmonic,
    KinematicError,
    Limits,
    LinearSpring,
    Log,
    LuGre,
    Motor,
    Robot,
    Rotor,
    State,
    simulate,
    simulate_many,
)
from cutpoint.control import Command, Law, tune
from cutpoint.model import Body, Joint, Mechanism
from cutpoint.simulation import StiffnessWarning
from cutpoint.simulation.steps.fastest import fastest_mode, posture
from cutpoint.simulation.steps.substeps import substeps_for

SPRING = LinearSpring(16e3)
COGGING = Motor(0.1, cogging=(Harmonic(84, 0.02),))
STATES = np.zeros((1, 1))


def turning(**parts: Any) -> Robot:
    """One body about the vertical, 0.042 kg m2, behind a motor of 0.1 kg m2 at the joint."""
    body = Body("link", Joint("joint", "revolute", "", "link"), -1, np.eye(4), 1.0, np.zeros(3), 0.042 * np.eye(3))
    return Robot(Mechanism("one", (body,), {}), {"joint": Drive(100.0, Rotor(1e-5), **parts)})


def carried_rotors(inertia: float, ratio: float) -> Robot:
    """Two light bodies on parallel axes, each behind a spring; the first carries the second's rotor, kg m2."""
    bodies = [
        Body(f"b{k}", Joint(f"j{k}", "revolute", "", f"b{k}"), k - 1, np.eye(4), 0.1, np.zeros(3), 0.02 * np.eye(3))
        for k in range(2)
    ]
    rotor = Rotor(inertia, in_link_inertia=False, transverse=inertia, coupling="full")
    drive = Drive(ratio, rotor, LinearSpring(1e4))
    return Robot(Mechanism("two", tuple(bodies), {}), {"j0": drive, "j1": drive})


class Shaken(Law):
    """amplitude sin(2 pi frequency t), N m."""

    def __init__(self, amplitude: float, frequency: float) -> None:
        self.amplitude, self.frequency = amplitude, frequency

    def step(self, memory, measurement, reference):
        swing = cutpoint.sin(2 * np.pi * self.frequency * measurement.time)
        return memory, Command(np.array([self.amplitude * swing]))


def shaken(robot: Robot, amplitude: float, frequency: float, **options: Any) -> Log:
    return simulate(robot, Shaken(amplitude, frequency), duration=0.2, initial=State(q=np.zeros(1)), **options)


def off(run: Log, truth: Log) -> float:
    """How far the link departs, rad."""
    return float(np.abs(run["q"] - truth["q"]).max())


@pytest.mark.parametrize("spring", [SPRING, None], ids=["elastic", "rigid"])
def test_cogging_that_is_faster_than_the_longest_step_is_followed(spring):
    """84 waves a turn at a ratio of 100 and up to 3 rad/s: 25 200 rad/s, 6.3 rad of a quarter of a millisecond."""
    ours = turning(compliance=spring, motor=COGGING)
    law, move = tune(ours, 4.0), cutpoint.trajectories.cycloid(end=[0.6], duration=0.4)
    found, truth = simulate(ours, law, move), simulate(ours, law, move, accuracy="reference")
    assert found.meta["steps_set_by"] == "waves of order 84 of the motor of 'joint'"
    assert off(found, truth) < 1e-6
    assert off(simulate(ours, law, move, substeps=4), truth) > 1e-4


@pytest.mark.parametrize(("accuracy", "radians"), [("standard", 2.0), ("fine", 1.0)])
def test_a_step_takes_so_much_of_the_fastest_wave_and_only_of_one_that_is_there(accuracy, radians):
    waves = KinematicError((Harmonic(2, 1e-4), Harmonic(90, 1e-9), Harmonic(200, 0.0)))
    ours, speed = turning(compliance=LinearSpring(1e3), kinematic_error=waves), np.array([-3.0])
    steps = substeps_for(ours, accuracy, 1e-3, STATES, speed)
    assert steps.number == np.ceil(90 * 100.0 * 3.0 * 1e-3 / radians)
    bare = turning(compliance=LinearSpring(1e3))
    least = substeps_for(bare, accuracy, 1e-3, STATES)
    assert substeps_for(bare, accuracy, 1e-3, STATES, speed) == least
    assert substeps_for(ours, accuracy, 1e-3, STATES) == least


def test_waves_that_turn_out_too_fast_for_the_steps_are_told_of():
    ours, start = turning(compliance=SPRING, motor=COGGING), State(q=np.zeros(1), v=np.ones(1))
    pushed = {"duration": 0.1, "initial": start}
    told = r"at which waves of order 84 of the motor of 'joint' would take \d+ .*, but 5 were taken: give substeps="
    with pytest.warns(StiffnessWarning, match=told):
        simulate(ours, Shaken(40.0, 5.0), **pushed)
    with pytest.warns(StiffnessWarning, match=r"simulate_many: runs 0, 1 of 2 reached speeds " + told) as of_many:
        simulate_many([ours, ours], Shaken(40.0, 5.0), **pushed)
    assert len(of_many) == 1 and of_many[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(ours, Shaken(40.0, 5.0), substeps=50, **pushed)
        simulate(turning(compliance=SPRING), Shaken(40.0, 5.0), **pushed)


@pytest.mark.parametrize("stiffness", [1e5, 1e6])
def test_play_is_followed_where_nothing_holds_the_drive_against_a_flank(stiffness):
    """At rest within its play the spring has no stiffness to speak of."""
    ours = turning(compliance=Backlash(LinearSpring(stiffness), 1e-3))
    truth = shaken(ours, 20.0, 5.0, accuracy="reference")
    assert off(shaken(ours, 20.0, 5.0), truth) < 1e-4
    assert off(shaken(ours, 20.0, 5.0, substeps=4), truth) > 1e-4


def test_a_spring_that_hardens_is_followed_up_to_the_torque_of_its_motor():
    law = Flexspline(32e3, 0.0864)
    limits = {"effort": {"limits": Limits(effort=60.0)}, "current": {"motor": Motor(0.1, current_limit=6.0)}}
    slope = law.tangent(law.deflection(60.0))
    at_peaks = substeps_for(turning(compliance=LinearSpring(slope)), "fine", 1e-3, STATES)
    for parts in limits.values():
        assert substeps_for(turning(compliance=law, **parts), "fine", 1e-3, STATES) == at_peaks
    assert substeps_for(turning(compliance=law), "fine", 1e-3, STATES).number < at_peaks.number


def test_springs_that_were_wound_until_they_were_much_stiffer_are_warned_of():
    """A step of 1 rad without limits, of a light motor behind a flexspline: 26 times as stiff as at rest."""
    arm = turning(compliance=Flexspline(3000.0, 0.05), damping=2.0)
    light = arm.with_drives({"joint": replace(arm.drives["joint"], rotor=Rotor(1e-6))})

    def law(memory: Any, measurement: Any, reference: Any) -> Any:
        return memory, 200.0 * (1.0 - measurement.theta) - 8.0 * measurement.theta_dot

    truth = simulate(light, law, duration=0.2, accuracy="reference")
    rule = r"wound springs until the spring of 'joint' would take \d+ .* substeps=\d+"
    with pytest.warns(StiffnessWarning, match=rule) as told:
        run = simulate(light, law, duration=0.2)
    assert off(run, truth) > 1e-4 and told[0].filename == __file__
    asked = int(str(told[0].message).rsplit("=", 1)[1])
    assert off(simulate(light, law, duration=0.2, substeps=asked), truth) < 2e-4


RUBS = Coulomb(10.0, 0.4)


@pytest.mark.parametrize("law", [LuGre(RUBS, 3e-4, 600.0), ElastoPlastic(RUBS, 3e-4, 1200.0, 0.7)])
def test_bristles_that_resist_much_turn_back_where_they_should(law: LuGre | ElastoPlastic):
    """In longer steps the link went on sliding for ever where it should come to rest."""
    ours = turning(compliance=LinearSpring(3e3), damping=1.0, link_friction=law)
    feedback, move = tune(ours, 8.0), cutpoint.trajectories.cycloid(end=[0.5], duration=0.3)
    found, truth = (
        simulate(ours, feedback, move, duration=0.5),
        simulate(ours, feedback, move, duration=0.5, substeps=200),
    )
    assert found.meta["steps_set_by"] == "the damping of the bristles of 'joint'"
    assert off(found, truth) < 1e-5
    assert off(simulate(ours, feedback, move, duration=0.5, substeps=4), truth) > 1e-3


@pytest.mark.parametrize("coulomb", [0.05, 0.1, 0.2])
@pytest.mark.parametrize(("accuracy", "error"), [("standard", 1e-4), ("fine", 1e-6)])
def test_a_light_motor_that_friction_stops_stays_while_the_springs_damping_pulls(coulomb, accuracy, error):
    """It stops within microseconds; in steps of a quarter of a millisecond it slid on, as fast as before."""
    friction = Coulomb(coulomb, 0.1, 0.01)
    drive = Drive(1.0, Rotor(1e-5), LinearSpring(100.0), damping=1.0, motor_friction=friction)
    arm = turning().with_drives({"joint": drive})
    start = State(np.zeros(1), np.array([0.1]), np.zeros(1), np.array([0.1]))
    found, truth = (simulate(arm, duration=0.05, initial=start, accuracy=each) for each in (accuracy, "reference"))
    assert off(found, truth) < error
    if coulomb > 0.05:  # of less, damping drags it on anyway
        assert found.meta["steps_set_by"] == "friction beside the damping of 'joint'"


def floating() -> Robot:
    inertia = np.diag([0.01, 0.02, 0.025])
    body = Body("stone", Joint("free", "floating", "", "stone"), -1, np.eye(4), 1.0, np.zeros(3), inertia)
    return Robot(Mechanism("stone", (body,), {})).with_gravity([0.0, 0.0, 0.0])


def turned(log: Log) -> Any:
    return np.array([log[f"base_q{axis}"] for axis in "xyzw"])


def test_a_body_that_turns_fast_is_warned_of_and_its_quaternion_stays_one():
    start = State(floating().neutral(), np.array([0.0, 0, 0, 50, 1000, 50]))
    with pytest.warns(
        StiffnessWarning, match=r"at which the turning of 'stone' would take (\d+) .* substeps=\d+"
    ) as told:
        run = simulate(floating(), duration=0.2, initial=start)
    asked = int(str(told[0].message).rsplit("=", 1)[1])
    better = simulate(floating(), duration=0.2, initial=start, substeps=asked)
    truth = turned(simulate(floating(), duration=0.2, initial=start, accuracy="reference"))
    assert np.abs(turned(better) - truth).max() < 1e-4 < np.abs(turned(run) - truth).max()
    assert np.linalg.norm(turned(run), axis=0) == pytest.approx(1.0, abs=1e-12)


def test_a_delay_of_nothing_is_none_in_the_log() -> None:
    arms = [turning(compliance=SPRING, motor=Motor(0.1, delay=delay)) for delay in (0.0, None)]
    first, second = (shaken(arm, 5.0, 30.0) for arm in arms)
    for channel in ("command_torque", "motor_torque", "joint_torque", "q"):
        np.testing.assert_allclose(first[channel], second[channel], rtol=0, atol=1e-12)


@pytest.mark.parametrize("smoothing", [0.01, 0.001])
def test_friction_under_load_holds_a_light_link_behind_a_rigid_drive(smoothing: float) -> None:
    """It is implicit, load and all: explicit, it chattered and crept 40 times as far as it does."""
    friction = Coulomb(0.5, 0.0, smoothing, per_load=0.2)
    arm = turning().with_drives({"joint": Drive(100.0, Rotor(1e-6), motor_friction=friction)})

    def pulled(**options: Any) -> Log:
        def law(memory: Any, measurement: Any, reference: Any) -> Any:
            return memory, 31.5 + 0.0 * measurement.theta

        start = State(*np.zeros((4, 1)))
        against = lambda times: np.full((len(times), 1), -30.0)  # noqa: E731
        return simulate(arm, law, duration=0.1, initial=start, disturbances=against, **options)

    truth = pulled(accuracy="reference")["q"]
    assert truth[-1, 0] > 0.0
    assert np.abs(pulled()["q"] - truth).max() < 1e-7


def test_modes_of_rotors_that_are_most_of_what_carries_them_are_followed() -> None:
    """As fast as the fastest pole of the linear model, which knows nothing of how steps are chosen."""
    arm = carried_rotors(inertia=0.5, ratio=2.0)
    poles = arm.linearize(np.zeros(2)).A
    assert fastest_mode(arm, [posture(arm, np.zeros(2))]).rate == pytest.approx(
        np.abs(np.linalg.eigvals(poles)).max(), rel=1e-9
    )
    assert len(arm.modes(np.zeros(2)).frequencies) == 2


def test_such_springs_are_warned_of_on_a_floating_base_too() -> None:
    still = turning().mechanism
    (turned,) = still.bodies
    base = Body("base", Joint("free", "floating", "", "base"), -1, np.eye(4), 1e6, np.zeros(3), 1e6 * np.eye(3))
    link = replace(turned, parent=0, joint=replace(turned.joint, parent="base"))
    drive = Drive(100.0, Rotor(1.14e-5), Flexspline(2000.0, 0.05))
    arm = Robot(replace(still, bodies=(base, link)), {"joint": drive}).with_gravity([0.0, 0.0, 0.0])
    begun = State(arm.neutral(), np.array([*np.zeros(6), -8.0]), np.zeros(1), np.array([8.0]))
    with pytest.warns(StiffnessWarning, match=r"wound springs until the spring of 'joint' would take \d+"):
        simulate(arm, None, duration=0.1, initial=begun)

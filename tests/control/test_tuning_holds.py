"""Gains that `tune` gives hold the arm, those it refuses do not, and `slowest_pole` knows how fast."""

import re
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from law_library import elbow, law

from cutpoint import (
    Coulomb,
    Drive,
    InputError,
    LinearSpring,
    Log,
    Robot,
    Rotor,
    Sensors,
    SimulationError,
    robots,
    simulate,
)
from cutpoint.control import (
    PD,
    PID,
    VDC,
    AdaptiveVDC,
    ComputedTorque,
    DisturbanceObserver,
    ElasticComputedTorque,
    Feedforward,
    FragileWarning,
    FullStateFeedback,
    Guard,
    Law,
    Robust,
    SlotineLi,
    SuperTwisting,
    margins,
    slowest_pole,
    tune,
)
from cutpoint.model import Limits, Motor
from cutpoint.simulation import State
from cutpoint.trajectories import cycloid
from robot_library import Array, load

PERIOD = 1e-3
UPRIGHT = np.zeros(2)
"""Where gravity asks no torque, so that every law is at rest on its reference."""

LEANING = np.array([0.8, -0.5])

HOLDS = {
    PD: 40, PID: 20, ComputedTorque: 40, ElasticComputedTorque: 40, FullStateFeedback: 20, VDC: 20, AdaptiveVDC: 8,
    SlotineLi: 40, Robust: 40, SuperTwisting: 5,
}  # fmt: skip
"""Hz that are still accepted."""


def pushed(made: Any, seconds: float, push: float = 1e-5, robot: Any = None, sensors: Sensors | None = None) -> Log:
    """Upright, with links and motors moving a little (rad/s)."""
    v = push * np.array([1.0, -0.7])
    initial = State(UPRIGHT, v, UPRIGHT, 0.3 * v)
    return simulate(robot or elbow(), made, duration=seconds, initial=initial, sensors=sensors)


def size(log: Log) -> Array:
    """Of the state's deviation, sample by sample; speeds in units of 20 rad/s."""
    return np.linalg.norm(np.hstack([log["q"], log["v"] / 20, log["theta"], log["theta_dot"] / 20]), axis=1)


def rate(log: Log, seconds: float = 0.25) -> float:
    """1/s at which it grows, or decays where negative, between two windows at the end."""
    window = round(seconds / PERIOD)
    x = size(log)[-2 * window :]
    return float(np.log(np.linalg.norm(x[window:]) / np.linalg.norm(x[:window])) / seconds)


@pytest.mark.parametrize("share", [0.1, 1.0])
@pytest.mark.parametrize("kind", HOLDS)
def test_a_law_that_tune_accepts_lets_a_small_push_die_away(kind, share):
    options = {"root_gain": 0.05, "twist": 0.05} if kind is SuperTwisting else {}
    x = size(pushed(tune(elbow(), HOLDS[kind] * share, kind, **options), 2.0))
    assert x.max() < 20 * x[0]
    assert np.isfinite(x).all() and x[-500:].max() < x[:500].max()


@pytest.mark.parametrize("kind", [k for k in HOLDS if k is not SuperTwisting])
def test_a_bandwidth_too_high_is_refused_with_the_joint_that_swings_and_how_fast(kind):
    with pytest.raises(
        InputError, match=r"does not hold .*'(shoulder|elbow)' would swing at [\d.]+ Hz and grow by"
    ) as raised:
        tune(elbow(), 3.0 * HOLDS[kind], kind)
    pole, told = raised.value.evidence["pole"], str(raised.value)
    better = re.search(r"; a bandwidth of ([\d.]+) Hz holds", told)
    assert told.startswith(kind.__name__) and better
    tune(elbow(), float(better[1]), kind)
    assert pole.size > 1 and raised.value.evidence["joint"] == pole.joint
    assert f"{pole.joint!r} would swing at {pole.frequency:.1f} Hz" in told
    assert f"grow by {np.log(pole.size) / PERIOD:.3g}" in told


@pytest.mark.parametrize(
    "name",
    ["PD", "PID", "computed torque", "elastic computed torque", "full state feedback", "VDC, filter", "speed filter",
     "robust", "disturbance observer"],
)  # fmt: skip
def test_the_slowest_pole_is_how_fast_a_small_motion_dies_in_the_sampled_loop(name):
    expected = np.log(slowest_pole(elbow(), law(name), UPRIGHT, PERIOD).size) / PERIOD
    found = rate(pushed(law(name), 3.0 if expected > -10 else 1.0))
    assert abs(found / expected - 1) < 0.05, f"{found:.4g} 1/s in simulation, {expected:.4g} 1/s by the pole"


@pytest.mark.parametrize(
    ("name", "sensors"),
    [
        ("PD", Sensors(speeds="differenced")),
        ("PD", Sensors(delay=2e-3)),
        ("PD", Sensors(speeds="differenced", delay=1e-3)),
        ("VDC, filter", Sensors(delay=2e-3)),
    ],
)
def test_sensors_that_are_late_or_differenced_count(name, sensors):
    at_once, pole = (slowest_pole(elbow(), law(name), UPRIGHT, PERIOD, sensors=x) for x in (None, sensors))
    expected = np.log(pole.size) / PERIOD
    found = rate(pushed(law(name), 4.0, sensors=sensors))
    assert abs(found / expected - 1) < 0.05, f"{found:.4g} 1/s in simulation, {expected:.4g} 1/s by the pole"
    assert abs(np.log(pole.size / at_once.size)) > 1e-5


def rubbing(friction: Coulomb) -> Robot:
    return elbow().with_drives({name: replace(d, motor_friction=friction) for name, d in elbow().drives.items()})


def test_viscous_friction_counts_on_both_sides_of_the_loop():
    """Against simulation, in which it also keeps a loop stable that is not without."""
    robot, late = rubbing(Coulomb(0.0, 10.0)), Sensors(delay=3e-3, speeds="differenced")
    without = slowest_pole(elbow(), law("PD"), UPRIGHT, PERIOD, sensors=late)
    assert without.size > 1
    for made in (law("PD"), tune(robot, 3.0, ComputedTorque)):
        pole = slowest_pole(robot, made, UPRIGHT, PERIOD, sensors=late)
        found = rate(pushed(made, 4.0, robot=robot, sensors=late))
        assert pole.size < 1 and abs(found / (np.log(pole.size) / PERIOD) - 1) < 0.05


@pytest.mark.parametrize(("friction", "stops"), [((0.0, 1e-9), False), ((0.01, 0.0), False), ((1.0, 0.0), True)])
def test_what_grows_slowly_is_left_to_dry_friction_where_there_is_enough(friction, stops):
    with pytest.raises(InputError, match=r"grow by 0\.0\d+ nepers a second"):
        tune(elbow(), 68.4501)
    with nullcontext() if stops else pytest.raises(InputError, match=r"grow by 0\.0\d+ nepers a second"):
        tune(rubbing(Coulomb(*friction)), 68.4501)


def test_gains_are_held_against_the_sensors():
    tune(elbow(), 40.0)
    with pytest.raises(InputError, match=r"PD does not hold at this pose: .*; a bandwidth of \S+ Hz holds"):
        tune(elbow(), 40.0, sensors=Sensors(speeds="differenced", delay=1e-3))
    with pytest.raises(InputError, match=r"sensors delay by 500 periods: 4000 delayed numbers .* at most 1500"):
        tune(elbow(), 10.0, sensors=Sensors(delay=0.5))


def test_a_rotor_without_its_motor_is_asked_for():
    drives = {name: replace(d, rotor=Rotor(1e-7), damping=1.0) for name, d in elbow().drives.items()}
    with pytest.raises(InputError, match=r"has a rotor of \S+ kg m2 at the joint, under \S+ of the link: a catalogue"):
        tune(elbow().with_drives(drives), 5.0)


@pytest.mark.parametrize(
    "motor", [Motor(0.1, bandwidth=60.0), Motor(0.1, delay=7e-4), Motor(0.1, bandwidth=150.0, delay=3e-4)]
)
def test_motors_that_come_late_count(motor):
    """The first joint's motor alone."""
    slow = elbow().with_drives({"shoulder": replace(elbow().drives["shoulder"], motor=motor)})
    stiff = PD([3e3] * 2, [30.0] * 2)
    at_once, expected = (np.log(slowest_pole(robot, stiff, UPRIGHT, PERIOD).size) / PERIOD for robot in (elbow(), slow))
    found = rate(pushed(stiff, 2.0, robot=slow))
    assert abs(found / expected - 1) < 0.05, f"{found:.4g} 1/s in simulation, {expected:.4g} 1/s by the pole"
    assert abs(found - at_once) > 3 * abs(found - expected)


@pytest.mark.parametrize("name", ["PD", "PID", "VDC, filter", "disturbance observer"])
def test_a_guard_holds_as_its_law_does(name):
    bare, guarded = (slowest_pole(elbow(), x, UPRIGHT, PERIOD) for x in (law(name), Guard(elbow(), law(name))))
    assert guarded.joint == bare.joint
    assert guarded.size == pytest.approx(bare.size, abs=1e-9)
    assert guarded.frequency == pytest.approx(bare.frequency, abs=1e-6)


class Growing(Law):
    """Beside a PD's torque: a clock, a count that no motion changes and the command follows, one of errors that grows
    and that nothing follows, and torque that follows an average of the errors' sum, by way of another number."""

    def start(self) -> Any:
        return {"clock": 0.0, "count": 1.0, "seen": np.zeros(2), "sum": np.zeros(2), "average": np.zeros(2)}

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        error = r.theta - m.theta
        after = {
            "clock": m.time, "count": 1.01 * memory["count"], "seen": 2 * memory["seen"] + error,
            "sum": self.forgetting * memory["sum"] + error * m.period,
            "average": 0.5 * memory["average"] + 0.5 * memory["sum"],
        }  # fmt: skip
        return after, 900.0 * error - 20.0 * m.theta_dot + self.share * memory["average"] + 1e-9 * memory["count"]

    def __init__(self, share: float, forgetting: float = 1.0) -> None:
        self.share, self.forgetting = share, forgetting


def test_memory_counts_for_a_pole_where_motion_changes_it_and_the_command_follows():
    bare = slowest_pole(elbow(), PD([900.0] * 2, [20.0] * 2), UPRIGHT, PERIOD)
    assert slowest_pole(elbow(), Growing(0.0), UPRIGHT, PERIOD) == pytest.approx(bare, abs=1e-6)
    integrating = slowest_pole(elbow(), Growing(50.0), UPRIGHT, PERIOD)
    # an integrator's pole is near 1 - period * gain / kp
    assert integrating.size == pytest.approx(1 - PERIOD * 50.0 / 900.0, rel=1e-5)
    assert slowest_pole(elbow(), Growing(0.1, forgetting=1.001), UPRIGHT, PERIOD).size > 1.0005


def test_what_integrates_counts_where_joints_bear_a_load():
    for made in (partial(tune, elbow(), 5.0, PID), partial(DisturbanceObserver, elbow(), tune(elbow(), 5.0), 30.0)):
        limit = "limit" if made.func is tune else "torque_limit"
        cut_off, free = (slowest_pole(elbow(), made(**{limit: x}), LEANING, PERIOD) for x in (60.0, 1e9))
        assert cut_off.size == pytest.approx(free.size, abs=1e-9)
        assert cut_off.frequency == pytest.approx(free.frequency, abs=1e-6)


def test_a_law_that_reports_a_fault_at_a_pose_is_not_judged_there():
    guarded = Guard(elbow(), law("PD"), upper=[0.1, 0.1])
    with pytest.raises(InputError, match=r"Guard reports fault 5 .* choose a pose within its limits"):
        slowest_pole(elbow(), guarded, LEANING, PERIOD)


@pytest.mark.parametrize("limit", ["lower", "upper"])
def test_a_guard_is_not_judged_on_its_limit_where_it_holds_on_one_side_only(limit):
    guarded = Guard(elbow(), law("PD"), **{limit: LEANING})
    with pytest.raises(InputError, match=r"Guard reports fault 5 .* choose a pose within its limits"):
        slowest_pole(elbow(), guarded, LEANING, PERIOD)


@pytest.mark.parametrize("kind", [PD, VDC])
def test_gains_that_are_refused_make_a_small_motion_grow_as_fast_as_the_pole_says(kind):
    high = tune(elbow(), 10.0, kind, control_period=1e-5)
    faster = {"kp": 70, "kd": 9} if kind is PD else {"position_gain": 1, "motor_gain": 30}
    high = replace(high, **{name: x * getattr(high, name) for name, x in faster.items()})
    pole = slowest_pole(elbow(), high, UPRIGHT, PERIOD)
    expected = np.log(pole.size) / PERIOD
    assert expected > 1
    log = pushed(high, 12 / expected, 1e-9)
    x = size(log)
    half = len(x) // 2
    found = np.log(x[-1] / x[half]) / (PERIOD * (len(x) - 1 - half))
    assert abs(found / expected - 1) < 0.05
    assert elbow().joints[int(np.abs(log["theta_dot"][-1]).argmax())] == pole.joint
    with pytest.raises(SimulationError):
        pushed(high, 100 / expected + 1)


def test_a_tuned_integral_stays_within_what_currents_allow():
    """2 A at 0.1 N m/A through the gear are less than the stated effort."""
    drive = elbow().drives["shoulder"]
    weak = elbow().with_drives({"shoulder": replace(drive, motor=Motor(0.1, current_limit=2.0))})
    limit = tune(weak, 5.0, PID).limit
    assert limit[0] == pytest.approx(0.2 * abs(drive.ratio))
    assert limit[0] == Guard(weak, tune(weak, 5.0)).torque_limit[0]


def test_the_bound_of_a_robust_law_knows_friction_on_both_sides():
    forearm, friction = elbow().drives["elbow"], Coulomb(3.0, 0.5, 0.02)
    rubbing = [replace(forearm, link_friction=friction), replace(forearm, motor_friction=friction)]
    bounds = [tune(elbow().with_drives({"elbow": drive}), 5.0, Robust, width=1.0).bound for drive in rubbing]
    assert bounds[0] == pytest.approx(bounds[1])
    assert bounds[0][1] > 1.5


@pytest.mark.parametrize(
    ("kind", "remedy"), [(PD, "a control_period of 0.00025 s holds"), (Robust, "make width= wider")]
)
def test_what_does_not_hold_without_springs_is_not_told_to_damp_them(kind, remedy):
    rigid = {name: replace(drive, compliance=None, damping=None) for name, drive in elbow().drives.items()}
    with pytest.raises(InputError, match=f"{remedy}$"):
        tune(elbow().with_drives(rigid), 400.0, kind)


@pytest.mark.parametrize("limit", [None, 12.0])
def test_an_observer_does_not_wind_up_while_the_motors_give_all_they_have(limit):
    """A move that asks for more than the shoulder's motor has; its limit stated by the drive, or by hand."""
    drives = elbow().drives
    weak = elbow().with_drives({"shoulder": replace(drives["shoulder"], limits=Limits(effort=12.0))})
    base = tune(elbow(), 4.0, damping=1.0) + Feedforward(elbow())
    inertia = np.diag(elbow().mass_matrix(UPRIGHT)) + [d.reflected_inertia for d in drives.values()]
    seen = elbow() if limit else weak
    observer = DisturbanceObserver(seen, law=base, gain=12.0 * inertia, torque_limit=limit)
    move = cycloid([1.0, 0.0], 0.4)
    errors = [np.abs(simulate(weak, made, move, duration=3.0)["position_error"]) for made in (base, observer)]
    assert errors[0].max() > 0.05  # it is asked for too much
    assert errors[1].max() < 1.5 * errors[0].max()
    assert errors[1][-500:].max() < 2 * errors[0][-500:].max() + 1e-4


@pytest.mark.parametrize(("kind", "helps"), [(PD, True), (ComputedTorque, True), (FullStateFeedback, False)])
def test_a_shorter_period_is_advised_where_it_helps(kind, helps):
    bare = {j: replace(d, damping=None, link_friction=None, motor_friction=None) for j, d in elbow().drives.items()}
    ours = elbow().with_drives(bare)
    with pytest.raises(InputError, match="does not hold at this pose") as refused:
        tune(ours, 200.0, kind)
    assert ("a control_period of 0.00025 s holds" in str(refused.value)) == helps
    with nullcontext() if helps else pytest.raises(InputError, match="does not hold at this pose"):
        tune(ours, 200.0, kind, control_period=PERIOD / 4)


@pytest.mark.parametrize(("given", "told"), [(1.0, "0.001"), (250.0, "0.00025"), (1000.0, "0.001")])
def test_a_control_period_in_other_units_is_told_in_seconds(given, told):
    """In milliseconds and in microseconds; in a thousand seconds a mode grows millionfold, but slowly by the second."""
    with pytest.raises(InputError, match=f"a control_period of {told} s holds"):
        tune(robots.xia2019(), 2.0, control_period=given)


def test_gains_that_hardly_hold_are_said_with_what_margins_finds():
    arm = robots.xia2019()
    with pytest.warns(
        FragileWarning, match="PD holds at this pose, but hardly: the loop of 'joint2' amplifies"
    ) as told:
        law = tune(arm, 8.0, damping=1.0)
    found = margins(arm, law, np.zeros(6), PERIOD)
    said = re.search(r"disturbances ([\d.]+) times", str(told[0].message))
    assert said and float(said[1]) == pytest.approx(found.sensitivity.max(), rel=0.05)
    assert found.gain.min() < 1.12


def test_the_joint_said_to_swing_is_the_one_whose_loop_does_though_a_light_wrist_moves_farther():
    arm, q = load("ur5_robot.urdf"), [0.1, -1.0, 1.2, -0.5, 0.7, 0.1]
    sizes = [(1e-4, 3e4), (1e-4, 3e4), (1e-4, 2e4)] + [(2e-5, 6e3)] * 3
    drives = [Drive(100.0, Rotor(rotor), LinearSpring(spring), damping=1.0) for rotor, spring in sizes]
    arm = arm.with_drives(dict(zip(arm.joints, drives, strict=True)))
    made, sensors = tune(arm, 6.0, q=q), Sensors(delay=4e-3, speeds="differenced")
    with pytest.raises(InputError, match="'shoulder_lift_joint' would swing at"):
        tune(arm, 6.0, q=q, sensors=sensors)
    softened = [np.where(np.arange(6) == k, 0.5, 1.0) for k in range(6)]
    poles = [slowest_pole(arm, PD(made.kp * x, made.kd * x), q, PERIOD, sensors=sensors) for x in softened]
    growth = np.log([pole.size for pole in poles])
    assert arm.joints[growth.argmin()] == "shoulder_lift_joint" and 2 * growth.min() < np.delete(growth, 1).min()

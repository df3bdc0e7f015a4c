"""Sizing of drives: averages and lives as makers reckon them, margins, verdicts, and `cutpoint check`."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.image import imread
from matplotlib.text import Text
from typer.testing import CliRunner

import cutpoint
from cutpoint import Backlash, Coulomb, Drive, Harmonic, InputError, Limits, Motor, Ratings, Robot
from cutpoint.commands import app
from cutpoint.mechanics.drives.motor import shaft_torque, within_limits
from cutpoint.model.build import build
from cutpoint.model.mechanism import UNLIMITED, Joint, JointKind, Link
from cutpoint.robots import XIA2019_DRIVES, XIA2019_URDF
from cutpoint.studies.sizing import Sizing, duty, fastest, sizing
from cutpoint.studies.sizing.table import sentences
from cutpoint.trajectories import Trajectory, cycloid, retimed
from robot_library import assert_close, robot

VISCOUS, RATIO = 3.0, -80.0
PAPERS = robot("xia2019")
RATINGS = Ratings(
    rated_torque=7.8, average_torque=11.0, repeated_peak_torque=28.0, momentary_peak_torque=54.0,
    rated_speed=209.4, average_speed=366.5, maximum_speed=890.1, life=7000.0,
)  # fmt: skip
PAPER_MOTION = cycloid(end=np.radians([90, 60, 60, 90, 60, 90]), duration=1.0)
SPANS = st.lists(
    st.tuples(st.floats(1e-3, 10.0), st.floats(-100.0, 100.0), st.floats(0.01, 500.0)), min_size=1, max_size=8
)


class Polynomial(Trajectory):
    """One joint along speed + slope |t - middle|: a constant speed, or one that rises and falls back."""

    def __init__(self, duration: float, speed: float, slope: float = 0.0) -> None:
        super().__init__(duration)
        object.__setattr__(self, "speed", speed)
        object.__setattr__(self, "slope", slope)

    size = 1

    def _inside(self, t, order):
        x = t - self.duration / 2
        found = np.zeros((order + 1, *t.shape, 1))
        found[0, ..., 0] = self.speed * t + self.slope * x * np.abs(x) / 2
        found[1, ..., 0] = self.speed + self.slope * np.abs(x)
        found[2, ..., 0] = self.slope * np.sign(x)
        return found


def brake(viscous: float = VISCOUS, told: Limits = UNLIMITED, kind: JointKind = "continuous", **drive: Any) -> Robot:
    """A joint that only rubs: its torque is viscous times its speed.  told: limits that its robot file states."""
    wheel = Link("wheel", 1e-12, inertia=1e-12 * np.eye(3))
    spin = Joint("spin", kind, "base", "wheel", axis=np.array([0.0, 0.0, 1.0]), limits=told)
    friction = Coulomb(coulomb=0.0, viscous=viscous, smoothing=0.1)
    return Robot(build("brake", [Link("base"), wheel], [spin]), {"spin": Drive(RATIO, link_friction=friction, **drive)})


def spin(robot: Robot, trajectory: Trajectory, **options: float):
    return sizing(robot, trajectory, **options).drives["spin"]


def rated_arm(**ratings: float | None) -> Robot:
    arm = robot("xia2019")
    return arm.with_drives({name: replace(d, ratings=replace(RATINGS, **ratings)) for name, d in arm.drives.items()})


def test_at_constant_speed_and_torque_every_average_is_the_value_itself():
    found = spin(brake(ratings=RATINGS), Polynomial(2.0, speed=-4.0))
    asked = found.demand
    assert_close([abs(asked.output_torque.value), asked.output_torque_rms, asked.average_torque], [12.0] * 3)
    assert_close([asked.motor_torque_rms, asked.mean_motor_speed, asked.motor_speed.value], [12.0 / 80, 320, 320])
    assert_close(asked.power.value, 48.0)
    assert_close(found.life, 7000.0 * (7.8 / 12.0) ** 3 * (209.4 / 320.0))


@pytest.mark.parametrize("dwell", [0.0, 1.0])
def test_a_triangular_cycle_has_the_averages_that_integrals_give(dwell: float):
    # |speed| from 6 to 0 and back in 2 s: integrals of s^4, s^2 and s are 1/5, 1/3 and 1/2
    asked = spin(brake(), Polynomial(2.0, speed=0.0, slope=6.0), dwell=dwell).demand
    share = 2.0 / (2.0 + dwell)
    step = 1e-3  # the trapezoidal rule is off by step^2 / 12 times slopes at the ends
    assert_close(asked.average_torque, 18.0 * 0.4 ** (1 / 3), step**2)
    assert_close(asked.output_torque_rms, 18.0 * np.sqrt(share / 3), step**2)
    assert_close(asked.mean_motor_speed, 240.0 * share, step**2)


def test_the_load_diagram_of_a_published_selection_has_its_average():
    # Honpine, "How to Selection Harmonic Reduction Gear": s, N m, r/min at the output; prints 89 N m
    diagram = [(0.2, 150.0, 10.0), (3.0, 82.0, 20.0), (0.3, 130.0, 10.0), (0.2, 0.0, 0.0)]
    span, torque, speed = np.array(diagram).T
    assert abs(duty.average_torque(span, torque, speed) - 89.0) <= 0.5
    assert_close(duty.mean(span, speed), 65.0 / 3.7)


@given(cycle=SPANS, factor=st.floats(0.1, 10.0), part=st.floats(0.1, 0.9))
def test_averages_scale_with_torque_and_do_not_see_how_a_phase_is_cut(cycle, factor, part):
    span, torque, speed = np.array(cycle).T
    found = duty.average_torque(span, torque, speed)
    assert_close(duty.average_torque(span, factor * torque, speed), factor * found)
    assert_close(duty.average_torque(span, torque, factor * speed), found)
    cut = np.r_[span * part, span * (1 - part)], np.r_[torque, torque], np.r_[speed, speed]
    assert_close(duty.average_torque(*cut), found)
    assert np.abs(torque).min() - 1e-9 <= found <= np.abs(torque).max() + 1e-9


def test_twice_the_torque_leaves_an_eighth_of_the_life_and_twice_the_speed_half_of_it():
    slow = spin(brake(ratings=RATINGS), Polynomial(2.0, 1.0)).life
    assert_close(spin(brake(2 * VISCOUS, ratings=RATINGS), Polynomial(2.0, 1.0)).life, slow / 8)
    assert_close(spin(brake(VISCOUS / 2, ratings=RATINGS), Polynomial(1.0, 2.0)).life, slow / 2)


def test_a_drive_that_stands_still_lasts_for_ever():
    found = spin(brake(ratings=RATINGS), Polynomial(1.0, 0.0))
    assert found.life == np.inf and found.demand.average_torque == 0.0
    holding = np.array([5.0, 5.0])
    assert_close(duty.average_torque(np.ones(2), holding, np.zeros(2)), 5.0)


def test_peaks_are_permitted_as_often_as_their_turns_allow():
    # 10^4 / (2 n / 60 t) with n = 1680 rpm, t = 0.15 s
    speed, span = np.full(5, 1680 * np.pi / 30), np.array([1.0, 0.15, 1.0, 0.05, 1.0])
    torque = np.array([10.0, -200.0, 10.0, 150.0, 10.0])
    assert_close(duty.permitted_peaks(span, torque, speed, 100.0), 1e4 / (2 * 1680 / 60 * 0.15))
    assert duty.permitted_peaks(span, torque, speed, 200.0) is None
    assert duty.permitted_peaks(span, torque, 0 * speed, 100.0) == np.inf
    assert_close(duty.permitted_peaks(span, torque, speed, 0.0), 1e4 / (2 * 1680 / 60 * 3.2))


def test_a_stay_above_the_repeated_peak_that_goes_on_over_the_end_of_the_cycle_is_one():
    span, speed, torque = np.ones(10), np.full(10, 10.0), np.where((np.arange(10) > 3) & (np.arange(10) < 8), 9.0, 1.0)
    within = duty.permitted_peaks(span, torque, speed, 5.0)
    for shift in range(10):
        assert_close(duty.permitted_peaks(span, np.roll(torque, shift), speed, 5.0), within)


class GoesOn:
    """A motion of the user's own, which does not say what comes after its end: here it goes on."""

    duration, size = 1.0, 1

    def derivatives(self, t: Any, order: int) -> Any:
        return Polynomial(9.0, speed=4.0).derivatives(t, order)


def test_a_pause_stands_still_whatever_a_trajectory_says_of_the_time_after_its_end():
    found = sizing(brake(), GoesOn(), dwell=1.0)
    asked = found.drives["spin"].demand
    assert_close([asked.mean_motor_speed, asked.output_torque_rms], [160.0, 12.0 * np.sqrt(0.5)])
    assert_close(found.load.position[-2:, 0], [4.0, 4.0])


@pytest.mark.parametrize("coupling", ["reduced", "full"])
def test_a_rigid_drive_is_one_of_endless_stiffness(coupling: Any):
    def demanded(spring: cutpoint.LinearSpring | None) -> list[float]:
        drives = {name: Drive(100.0, cutpoint.Rotor(1.14e-5, coupling=coupling), spring) for name in PAPERS.joints}
        found = sizing(PAPERS.with_drives(drives), PAPER_MOTION).drives.values()
        return [x for drive in found for x in (drive.demand.output_torque_rms, drive.demand.motor_torque_rms)]

    assert_close(demanded(None), demanded(cutpoint.LinearSpring(1e12)), 1e-7)


@pytest.mark.parametrize("name", ["mixed", "flexspline", "friction", "rigid", "panda_coupled", "ur10"])
def test_what_the_motor_exerts_is_what_the_gear_passes_on_and_what_rotor_and_friction_take(name):
    arm = robot(name)
    n = len(arm.joints)
    load = sizing(arm, cycloid(end=np.linspace(0.3, -0.4, n), start=np.full(n, 0.1), duration=0.8)).load
    u = arm.elastic_inverse_dynamics(*cycloid(np.linspace(0.3, -0.4, n), 0.8, np.full(n, 0.1)).derivatives(load.time))
    for k, drive in enumerate(arm.drives.values()):
        law, inertia = drive.motor_friction, drive.reflected_inertia
        taken = inertia * u.theta_ddot[:, k]
        if law:
            taken = taken + law.coulomb * np.tanh(u.theta_dot[:, k] / law.smoothing) + law.viscous * u.theta_dot[:, k]
        assert_close(load.output_torque[:, k], load.motor_torque[:, k] * drive.ratio - taken, 1e-9, 1.0)
        assert_close(load.motor_speed[:, k], drive.ratio * u.theta_dot[:, k])


def test_a_gear_exerts_what_two_encoders_show():
    found = sizing(robot("flexspline"), PAPER_MOTION).load
    theta = robot("flexspline").elastic_inverse_dynamics(*PAPER_MOTION.derivatives(found.time)).theta
    assert_close(found.output_torque, robot("flexspline").drive_torque(theta, found.position), 1e-9)


@pytest.mark.parametrize(
    "imperfect",
    [{}, {"kinematic_error": cutpoint.KinematicError((Harmonic(2, 2e-4),))},
     {"motor": Motor(0.05, ripple=(Harmonic(12, 0.1),), cogging=(Harmonic(30, 0.02),))}],
    ids=["smooth", "kinematic error", "ripple and cogging"],
)  # fmt: skip
def test_peaks_do_not_depend_on_how_coarsely_they_are_looked_for(imperfect):
    arm = robot("xia2019")
    wavy = arm.with_drives({name: replace(d, **imperfect) for name, d in arm.drives.items()})
    far = cycloid(end=5.0 * PAPER_MOTION.end, duration=5.0)
    coarse, fine = (sizing(wavy, far, period=period) for period in (1.0, 1.6e-5))
    for name in arm.joints:
        ours, theirs = coarse.drives[name].demand, fine.drives[name].demand
        # beside a crest, at most 1/64 of a wave's eighth away, a wave has 1 - (2 pi / 512)^2 / 2 of it
        assert_close(ours.motor_torque.value, theirs.motor_torque.value, 8e-5)
        assert_close(ours.output_torque.value, theirs.output_torque.value, 8e-5)
        assert_close(ours.average_torque, theirs.average_torque, 1e-4)


def test_current_and_voltage_are_those_of_the_motor_and_margins_agree_with_its_torque_speed_curve():
    motor = Motor(0.05, resistance=0.6, current_limit=6.0, voltage_limit=24.0, cogging=(Harmonic(8, 0.01),))
    arm = robot("xia2019").with_drives({n: replace(d, motor=motor) for n, d in robot("xia2019").drives.items()})
    found = sizing(arm, cycloid(end=np.full(6, 1.5), duration=0.8))
    held = set()
    for k, (name, drive) in enumerate(arm.drives.items()):
        torque, speed = found.load.motor_torque[:, k], found.load.motor_speed[:, k]
        asked = found.drives[name].demand
        assert_close(asked.current_rms, asked.motor_torque_rms / 0.05)
        assert_close(np.abs(asked.voltage.value), np.abs(torque / 0.05 * 0.6 + 0.05 * speed).max())
        assert_close(asked.heat, 0.6 * asked.current_rms**2)
        possible = within_limits(drive, torque * drive.ratio, speed / drive.ratio)
        reached = bool(np.allclose(possible, torque * drive.ratio, rtol=1e-12, atol=0.0))
        assert reached == found.drives[name].margins[-1].holds & found.drives[name].margins[-2].holds
        held.add(reached)
    assert held == {True, False}


def test_current_overcomes_ripple_and_cogging():
    motor = Motor(0.05, ripple=(Harmonic(12, 0.1),), cogging=(Harmonic(30, 0.02),))
    arm = robot("xia2019").with_drives({n: replace(d, motor=motor) for n, d in robot("xia2019").drives.items()})
    load = sizing(arm, PAPER_MOTION).load
    u = arm.elastic_inverse_dynamics(*PAPER_MOTION.derivatives(load.time))
    for k, drive in enumerate(arm.drives.values()):
        reached = shaft_torque(drive, load.current[:, k] * 0.05 * drive.ratio, u.theta[:, k])
        assert_close(reached, u.motor_torque[:, k], 1e-9)


def limited(found: Sizing, joint: str = "spin") -> dict[str, float]:
    return {margin.limit: margin.value for margin in found.drives[joint].margins}


def test_every_margin_is_what_is_allowed_by_what_is_asked():
    limits = Limits(lower=-1.0, upper=4.0, velocity=5.0, effort=24.0)
    found = sizing(brake(ratings=RATINGS, limits=limits), Polynomial(1.0, 2.0), life=1000.0)
    assert {k: pytest.approx(x, rel=1e-9) for k, x in limited(found).items()} == {
        "average torque": 11 / 6, "repeated peak torque": 28 / 6, "momentary peak torque": 9.0,
        "average speed": 366.5 / 160, "maximum speed": 890.1 / 160, "motor torque": 4.0, "joint speed": 2.5,
        "joint travel": 2.5 / 1.5, "life": 7 * (7.8 / 6) ** 3 * (209.4 / 160),
    }  # fmt: skip
    assert all(
        abs(margin.at.value) == margin.demanded
        for margin in found.drives["spin"].margins
        if margin.at and margin.limit != "joint travel"
    )
    assert found.holds and found.tightest[0] == "spin" and found.tightest[1].limit == "joint travel"
    assert found.drives["spin"].verdict == "holds" and found.drives["spin"].missing == ()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_limit_on_one_side_alone_is_a_margin_too(side: float):
    def travel(end: float, limit: float) -> float:
        limits = Limits(lower=limit) if side > 0 else Limits(upper=-limit)
        return limited(sizing(brake(limits=limits), Polynomial(1.0, side * end)))["joint travel"]

    # the open side goes half a turn beyond the middle, or as far as the joint does
    assert travel(2.0, -1.0) == pytest.approx(np.pi / (np.pi - 1.0))
    assert travel(8.0, -1.0) == pytest.approx(9.0 / 8.0)
    assert travel(2.0, 0.0) == pytest.approx(1.0)
    assert travel(-2.0, -1.5) < 1.0 and travel(-8.0, 1.0) < 1.0


def test_limits_of_drive_and_robot_file_count_together_and_zeros_of_the_file_do_not():
    told = Limits(lower=-1.0, upper=8.0, velocity=3.0, effort=12.0)
    limits = Limits(lower=-2.0, upper=9.0, velocity=4.0, effort=9.0)
    found = limited(sizing(brake(told=told, limits=limits), Polynomial(1.0, 2.0)))
    # from -1 to 8, farthest from whose middle is the start
    assert found == {
        k: pytest.approx(x) for k, x in {"motor torque": 1.5, "joint speed": 1.5, "joint travel": 9 / 7}.items()
    }
    found = limited(sizing(brake(told=Limits(velocity=0.0, effort=0.0), limits=limits), Polynomial(1.0, 2.0)))
    assert found["motor torque"] == pytest.approx(1.5) and found["joint speed"] == pytest.approx(2.0)
    assert limited(sizing(brake(told=Limits(velocity=0.0, effort=0.0)), Polynomial(1.0, 2.0))) == {}


@pytest.mark.parametrize("factor", [1.0, 1 - 1e-6, 0.0])
def test_a_margin_holds_down_to_one_and_fails_below(factor: float):
    found = sizing(brake(ratings=Ratings(repeated_peak_torque=6.0 * factor or 1e-9)), Polynomial(1.0, 2.0))
    assert found.holds == (factor == 1.0) == (found.drives["spin"].verdict == "holds")
    assert (found.drives["spin"].permitted_peaks is None) == found.holds
    assert len(found.drives["spin"].failures) == (not found.holds)


@pytest.mark.parametrize(("effort", "told"), [(3.0, False), (10.0, True), (30.0, False)])
def test_a_drive_that_fails_only_as_its_motor_follows_the_kinematic_error_is_told(effort: float, told: bool):
    """2 rad/s against 3 N m s/rad are 6 N m; waves of 2e-4 rad, 320 rad/s fast, accelerate 0.64 kg m2 by 13 N m."""
    waves = cutpoint.KinematicError((Harmonic(2, 2e-4),))
    drive = {"rotor": cutpoint.Rotor(1e-4), "compliance": cutpoint.LinearSpring(1e6), "kinematic_error": waves}
    found = sizing(brake(limits=Limits(effort=effort), **drive), Polynomial(1.0, 2.0))
    words = " ".join(sentences(found))
    assert ("spin would hold if its motor did not follow the gear's kinematic error: margin 1.67," in words) == told
    assert [*found.smooth] == ["spin"] * (effort < 19.0) == [*found.results()["without_kinematic_error"]]


def test_a_margin_that_fails_is_never_told_as_one():
    found = sizing(brake(ratings=Ratings(average_torque=6.0 - 1e-3)), Polynomial(1.0, 2.0))
    assert not found.holds
    assert "margin < 1." in " ".join(sentences(found))
    assert "margin < 1: average torque" in {text.get_text() for text in found.plot().findobj(Text)}


def test_no_peaks_beyond_the_momentary_peak_torque_are_permitted():
    within, beyond = (Ratings(repeated_peak_torque=4.0, momentary_peak_torque=x) for x in (7.0, 5.0))
    assert "times in all" in " ".join(sentences(sizing(brake(ratings=within), Polynomial(1.0, 2.0))))
    found = sizing(brake(ratings=beyond), Polynomial(1.0, 2.0))
    assert found.drives["spin"].permitted_peaks is None
    assert "times in all" not in " ".join(sentences(found))


def test_what_is_not_stated_is_said_to_be_missing_and_not_assumed():
    bare = spin(brake(), Polynomial(1.0, 2.0))
    assert bare.verdict == "unrated" and bare.margins == () and bare.tightest is None and bare.life is None
    assert len(bare.missing) == 8
    some = spin(brake(ratings=replace(RATINGS, life=None, average_speed=None)), Polynomial(1.0, 2.0), life=1.0)
    assert some.missing == ("average speed", "life") and some.life is None
    assert "life" not in {margin.limit for margin in some.margins}
    assert some.demand.current is None and some.demand.voltage is None and some.demand.heat is None
    motor = Motor(0.05)
    assert "continuous current" in spin(brake(ratings=RATINGS, motor=motor), Polynomial(1.0, 2.0)).missing


def test_the_motors_continuous_current_is_held_against_its_rms():
    rated = brake(ratings=replace(RATINGS, continuous_current=2.0), motor=Motor(0.05))
    found = sizing(rated, Polynomial(1.0, 2.0), dwell=1.0)
    current = found.drives["spin"].demand.current_rms
    assert limited(found)["continuous current"] == pytest.approx(2.0 / current)
    assert found.drives["spin"].missing == ()


def test_the_worst_instant_is_where_the_arm_is_then():
    found = sizing(rated_arm(), PAPER_MOTION)
    for k, drive in enumerate(found.drives.values()):
        peak = drive.demand.output_torque
        assert_close(peak.position, PAPER_MOTION(peak.time).q, 1e-12)
        assert abs(peak.value) == np.abs(found.load.output_torque[:, k]).max()


@pytest.mark.parametrize(("count", "positions"), [(8, 8), (9, 0)])
def test_where_an_arm_is_is_listed_as_long_as_that_can_be_read(count: int, positions: int):
    links = [Link("base"), *(Link(f"l{k}", mass=1.0, com=np.zeros(3), inertia=np.eye(3)) for k in range(count))]
    joints = [Joint(f"j{k}", "revolute", "base", f"l{k}", limits=Limits(velocity=1.0)) for k in range(count)]
    told = next(iter(sentences(sizing(Robot(build("arms", links, joints)), cycloid(np.ones(count), 1.0)))))
    assert told.startswith("Tightest is j0 by its joint speed: 2 rad/s of 1 rad/s at 0.500 s")
    assert told.count("0.5,") + told.count("0.5)") == positions


def test_what_slides_is_told_in_newtons_and_metres():
    limits = Limits(lower=0.0, upper=1.0, velocity=1.0)
    slide = sizing(brake(kind="prismatic", limits=limits, ratings=Ratings(average_torque=5.0)), Polynomial(1.0, 2.0))
    assert [margin.unit for margin in slide.drives["spin"].margins] == ["N", "m/s", "m"]
    told = " ".join(sentences(slide))
    assert "6 N of 5 N over the cycle" in told and "2 m/s of 1 m/s" in told and "1.5 m of 0.5 m" in told


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"dwell": -1.0}, r"dwell -1.0 s must be finite and not negative"),
        ({"dwell": np.nan}, r"dwell nan s"),
        ({"period": 0.0}, r"period 0.0 s must be positive"),
        ({"period": 1e-9}, r"too many samples; at most 500,000 are"),
        ({"life": -5.0}, r"life -5.0 h must be positive"),
    ],
)
def test_wrong_times_are_refused(given: dict[str, float], told: str):
    with pytest.raises(InputError, match=told):
        sizing(brake(), Polynomial(1.0, 2.0), **given)


@pytest.mark.parametrize("duration", [0.05, 1.0, 30.0])
def test_the_fastest_reaches_the_limit_whatever_the_motion_took_before(duration: float):
    move = cycloid(end=[1.5], duration=duration)  # its peak speed is 2 * 1.5 rad / duration
    by_speed = fastest(brake(limits=Limits(velocity=2.0)), move, dwell=0.4)
    assert by_speed.duration == pytest.approx(2 * 1.5 / 2.0, rel=1e-3)
    assert (by_speed.holds, by_speed.dwell) == (True, 0.4)
    by_torque = fastest(brake(ratings=Ratings(repeated_peak_torque=10.0)), move)  # of friction alone
    assert by_torque.duration == pytest.approx(2 * 1.5 / (10.0 / VISCOUS), rel=1e-3)


@pytest.mark.parametrize("life", [None, 20_000.0])
def test_in_less_than_the_shortest_time_an_arm_breaks_a_limit(life: float | None):
    arm = rated_arm(average_torque=49.0, repeated_peak_torque=82.0, rated_torque=40.0)
    found = fastest(arm, PAPER_MOTION, life=life)
    assert found.holds and found.tightest is not None and found.tightest[1].value < 1.01
    assert not sizing(arm, retimed(PAPER_MOTION, found.duration * 0.998), life=life).holds


@pytest.mark.parametrize(
    ("drive", "told"),
    [
        ({}, r"no limit is stated: give drives ratings"),
        (
            {"ratings": Ratings(average_torque=1e9)},
            r"even in 0.00781 s every stated limit holds; the tightest: 'spin' .* state what limits the drives' speed",
        ),
        (
            {"limits": Limits(lower=-1.0, upper=1.0)},
            r"even in 128 s 'spin' needs 1.5 rad of 1 rad, joint travel; a slower motion does not help",
        ),
    ],
)
def test_where_no_time_is_the_shortest_it_is_said_why(drive: dict[str, Any], told: str):
    with pytest.raises(InputError, match=told):
        fastest(brake(**drive), cycloid(end=[1.5], duration=1.0))


def test_motions_that_are_not_of_the_robot_are_refused():
    with pytest.raises(InputError, match=r"trajectory has 2 joints, but the robot has 1 drives"):
        sizing(brake(), cycloid(end=[1.0, 2.0], duration=1.0))
    with pytest.raises(InputError, match=r"floating base has no motor"):
        sizing(robot("floating"), cycloid(end=np.ones(5), duration=1.0))
    with pytest.raises(InputError, match=r"looks like degrees"):
        sizing(robot("ur10"), cycloid(end=np.full(6, 90.0), duration=1.0))


def test_a_little_beyond_a_whole_turn_is_no_angle_in_degrees():
    found = sizing(robot("ur10"), cycloid(end=[np.radians(365.0), 0, 0, 0, 0, 0], duration=5.0))
    assert [margin.limit for margin in found.drives["shoulder_pan_joint"].failures][-1] == "joint travel"


# the command

MOTION = ["--to", "90,60,60,90,60,90", "--degrees", "--duration", "1"]


def checked(*arguments: str, status: int) -> str:
    result = CliRunner().invoke(app, ["check", *arguments])
    assert result.exit_code == status, result.output
    return " ".join(result.output.split())


def drive_file(folder: Path, ratings: str) -> str:
    path = folder / "rated.yaml"
    path.write_text(XIA2019_DRIVES.read_text().replace("defaults:\n", f"defaults:\n  ratings: {ratings}\n"))
    return str(path)


def test_a_robot_whose_drives_hold_exits_with_0_and_saves_its_numbers(tmp_path: Path):
    rated = drive_file(tmp_path, "{repeated_peak_torque: 60, average_torque: 50}")
    target = tmp_path / "check.json"
    text = checked("xia2019", *MOTION, "--drives", rated, "--json", str(target), "--dwell", "0.5", status=0)
    found = sizing(robot("xia2019"), PAPER_MOTION, dwell=0.5)
    saved = json.loads(target.read_text())
    assert saved["holds"] and saved["cycle"]["dwell"] == 0.5
    for name, drive in found.drives.items():
        assert_close(saved["drives"][name]["demand"]["average_torque"], drive.demand.average_torque)
        assert saved["drives"][name]["verdict"] == "holds" and saved["drives"][name]["life_h"] is None
    assert "Tightest is joint2 by its repeated peak torque" in text and " of 60 N m at 0." in text
    assert "momentary peak torque, average speed, maximum speed, life, rated torque, rated speed" in text


def test_a_drive_that_is_too_small_is_named_and_exits_with_3(tmp_path: Path):
    rated = drive_file(tmp_path, "{repeated_peak_torque: 20, average_torque: 34}")
    text = checked("xia2019", *MOTION, "--drives", rated, status=3)
    assert "Tightest is joint2 by its repeated peak torque" in text and "fails" in text and "holds" in text
    assert "joint2 fails by its average torque, too" in text and "joint3 fails by its repeated peak torque, too" in text
    assert "above its repeated peak torque" in text


def test_a_motion_from_a_file_is_the_motion_itself(tmp_path: Path):
    times = np.linspace(0.0, 1.0, 201)
    names = robot("xia2019").joints
    head = ",".join(["t", *(f"{name} [rad]" for name in reversed(names))])
    samples = np.c_[times, PAPER_MOTION(times).q[:, ::-1]]
    np.savetxt(tmp_path / "c.csv", samples, delimiter=",", header=head, comments="")
    target = tmp_path / "check.json"
    text = checked("xia2019", str(tmp_path / "c.csv"), "--json", str(target), status=0)
    assert "Nothing is stated" in text
    found = sizing(robot("xia2019"), PAPER_MOTION)
    for name, drive in json.loads(target.read_text())["drives"].items():
        # smoothing to 10 Hz takes a little off what moves within 1 s
        assert_close(drive["demand"]["average_torque"], found.drives[name].demand.average_torque, 0.05)


@pytest.mark.parametrize("rated", [True, False])
def test_the_picture_is_saved(tmp_path: Path, rated: bool):
    target = tmp_path / "check.png"
    told = drive_file(tmp_path, "{repeated_peak_torque: 20, rated_torque: 9, rated_speed: 209}")
    options = ["--drives", told] if rated else []
    checked("xia2019", *MOTION, *options, "--plot", str(target), status=3 if rated else 0)
    image = imread(target)
    assert image.shape[0] > 400 and image.shape[1] > 800 and image[..., :3].std() > 0.05


def test_an_average_stands_on_the_side_of_the_torques_of_motion():
    """At its end a motion may creep back, with a torque that holds."""
    arm = rated_arm()
    axes = sizing(arm, PAPER_MOTION).plot().axes
    assert len({(axis.get_subplotspec().rowspan.start, axis.get_subplotspec().colspan.start) for axis in axes}) == 6
    for axis in axes:
        gear = np.asarray(next(line for line in axis.lines if line.get_label() == "what the gear exerts").get_ydata())
        (average,) = next(line for line in axis.lines if line.get_label() == "gear, average").get_ydata()
        assert average > 0.0 or np.nanmin(gear) < 0.0
        assert average * (np.nanmax(gear) + np.nanmin(gear)) >= 0.0


def test_the_picture_explains_what_is_in_it_and_nothing_else():
    explained = [{text.get_text() for text in sizing(arm, PAPER_MOTION).plot().legends[0].get_texts()}
                 for arm in (robot("xia2019"), rated_arm())]  # fmt: skip
    curves = {"what the gear exerts", "what the motor exerts", "gear, average"}
    assert explained[0] == curves
    assert explained[1] == curves | {"gear, rated", "zone of averages", "zone of starts and stops", "beyond a limit"}


def test_a_joints_name_and_its_margin_do_not_cover_each_other_however_long(tmp_path: Path):
    long = '"left_shoulder_pitch_and_roll_joint_'
    (tmp_path / "arm.urdf").write_text(XIA2019_URDF.read_text(encoding="utf-8").replace('"joint', long))
    arm = cutpoint.load(tmp_path / "arm.urdf")
    arm = arm.with_drives(dict(zip(arm.joints, rated_arm().drives.values(), strict=True)))
    figure = sizing(arm, PAPER_MOTION).plot()
    figure.canvas.draw()
    for axes in figure.axes:
        texts = axes.findobj(lambda each: isinstance(each, Text) and long[1:-1] in each.get_text())
        margins = axes.findobj(lambda each: isinstance(each, Text) and each.get_text().startswith("margin"))
        (name,), (margin,) = ([each.get_tightbbox() for each in found] for found in (texts, margins))
        assert name.y0 >= margin.y1 or name.x1 < margin.x0 or "\n" in texts[0].get_text()
        assert name.x1 < axes.bbox.x1 + 0.1 * figure.dpi


@pytest.mark.parametrize("share", [0.2, 0.8])
def test_what_names_a_zone_does_not_cover_the_average_and_nothing_covers_it(share: float):
    asked = spin(brake(), Polynomial(1.0, 2.0)).demand
    rated = Ratings(average_torque=asked.average_torque * 0.97, average_speed=asked.mean_motor_speed / share)
    figure = sizing(brake(ratings=rated), Polynomial(1.0, 2.0)).plot()
    figure.canvas.draw()
    (axes,) = figure.axes
    (name,) = (text for text in axes.texts if text.get_text().startswith("average"))
    mark = next(line for line in axes.lines if line.get_label() == "gear, average")
    assert not name.get_window_extent().overlaps(mark.get_window_extent())
    assert name.zorder > max(line.zorder for line in axes.lines)


def test_every_mark_stands_within_its_panel_also_where_the_drive_only_brakes():
    lowered = cycloid(start=np.radians([0, 60, 60, 0, 0, 0]), end=np.radians([0, 0, 0, 90, 60, 90]), duration=1.0)
    found = sizing(rated_arm(average_torque=5.0, repeated_peak_torque=10.0), lowered)
    for axes in found.plot().axes:
        for mark in (line for line in axes.lines if line.get_marker() in ("o", "+")):
            (x,), (y,) = (np.asarray(data) for data in mark.get_data())
            (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
            assert left <= x <= right and low <= y <= high
    assert {"joint2", "joint3"} <= {name for name, drive in found.drives.items() if drive.failures}


def test_the_command_finds_the_shortest_time_and_checks_it(tmp_path: Path):
    drives, target = tmp_path / "arm.drives.yaml", tmp_path / "numbers.json"
    arm = rated_arm(average_torque=49.0, repeated_peak_torque=82.0)
    cutpoint.formats.save_drives(drives, arm.drives)
    found = fastest(arm, PAPER_MOTION)
    command = [str(XIA2019_URDF), "--drives", str(drives), *MOTION[:3], "--fastest", "--json", str(target)]
    told = checked(*command, status=0)
    assert json.loads(target.read_text())["cycle"]["duration"] == pytest.approx(found.duration, rel=1e-12)
    assert f"{found.duration:.4g} s is the shortest time: in less a limit would be broken." in told
    assert "what drives do in a motion of 2.5 s" in checked(*command[:3], *MOTION[:3], "--duration", "2.5", status=0)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["xia2019"], r"a motion is needed"),
        (["xia2019", "a.csv", *MOTION], r"is already a motion"),
        (["xia2019", "missing.csv"], r"'missing.csv' does not exist"),
        (["xia2019", *MOTION, "--json", "x.txt"], r"--json 'x.txt' must end in .json"),
        (["xia2019", *MOTION, "--plot", "no/x.png"], r"folder 'no' does not exist"),
    ],
)
def test_wrong_commands_say_what_is_wanted(arguments: list[str], told: str):
    result = CliRunner().invoke(app, ["check", *arguments])
    assert isinstance(result.exception, InputError)
    with pytest.raises(InputError, match=told):
        raise result.exception


def test_play_is_left_out_and_said_to_be():
    arm = robot("linear")
    loose = arm.with_drives(
        {name: replace(drive, compliance=Backlash(drive.compliance, 1e-3)) for name, drive in arm.drives.items()}
    )
    found, without = (sizing(each, PAPER_MOTION) for each in (loose, arm))
    assert np.array_equal(found.load.motor_torque, without.load.motor_torque)
    assert [words for words in sentences(found) if words not in [*sentences(without)]] == [
        f"Not counted at {', '.join(arm.joints)}: the play, which a motor crosses in the time that it takes."
    ]

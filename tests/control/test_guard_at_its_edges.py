"""Inputs and outputs that a guard passes in single samples, the sensors that it watches, and what it refuses."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from faults import Corrupted
from law_library import LAWS, elbow, law
from test_guard import LIMIT, MOVE, PERIOD, WHILE, assert_reacts, guarded

from cutpoint import InputError, Limits, Robot, Sensors, simulate
from cutpoint.control import PD, DisturbanceObserver, Fault, Feedforward, Guard, Measurement, Reference, SpeedFilter
from cutpoint.control.law import needs_of
from cutpoint.control.wrappers.guard import SEVERITY
from cutpoint.scalars import leaves, rebuild, where
from cutpoint.trajectories import cycloid


def told_by(m: Measurement, quantity: str, value: float) -> Measurement:
    return m._replace(**{quantity: value if quantity == "time" else np.array([0.1, value])})


ODD = [(q, x) for q in ("q", "v", "theta", "theta_dot", "time") for x in (np.nan, np.inf, -np.inf, 1e300)]


@pytest.mark.parametrize("name", LAWS)
def test_no_law_lets_a_number_that_is_not_finite_pass_the_guard_or_stay_in_its_memory(name):
    guard = guarded(law(name), torque_limit=LIMIT / 4)
    for quantity, value in ODD:
        rng, memory, told = np.random.default_rng(3), guard.start(), []
        for k in range(5):
            q, v, e = 0.3 * rng.normal(size=(3, 2))
            m = Measurement(PERIOD * k, PERIOD, q, v, q + 1e-3 * e, v)
            r = Reference(q, *rng.normal(size=(4, 2)), q, v)
            memory, command = guard.step(memory, told_by(m, quantity, value) if k in (2, 3) else m, r)
            told.append(np.array(command.torque, float))
            numbers = [*command.torque, *command.theta, *command.theta_dot, *np.atleast_1d(command.feedforward)]
            assert np.isfinite(np.array(numbers, float)).all()
            assert np.isfinite(np.array(leaves(memory.inner), float)).all()
            matters = quantity in (*needs_of(guard), "time")
            assert command.fault == (Fault.MEASUREMENT if matters and k > 1 else 0)
        assert (np.abs(told) <= LIMIT / 4).all()
        assert np.array_equal(told[2], told[1]) or not matters


class Silent:
    """A law of a user's own that does not say what it needs, with a whole number in its memory."""

    def start(self) -> Any:
        return [0, 0.0]

    def step(self, memory: Any, m: Measurement, r: Reference) -> Any:
        before = where(memory[0] > 0, memory[1], m.q[0])
        return [1, m.q[0]], 9.0 * (r.q - m.q) - (m.q - before)


@pytest.mark.parametrize("around", [lambda x: x, lambda x: DisturbanceObserver(elbow(), x, 1.0), SpeedFilter])
def test_a_law_that_does_not_say_what_it_needs_may_need_all(around):
    guard = guarded(around(PD([9.0] * 2, [1.0] * 2) + Silent()))
    for quantity in ("q", "theta"):
        memory, _ = guard.step(guard.start(), *rest())
        m, r = rest(PERIOD)
        assert guard.step(memory, told_by(m, quantity, np.nan), r)[1].fault == Fault.MEASUREMENT


def test_a_speed_filter_needs_positions_for_the_speeds_that_its_law_reads():
    assert needs_of(SpeedFilter(PD([9.0] * 2, [1.0] * 2, side="motor"))) == ("theta",)
    assert needs_of(SpeedFilter(PD([9.0] * 2, [1.0] * 2, side="link"))) == ("q",)


def test_an_observer_around_a_guard_corrects_nothing_after_its_fault():
    inner = guarded(PD([900.0] * 2, [30.0] * 2), reactions={"speed": "stop"}, speed_limit=0.5)
    log = simulate(elbow(), DisturbanceObserver(elbow(), inner, 20.0), cycloid([0.8, -0.6], 0.8))
    at = int((log["fault"] > 0).argmax())
    assert at and log["command_torque"][1:at].any(axis=1).all()
    assert not log["command_torque"][at:].any()


@pytest.mark.parametrize("inner", [Silent(), PD([9.0] * 2, [1.0] * 2)])
def test_guards_around_guards_step_in_python(inner):
    guard = guarded(guarded(inner))
    _, command = guard.step(guard.start(), *rest())
    assert np.isfinite(np.array(command.torque, float)).all() and command.fault == 0
    log = simulate(elbow(), guard, duration=0.01)
    assert (log["fault"] == 0).all()


def test_a_fault_in_the_first_sample_holds_no_torque_at_all():
    log = simulate(elbow(), Corrupted(guarded(law("PD")), "theta", np.nan, -1.0, 1e-4), MOVE, duration=0.01)
    assert_reacts(log, Fault.MEASUREMENT, "hold", first=0)


def test_a_reference_of_motors_that_is_not_finite_is_a_fault_of_the_command():
    class Lost(PD):
        makes_motor_reference = True

        def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
            after, command = super().step(memory, measurement, reference)
            return after, command._replace(theta=command.torque * np.nan, theta_dot=command.torque * 0.0)

    _, command = (guard := guarded(Lost([9.0] * 2, [1.0] * 2))).step(guard.start(), *rest())
    assert np.isfinite(np.array(command.theta, float)).all()
    assert command.fault == Fault.COMMAND


def rest(time: float = 0.0) -> tuple[Measurement, Reference]:
    return Measurement(time, PERIOD, *np.zeros((4, 2))), Reference(*np.zeros((7, 2)))


@pytest.mark.parametrize(
    ("periods", "fault"),
    [(0.49, Fault.STALE), (0.51, Fault.NONE), (1.49, Fault.NONE), (1.51, Fault.DEADLINE), (-1.0, Fault.STALE)],
)
def test_a_stamp_may_come_half_a_period_early_or_late(periods, fault):
    guard = guarded(PD([9.0] * 2, [1.0] * 2))
    memory, _ = guard.step(guard.start(), *rest(0.3))
    after, command = guard.step(memory, *rest(0.3 + periods * PERIOD))
    assert command.fault == fault
    assert after.severity == {Fault.NONE: 0, Fault.STALE: 1, Fault.DEADLINE: 2}[fault]


@pytest.mark.parametrize("reaction", ["hold", "ramp", "stop"])
@pytest.mark.parametrize("filled", [0.0, np.nan])
def test_a_memory_that_was_never_started_is_a_fault(filled, reaction):
    """As of zeros, which a C program may begin with: without torque, and without a word of it, the arm would fall.

    Memory that was erased, or marked as unused, has all bits set: NaN.
    """
    guard = guarded(law("PID") + Feedforward(elbow()), reactions={"memory": reaction})
    for time in (PERIOD, 5.0):
        memory = rebuild(guard.start(), iter([filled] * len(leaves(guard.start()))))
        for k in range(3):
            memory, command = guard.step(memory, *rest(time + k * PERIOD))
            assert command.fault == Fault.MEMORY
            assert memory.severity >= SEVERITY[reaction] and not np.any(command.torque)
            assert not np.any([*command.theta, *command.theta_dot, *command.feedforward])


def test_a_sensor_that_the_law_does_not_need_is_no_fault_and_changes_nothing():
    clean = simulate(elbow(), guarded(law("PD")), MOVE, duration=0.05)
    blind = simulate(elbow(), guarded(law("PD")), MOVE, duration=0.05, sensors=Sensors(sides="motor"))
    broken = simulate(elbow(), Corrupted(guarded(law("PD")), "q", np.nan, **WHILE), MOVE, duration=0.05)
    for log in (clean, blind, broken):
        assert not log["fault"].any()
        assert np.array_equal(log["command_torque"], clean["command_torque"])


def test_without_link_encoders_positions_are_watched_on_the_motors():
    guard = guarded(law("PD"), upper=[0.004, 2.0])
    log = simulate(elbow(), guard, MOVE, duration=0.1, sensors=Sensors(sides="motor"))
    beyond = int((log["measured_theta"][:, 0] > 0.004).argmax())
    assert beyond > 0
    assert np.array_equal(log["fault"].ravel(), np.where(np.arange(101) < beyond, 0, Fault.POSITION))


def test_limits_are_the_tighter_ones_of_joint_and_drive():
    told = [Limits(-2.0, 1.0, 3.0, 40.0), Limits(velocity=0.0, effort=0.0)]  # a file's zeros say nothing
    own = [Limits(-1.0, 2.0, 4.0, 30.0), Limits(-0.5, math.inf, 5.0, 60.0)]
    limited = elbow_with(told, own)
    guard = Guard(limited, law("PD"))
    assert [*guard.lower] == [-1.0, -0.5] and [*guard.upper] == [1.0, math.inf]
    assert [*guard.speed_limit] == [3.0, 5.0] and [*guard.torque_limit] == [30.0, 60.0]
    _, command = guard.step(guard.start(), rest()[0]._replace(q=np.array([0.0, -0.6])), rest()[1])
    assert command.fault == Fault.POSITION
    with pytest.raises(InputError, match=r"Guard: lower 1.5 of 'shoulder' must not exceed upper, 1.0"):
        Guard(limited, law("PD"), lower=[1.5, -0.5])


def elbow_with(told: list[Limits], own: list[Limits]) -> Robot:
    """The arm with limits that its robot file and its drives state."""
    arm = elbow()
    bodies = [replace(b, joint=replace(b.joint, limits=x)) for b, x in zip(arm.mechanism.bodies, told, strict=True)]
    drives = {name: replace(d, limits=x) for (name, d), x in zip(arm.drives.items(), own, strict=True)}
    return Robot(replace(arm.mechanism, bodies=tuple(bodies)), drives)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"reactions": {"sped": "stop"}}, r"no fault is named 'sped'.*there are: .*'speed'"),
        ({"reactions": {"speed": "halt"}}, r"no reaction is named 'halt'.*there are: 'hold', 'ramp', 'stop'"),
        ({"ramp_time": 0.0}, r"Guard: ramp_time 0.0 s must be positive"),
        (
            {"torque_limit": [1.0] * 3},
            r"Guard: torque_limit \[1.0, 1.0, 1.0\] must be numbers, one or one for each of 2 drives",
        ),
        ({"upper": np.nan}, r"Guard: upper nan must be numbers"),
        ({"torque_limit": -1.0}, r"Guard: torque_limit -1.0 of 'shoulder' must be positive"),
        ({"ramp_time": np.nan}, r"Guard: ramp_time nan s must be positive"),
        ({"lower": 1.0, "upper": -1.0}, r"Guard: lower .*upper"),
    ],
)
def test_a_guard_that_makes_no_sense_is_refused(options, message):
    with pytest.raises(InputError, match=message):
        Guard(elbow(), law("PD"), **options)


def test_position_limits_in_degrees_are_refused_where_the_robots_own_show_it() -> None:
    stated = elbow_with([Limits(-3.0, 3.0), Limits(-2.0, 2.5)], [Limits()] * 2)
    with pytest.raises(InputError, match=r"lower -170 and upper 170 of 'shoulder' look like degrees; .* \[-3, 3\] rad"):
        Guard(stated, law("PD"), lower=-170.0, upper=170.0)
    for lower, upper in ((-2.0, 2.0), (-4.5, 4.5)):
        Guard(stated, law("PD"), lower=lower, upper=upper)
    Guard(elbow_with([Limits()] * 2, [Limits()] * 2), law("PD"), lower=-170.0, upper=170.0)  # many turns

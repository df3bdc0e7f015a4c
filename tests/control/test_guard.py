"""The guard around every law: each fault's stated reaction, latched, within limits, and never a NaN."""

from typing import Any

import numpy as np
import pytest
from faults import Corrupted, Mad
from law_library import LAWS, elbow, law

from cutpoint import InputError, Log, Sensors, simulate
from cutpoint.control import PD, Fault, Guard, Measurement, Reference
from cutpoint.control.law import needs_of
from cutpoint.scalars import leaves
from cutpoint.trajectories import cycloid
from robot_library import Array, assert_close

PERIOD, RAMP = 1e-3, 0.02
FROM, UNTIL = 0.0395, 0.0445  # five samples, 40 to 44
LIMIT = np.array([22.0, 1.2])
MOVE = cycloid(np.array([0.8, -0.6]), 0.8)
WHILE = {"start_at": FROM, "end_at": UNTIL}


def guarded(inner: Any, **options: Any) -> Guard:
    limits = {"torque_limit": LIMIT, "speed_limit": 20.0, "lower": -2.0, "upper": 2.0}
    return Guard(inner, elbow(), ramp_time=RAMP, **{**limits, **options})


def share_after(reaction: str, samples: Array) -> Array:
    """What is left of the last safe torque, samples after the fault was found (0: when it is)."""
    ramp = np.maximum(1 - (samples + 1) * PERIOD / RAMP, 0)
    return {"hold": np.ones(len(samples)), "ramp": ramp, "stop": np.zeros(len(samples))}[reaction]


def assert_reacts(log: Log, fault: Fault, reaction: str, first: int = 40) -> None:
    told, found = log["command_torque"], log["fault"].ravel()
    assert np.array_equal(found, np.where(np.arange(len(found)) < first, 0, fault))
    kept = told[first - 1] if first else np.zeros(2)
    assert_close(told[first:], share_after(reaction, np.arange(len(found) - first))[:, None] * kept, 1e-13, scale=1.0)
    assert (np.abs(told) <= LIMIT).all()
    for channel in ("command_torque", "motor_reference", "motor_speed_reference", "feedforward_torque"):
        assert np.isfinite(log[channel]).all()


FAULTS: dict[str, tuple[Fault, str, dict[str, Any]]] = {
    "q is NaN": (Fault.MEASUREMENT, "hold", {"quantity": "q", "shift": np.nan}),
    "one v is inf": (Fault.MEASUREMENT, "hold", {"quantity": "v", "shift": np.inf, "joint": 1}),
    "one theta is -inf": (Fault.MEASUREMENT, "hold", {"quantity": "theta", "shift": -np.inf, "joint": 0}),
    "theta_dot is NaN": (Fault.MEASUREMENT, "hold", {"quantity": "theta_dot", "shift": np.nan}),
    "time is NaN": (Fault.MEASUREMENT, "hold", {"quantity": "time", "shift": np.nan}),
    "a link too fast": (Fault.SPEED, "ramp", {"quantity": "v", "shift": -20.5, "joint": 1}),
    "a motor too fast": (Fault.SPEED, "ramp", {"quantity": "theta_dot", "shift": 20.5, "joint": 0}),
    "a link too high": (Fault.POSITION, "ramp", {"quantity": "q", "shift": 2.5, "joint": 1}),
    "a link too low": (Fault.POSITION, "ramp", {"quantity": "q", "shift": -2.5, "joint": 0}),
    "late": (Fault.DEADLINE, "ramp", {"quantity": "time", "shift": 0.6e-3}),
}


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_has_its_reaction_in_the_loop(name):
    fault, reaction, corruption = FAULTS[name]
    log = simulate(elbow(), Corrupted(guarded(law("full state feedback")), **corruption, **WHILE), MOVE, duration=0.1)
    assert_reacts(log, fault, reaction)


@pytest.mark.parametrize("name", LAWS)
def test_every_law_holds_when_a_sensor_fails_that_it_needs_and_stops_when_told_so(name):
    for quantity in needs_of(law(name))[:2]:
        broken = {"quantity": quantity, "shift": np.nan, **WHILE}
        held = simulate(elbow(), Corrupted(guarded(law(name)), **broken), MOVE, duration=0.1)
        assert_reacts(held, Fault.MEASUREMENT, "hold")
    stopping = guarded(law(name), reactions={"measurement": "stop"})
    log = simulate(elbow(), Corrupted(stopping, **broken), MOVE, duration=0.06)
    assert_reacts(log, Fault.MEASUREMENT, "stop")


@pytest.mark.parametrize("name", LAWS)
def test_every_law_that_goes_mad_is_ramped_down(name):
    log = simulate(elbow(), guarded(Mad(law(name), np.nan, **WHILE)), MOVE, duration=0.1)
    assert_reacts(log, Fault.COMMAND, "ramp")


def test_a_torque_beyond_its_limit_is_clipped_and_is_no_fault():
    log = simulate(elbow(), guarded(Mad(law("PD"), 1e6, **WHILE)), MOVE, duration=0.05)
    assert not log["fault"].any()
    assert np.array_equal(log["command_torque"][40:45], np.tile(LIMIT, (5, 1)))


def test_a_clock_that_stands_still_is_held_and_its_return_is_a_later_and_worse_fault():
    """time * 0 + 0.039: the stamp of the sample before; then the clock is five periods late."""
    frozen = Corrupted(guarded(law("PD")), "time", 0.039, FROM, UNTIL, scale=0.0)
    log = simulate(elbow(), frozen, MOVE, duration=0.1)
    told, last = log["command_torque"], log["command_torque"][39]
    assert np.array_equal(log["fault"].ravel(), np.where(np.arange(101) < 40, 0, Fault.STALE))
    assert_close(told[40:45], np.tile(last, (5, 1)), 1e-15)
    assert_close(told[45:], share_after("ramp", np.arange(56))[:, None] * last, 1e-13, scale=1.0)


def test_a_later_fault_only_makes_the_reaction_more_severe():
    """Stop, then a fault to be ramped, then one to be held: it stays stopped.  The other way round it escalates."""
    reactions = {"measurement": "hold", "speed": "ramp", "position": "stop"}
    up = Corrupted(guarded(law("full state feedback"), reactions=reactions), "q", np.nan, 0.0195, 0.0205)
    up = Corrupted(Corrupted(up, "v", 30.0, 0.0295, 0.0305), "q", 3.0, 0.0345, 0.0355)
    log = simulate(elbow(), up, MOVE, duration=0.05)
    last, told = log["command_torque"][19], log["command_torque"]
    assert np.array_equal(log["fault"].ravel(), np.where(np.arange(51) < 20, 0, Fault.MEASUREMENT))
    assert_close(told[20:30], np.tile(last, (10, 1)), 1e-15)
    assert_close(told[30:35], share_after("ramp", np.arange(5))[:, None] * last, 1e-13)
    assert not told[35:].any()
    down = Corrupted(guarded(law("full state feedback"), reactions=reactions), "q", 3.0, 0.0195, 0.0205)
    down = Corrupted(Corrupted(down, "v", 30.0, 0.0295, 0.0305), "q", np.nan, 0.0345, 0.0355)
    assert not simulate(elbow(), down, MOVE, duration=0.05)["command_torque"][20:].any()


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


def rest() -> tuple[Measurement, Reference]:
    return Measurement(0.0, PERIOD, *np.zeros((4, 2))), Reference(*np.zeros((7, 2)))


def test_a_sensor_that_the_law_does_not_need_is_no_fault_and_changes_nothing():
    clean = simulate(elbow(), guarded(law("PD")), MOVE, duration=0.05)
    blind = simulate(elbow(), guarded(law("PD")), MOVE, duration=0.05, sensors=Sensors(sides="motor"))
    broken = simulate(elbow(), Corrupted(guarded(law("PD")), "q", np.nan, **WHILE), MOVE, duration=0.05)
    for log in (clean, blind, broken):
        assert not log["fault"].any()
        assert np.array_equal(log["command_torque"], clean["command_torque"])


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
        Guard(law("PD"), elbow(), **options)

"""The guard around every law: each fault's stated reaction, latched, within limits, and never a NaN."""

from typing import Any

import numpy as np
import pytest
from faults import Corrupted, Mad
from law_library import LAWS, elbow, law

from cutpoint import Log, Sensors, simulate
from cutpoint.control import Fault, Feedforward, Guard
from cutpoint.control.law import needs_of
from cutpoint.trajectories import cycloid
from robot_library import Array, assert_close

PERIOD, RAMP = 1e-3, 0.02
FROM, UNTIL = 0.0395, 0.0445  # five samples, 40 to 44
LIMIT = np.array([22.0, 1.2])
MOVE = cycloid(np.array([0.8, -0.6]), 0.8)
WHILE = {"start_at": FROM, "end_at": UNTIL}


def guarded(inner: Any, **options: Any) -> Guard:
    limits = {"torque_limit": LIMIT, "speed_limit": 20.0, "lower": -2.0, "upper": 2.0}
    return Guard(elbow(), inner, ramp_time=RAMP, **{**limits, **options})


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


def test_a_guarded_law_that_reads_no_sensor_needs_none():
    made = Guard(elbow(), Feedforward(elbow(), "gravity"))
    log = simulate(elbow(), made, MOVE, duration=0.05, sensors=Sensors(sides="motor"))
    assert not log["fault"].any() and np.abs(log["motor_torque"]).max() > 0


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


def test_of_guards_around_guards_the_fault_that_came_first_is_told_and_each_reacts_to_its_own():
    """Sample 20: the inner one sees a speed.  Sample 30: the outer one misses a measurement.  Then the other way."""
    speed, theta = ("v", 30.0, 0.0195, 0.0205), ("theta", np.nan, 0.0295, 0.0305)
    log = simulate(elbow(), Corrupted(guarded(Corrupted(guarded(law("PD")), *speed)), *theta), MOVE, duration=0.05)
    found, told = log["fault"].ravel(), log["command_torque"]
    assert np.array_equal(found, np.where(np.arange(51) < 20, 0, Fault.SPEED))
    assert_close(told[20:30], share_after("ramp", np.arange(10))[:, None] * told[19], 1e-13)
    assert_close(told[30:], np.tile(told[29], (21, 1)), 1e-15)
    early, late = ("theta", np.nan, 0.0195, 0.0205), ("v", 30.0, 0.0295, 0.0305)
    log = simulate(elbow(), Corrupted(guarded(Corrupted(guarded(law("PD")), *late)), *early), MOVE, duration=0.05)
    assert np.array_equal(log["fault"].ravel(), np.where(np.arange(51) < 20, 0, Fault.MEASUREMENT))
    assert_close(log["command_torque"][20:], np.tile(log["command_torque"][19], (31, 1)), 1e-15)


def test_of_guards_side_by_side_the_fault_that_came_first_is_told():
    """A command that is mad has the greatest number, and is found last."""
    early = Corrupted(guarded(law("PD")), "theta", np.nan, 0.0195, 0.0205)
    late = guarded(Mad(law("PD"), np.nan, 0.0295, 0.0305))
    for both in (early + late, late + early):
        found = simulate(elbow(), both, MOVE, duration=0.05)["fault"].ravel()
        assert np.array_equal(found, np.where(np.arange(51) < 20, 0, Fault.MEASUREMENT))

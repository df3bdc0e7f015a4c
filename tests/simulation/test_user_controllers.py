"""Controllers that users write: compiled into the loop or, where they cannot be, called back, to the same result."""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import cutpoint
from cutpoint import InputError, Log, simulate
from cutpoint.control import PD, Command, Feedforward
from cutpoint.simulation import UntracedControllerWarning
from cutpoint.trajectories import cycloid
from robot_library import assert_close, frictionless, robot

MOVE = cycloid(np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5]), 0.5)
CHANNELS = ("q", "theta", "command_torque", "motor_torque", "measured_q")


@dataclass
class PID:
    """Remembers the integral of the error, a record of its own making."""

    kp: float = 800.0
    ki: float = 300.0
    kd: float = 30.0

    def start(self) -> dict[str, Any]:
        return {"integral": np.zeros(6), "samples": 0}

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        error = r.theta - m.theta
        integral = memory["integral"] + error * m.period
        torque = self.kp * error + self.ki * integral + self.kd * (r.theta_dot - m.theta_dot)
        return {"integral": integral, "samples": memory["samples"] + 1}, torque


class Branching(PID):
    """The same law, with an `if` that only a number can answer."""

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        if m.q[0] > 1e3:
            raise AssertionError("never so far")
        return super().step(memory, m, r)


def run(controller: Any, **options: Any) -> Log:
    return simulate(frictionless(robot("xia2019")), controller, MOVE, duration=0.05, **options)


@pytest.mark.parametrize("accuracy", ["standard", "reference"])
def test_a_law_that_cannot_be_traced_gives_the_same_log_with_one_warning(accuracy):
    traced = run(PID(), accuracy=accuracy)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        called = run(Branching(), accuracy=accuracy)
    assert [w.category for w in caught] == [UntracedControllerWarning]
    assert caught[0].filename == __file__
    assert "Branching runs as a Python callback" in str(caught[0].message)
    for channel in CHANNELS:
        # the adaptive integrator's steps are chosen by the last digit, too
        assert_close(called[channel], traced[channel], 1e-12 if accuracy == "standard" else 1e-8)


def test_a_callback_added_to_laws_of_the_package_gives_the_same_log():
    ours = frictionless(robot("xia2019"))
    traced = run(Feedforward(ours) + PID())
    with pytest.warns(UntracedControllerWarning):
        called = run(Feedforward(ours) + Branching())
    assert_close(called["q"], traced["q"], 1e-12)
    assert_close(called["feedforward_torque"], traced["feedforward_torque"], 1e-12)


def test_a_plain_function_is_a_controller():
    def pd(memory: Any, m: Any, r: Any) -> Any:
        return memory, 500.0 * (r.theta - m.theta) + 20.0 * (r.theta_dot - m.theta_dot)

    assert_close(run(pd)["q"], run(PD([500.0] * 6, [20.0] * 6))["q"], 1e-12)


def test_branches_are_written_with_where():
    def bang(memory: Any, m: Any, r: Any) -> Any:
        return memory, np.array([cutpoint.where(e > 0, 2.0, -2.0) for e in r.q - m.q])

    log = run(bang)
    error = log["reference_q"] - log["measured_q"]
    assert np.array_equal(log["command_torque"], np.where(error > 0, 2.0, -2.0))


def test_choices_between_arrays_compile_and_are_made_element_by_element():
    def limited(memory: Any, m: Any, r: Any) -> Any:
        pushed = cutpoint.clip(800.0 * (r.theta - m.theta), -20.0, 20.0) - 30.0 * m.theta_dot
        is_slow = np.less(cutpoint.absolute(m.v), 0.1, dtype=object)
        return memory, cutpoint.where(is_slow, pushed, cutpoint.minimum(pushed, 15.0)) + cutpoint.atan2(m.v, 1.0)

    def by_hand(memory: Any, m: Any, r: Any) -> Any:
        pushed = np.clip(800.0 * (r.theta - m.theta), -20.0, 20.0) - 30.0 * m.theta_dot
        return memory, np.where(np.abs(m.v) < 0.1, pushed, np.minimum(pushed, 15.0)) + np.arctan2(m.v, 1.0)

    with warnings.catch_warnings():
        warnings.simplefilter("error", UntracedControllerWarning)
        compiled = run(limited)
    with pytest.warns(UntracedControllerWarning, match="NumPy's clip, maximum, where and sign cannot be compiled"):
        called_back = run(by_hand)
    assert_close(compiled["q"], called_back["q"])


@pytest.mark.parametrize(
    "step, remedy",
    [
        (lambda tau, m: tau.__setitem__(0, m.q[0]), "fill arrays made with dtype=object"),
        (lambda tau, m: tau.__iadd__(m.q), r"into an array of floats: write x = x \+ y"),
    ],
)
def test_arrays_of_floats_that_traced_numbers_are_written_into_are_named(step, remedy):
    def law(memory: Any, m: Any, r: Any) -> Any:
        tau = np.zeros(6)
        step(tau, m)
        return memory, tau

    with pytest.warns(UntracedControllerWarning, match=remedy):
        simulate(robot("xia2019"), law, duration=2e-3)


@pytest.mark.parametrize("reports", [True, False])
def test_a_law_may_report_faults_of_its_own(reports: bool):
    class Watchful:
        reports_faults = reports

        def step(self, memory: Any, m: Any, r: Any) -> Any:
            return memory, Command(
                500.0 * (r.theta - m.theta) - 20.0 * m.theta_dot, fault=cutpoint.where(m.time > 0.0105, 4.0, 0.0)
            )

    log = run(Watchful())
    assert ("fault" in log.channels) == reports
    if reports:
        assert np.array_equal(log["fault"], np.where(log.time > 0.0105, 4.0, 0.0))


def test_a_law_may_make_the_motors_reference_that_the_others_track():
    def ahead(memory: Any, m: Any, r: Any) -> Any:
        return memory, Command(np.zeros(6), 0, r.q + 0.01, r.v)

    class Ahead(cutpoint.control.Law):
        makes_motor_reference = True

        def step(self, memory: Any, m: Any, r: Any) -> Any:
            return ahead(memory, m, r)

    log = run(PD([500.0] * 6, [20.0] * 6) + Ahead())
    assert_close(log["motor_reference"], log["reference_q"] + 0.01, 1e-15, scale=1.0)
    expected = 500.0 * (log["motor_reference"] - log["theta"]) + 20.0 * (log["reference_v"] - log["theta_dot"])
    assert_close(log["command_torque"], expected, 1e-12)


def test_two_makers_of_a_motor_reference_are_refused():
    ours = robot("xia2019")
    with pytest.raises(InputError, match="Feedforward and Feedforward both make a motor reference"):
        Feedforward(ours) + PD([1.0] * 6, [1.0] * 6) + Feedforward(ours)


def test_memory_starts_anew_in_every_run():
    law = PID()
    assert np.array_equal(run(law)["q"], run(law)["q"])


@pytest.mark.parametrize("is_called_back", [False, True])
@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (np.zeros(6), r"\(memory, command\), not an array of shape \(6,\)"),
        (np.zeros(2), r"\(memory, command\), not an array of shape \(2,\)"),
        (Command(np.zeros(6)), r"\(memory, command\), not a Command of 5"),
        (None, r"\(memory, command\), not None"),
        (((), None), r"\(memory, command\) whose torque is 6 numbers, one per drive, or one for all; it is None"),
        (((), np.zeros(3)), r"\(memory, command\) whose torque is 6 numbers, .* it is an array of shape \(3,\)"),
        (((), ["a"] * 6), r"\(memory, command\) whose torque is 6 numbers"),
        (((), Command(0.0, theta=[0.0] * 5)), r"\(memory, command\) whose theta is 6 numbers, .* it is a list of 5"),
    ],
)
def test_a_step_that_returns_something_else_is_told_what_it_must(returned, message, is_called_back):
    def mine(memory: Any, m: Any, r: Any) -> Any:
        return returned if not is_called_back or m.q[0] < 1e3 else None

    with warnings.catch_warnings(), pytest.raises(InputError, match=f"controller mine: step must return {message}"):
        warnings.simplefilter("ignore", UntracedControllerWarning)
        run(mine)


def test_a_memory_that_grows_is_refused():
    def growing(memory: Any, m: Any, r: Any) -> Any:
        return (*memory, 1.0), np.zeros(6)

    with pytest.raises(InputError, match=r"growing: step must return as many .* as start\(\) gave, 0; it returned 1"):
        run(growing)


def test_one_number_is_the_torque_of_all_drives():
    assert np.array_equal(run(lambda s, m, r: (s, 2))["q"], run(lambda s, m, r: (s, np.full(6, 2.0)))["q"])


def test_a_dict_of_memory_may_come_back_in_any_order():
    class Ordered(PID):
        def step(self, memory: Any, m: Any, r: Any) -> Any:
            after, torque = super().step(memory, m, r)
            return dict(sorted(after.items(), reverse=self.turned)), torque

    logs = []
    for Ordered.turned in (False, True):
        logs.append(run(Ordered()))
    np.testing.assert_array_equal(logs[0]["command_torque"], logs[1]["command_torque"])
    np.testing.assert_array_equal(logs[0]["command_torque"], run(PID())["command_torque"])


def test_memory_with_other_keys_is_called_back():
    class Renaming:
        def start(self) -> Any:
            return {"a": 0.0, "b": 10.0}

        def step(self, memory: Any, m: Any, r: Any) -> Any:
            found = memory.get("a", memory.get("c"))
            return {"b": memory["b"], "c": found + 1}, found

    with pytest.warns(UntracedControllerWarning, match="Renaming returns memory with other keys than start"):
        log = run(Renaming(), substeps=4)
    np.testing.assert_array_equal(log["command_torque"][:, 0], np.arange(len(log.time)))


def test_a_law_may_hold_an_array_of_no_axes():
    class Constant:
        def __init__(self) -> None:
            self.torque = np.array(3.0)

        def step(self, memory: Any, m: Any, r: Any) -> Any:
            return memory, np.ones(6) * self.torque

    assert (run(Constant())["command_torque"] == 3.0).all()


class Failing(Branching):
    """Divides by zero after 10 ms."""

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return super().step(memory, m, r) if m.time < 0.0095 else 1 / 0


def test_an_error_in_a_step_says_when_it_happened():
    with (
        pytest.warns(UntracedControllerWarning, match="controller Failing"),
        pytest.raises(ZeroDivisionError) as failed,
    ):
        simulate(robot("xia2019"), Failing(), MOVE)
    assert failed.value.__notes__ == ["in the step of controller Failing at t = 0.01 s"]

"""Laws that users write: each run has the numbers of today, and state that is not in memory is never frozen."""

import itertools
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from io import StringIO
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import cutpoint
from cutpoint import Log, simulate, simulate_many
from cutpoint.control import PD, Feedforward
from cutpoint.control.own_law import STEPS_TRIED
from cutpoint.definitions import gravity_forces
from cutpoint.simulation import UntracedControllerWarning
from cutpoint.simulation.loop import loop as loops
from cutpoint.trajectories import cycloid
from robot_library import frictionless, robot

MOVE = cycloid(np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5]), 0.5)
SAMPLES = 11

stiffness = 0.0
counted = 0.0


def run(law: Any, **options: Any) -> Log:
    return simulate(frictionless(robot("xia2019")), law, MOVE, duration=0.01, **options)


def called_back(law: Any, **options: Any) -> tuple[Log, str]:
    with pytest.warns(UntracedControllerWarning) as caught:
        log = run(law, **options)
    return log, str(caught[0].message)


class Spring:
    def __init__(self, k: float) -> None:
        self.k = k

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return memory, self.k * (r.theta - m.theta)


def of_attribute() -> tuple[Any, Callable[[float], None]]:
    law = Spring(0.0)
    return law, partial(setattr, law, "k")


def of_closure() -> tuple[Any, Callable[[float], None]]:
    k = 0.0

    def step(memory: Any, m: Any, r: Any) -> Any:
        return memory, k * (r.theta - m.theta)

    def change(new: float) -> None:
        nonlocal k
        k = new

    return step, change


def of_global() -> tuple[Any, Callable[[float], None]]:
    def step(memory: Any, m: Any, r: Any) -> Any:
        return memory, stiffness * (r.theta - m.theta)

    return step, partial(globals().__setitem__, "stiffness")


def of_array() -> tuple[Any, Callable[[float], None]]:
    k = np.zeros(6)

    def step(memory: Any, m: Any, r: Any) -> Any:
        return memory, k * (r.theta - m.theta)

    return step, k.fill


def of_record() -> tuple[Any, Callable[[float], None]]:
    @dataclass
    class Record(Spring):
        k: float = 0.0

    law = Record()
    return law, partial(setattr, law, "k")


@pytest.mark.parametrize("made", [of_attribute, of_closure, of_global, of_array, of_record])
def test_a_run_has_the_numbers_that_the_law_has_then(made):
    law, change = made()
    for k in (300.0, 600.0, 300.0):
        change(k)
        together = simulate_many(frictionless(robot("xia2019")), law, [MOVE], duration=0.01)[0]
        for log in (run(law), together):
            expected = k * (log["motor_reference"] - log["measured_theta"])
            assert np.array_equal(log["command_torque"], expected)


def test_a_law_within_a_sum_has_the_numbers_of_today_too():
    ours, law = frictionless(robot("xia2019")), Spring(300.0)
    both = PD([100.0] * 6, [0.0] * 6) + law
    for law.k in (300.0, 700.0):
        log = simulate(ours, both, MOVE, duration=0.01)
        expected = (100.0 + law.k) * (log["motor_reference"] - log["measured_theta"])
        assert np.allclose(log["command_torque"], expected, rtol=1e-12, atol=1e-15)


def test_equal_laws_are_compiled_once(monkeypatch):
    ours = frictionless(robot("xia2019"))
    first = simulate(ours, Spring(321.0), MOVE, duration=0.01)

    def never(*_: object, **__: object) -> None:
        raise AssertionError("compiled again")

    monkeypatch.setattr(loops, "compile_program", never)
    again = simulate(ours, Spring(321.0), MOVE, duration=0.01)
    assert np.array_equal(again["q"], first["q"])


# state that is not memory


class Counting:
    n = 0

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        self.n += 1
        return memory, np.full(6, float(self.n))


@dataclass
class CountingRecord:
    n: float = 0.0

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        self.n += 1
        return memory, np.full(6, 1.0) * self.n


class Appending:
    def __init__(self) -> None:
        self.seen: list[Any] = []

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        self.seen.append(m.time)
        return memory, np.full(6, float(len(self.seen)))


class Latching:
    """Counts from where it was first told the time."""

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        if not hasattr(self, "started"):
            self.started = m.time - m.period
        return memory, np.full(6, 1.0) * (m.time - self.started) / m.period


class InPlace:
    def __init__(self) -> None:
        self.sum = np.zeros(6)

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        self.sum += (m.time + m.period) / (m.time + m.period)
        return memory, self.sum.copy()


def in_closure() -> Any:
    n = 0

    def step(memory: Any, m: Any, r: Any) -> Any:
        nonlocal n
        n += 1
        return memory, np.full(6, float(n))

    return step


def in_global() -> Any:
    globals()["counted"] = 0.0

    def step(memory: Any, m: Any, r: Any) -> Any:
        global counted
        counted = counted + (m.time + m.period) / (m.time + m.period)
        return memory, np.full(6, 1.0) * counted

    return step


def in_an_iterator() -> Any:
    numbers = itertools.count(1)
    return lambda memory, m, r: (memory, np.full(6, float(next(numbers))))


class Switching:
    """Its memory holds a truth value and a text, which no compiled loop carries on."""

    def start(self) -> Any:
        return {"n": 0.0, "begun": False, "mode": "slow"}

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        n = memory["n"] + (1.0 if memory["begun"] and memory["mode"] == "fast" else 0.0)
        return {"n": n, "begun": True, "mode": "fast"}, np.full(6, 1.0) * (n + 1)


class OfTheClass:
    """Every law of the class counts on."""

    n = 0.0

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        OfTheClass.n += 1.0
        return memory, np.full(6, 1.0) * OfTheClass.n


def in_the_class() -> Any:
    OfTheClass.n = 0.0
    return OfTheClass()


class InANamespace:
    def __init__(self) -> None:
        self.own = SimpleNamespace(n=0.0)

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        self.own.n += (m.time + m.period) / (m.time + m.period)
        return memory, np.full(6, 1.0) * self.own.n


STATEFUL = [
    Counting, CountingRecord, Appending, Latching, InPlace, in_closure, in_global, Switching, in_the_class,
    InANamespace,
]  # fmt: skip


@pytest.mark.parametrize("made", STATEFUL)
def test_state_that_is_not_numbers_in_memory_is_called_back_and_goes_on(made):
    """As if it had never been looked at before the run."""
    log, told = called_back(made())
    assert np.allclose(log["command_torque"][:, 0], np.arange(1, SAMPLES + 1), rtol=1e-9)
    assert "runs as a Python callback" in told


@pytest.mark.parametrize(("made", "name"), [(Counting, "n"), (Appending, "seen"), (Latching, "started")])
def test_the_warning_names_the_state_and_where_it_belongs(made, name):
    _, told = called_back(PD([1.0] * 6, [0.0] * 6) + made())
    assert (
        f"{made.__name__} keeps state in itself ({name}); state can be compiled if it is kept as numbers in the memory"
        in told
    )


def in_a_generator() -> Any:
    numbers = (k for k in range(1, 100))
    return lambda memory, m, r: (memory, np.full(6, float(next(numbers))))


def in_a_file() -> Any:
    lines = StringIO("".join(f"{k}\n" for k in range(1, 100)))
    return lambda memory, m, r: (memory, np.full(6, float(next(lines))))


@pytest.mark.parametrize("made", [in_an_iterator, in_a_generator, in_a_file])
def test_what_moves_on_by_itself_is_neither_frozen_nor_moved_before_the_run(made):
    log, told = called_back(made())
    assert np.array_equal(log["command_torque"][:, 0], np.arange(1.0, SAMPLES + 1.0))
    assert "holds what moves on by itself (" in told


@pytest.mark.parametrize("made", [lambda: bytearray(1), lambda: array("d", [0.0])])
def test_numbers_that_python_packs_are_seen_to_change(made):
    packed = made()

    def step(memory: Any, m: Any, r: Any) -> Any:
        packed[0] += 1
        return memory, np.full(6, float(packed[0]))

    log, told = called_back(step)
    assert np.array_equal(log["command_torque"][:, 0], np.arange(1.0, SAMPLES + 1.0))
    assert "keeps state in itself (packed)" in told


def catching(memory: Any, m: Any, r: Any) -> Any:
    error = r.theta - m.theta
    try:
        if error[0] > 1e-5:
            error = error / 5
    except Exception:
        pass
    return memory, 300.0 * error


def asking_for_kinds(memory: Any, m: Any, r: Any) -> Any:
    return memory, (300.0 if isinstance(m.theta[0], float) else 1.0) * (r.theta - m.theta)


def test_a_law_that_does_otherwise_with_plain_numbers_is_called_back():
    log, told = called_back(asking_for_kinds)
    assert "with plain numbers, but" in told
    error = 1.0 * (log["motor_reference"] - log["measured_theta"])
    assert np.allclose(log["command_torque"], 300.0 * error, rtol=1e-12, atol=1e-15)


def test_a_law_that_catches_what_cannot_be_compiled_is_called_back():
    log, told = called_back(catching)
    assert "catches the error that says it cannot be compiled" in told and "cutpoint.where" in told
    error = 1.0 * (log["motor_reference"] - log["measured_theta"])
    factor = np.where(error[:, :1] > 1e-5, 60.0, 300.0)
    assert np.allclose(log["command_torque"], factor * error, rtol=1e-12, atol=1e-15)


def test_however_late_it_does_otherwise_than_it_was_traced():
    """Steps that are tried before the run are of its first milliseconds."""
    end = 2e-3 * STEPS_TRIED

    def off_in_the_end(memory: Any, m: Any, r: Any) -> Any:
        try:
            if m.time > end:
                return memory, np.zeros(6)
        except Exception:
            pass
        return memory, np.full(6, 3.0)

    with pytest.warns(UntracedControllerWarning, match="catches the error that says"):
        log = simulate(frictionless(robot("xia2019")), off_in_the_end, MOVE, duration=1.5 * end)
    assert np.array_equal(log["command_torque"][:, 0], np.where(log.time > end, 0.0, 3.0))


def test_steps_before_the_run_leave_no_traced_numbers():
    class Keeping:
        last: Any = None

        def step(self, memory: Any, m: Any, r: Any) -> Any:
            if not isinstance(m.theta[0], float):
                type(self).last = m.theta
            return memory, 300.0 * (r.theta - m.theta)

    _, told = called_back(Keeping())
    assert "keeps state in itself" in told and Keeping.last is None


def test_what_a_law_prints_while_it_is_tried_is_seen(capsys):
    """Output is the whole process's: to take it away would take other threads'."""

    def telling(memory: Any, m: Any, r: Any) -> Any:
        print("a step")
        return memory, 300.0 * (r.theta - m.theta)

    run(telling)
    assert capsys.readouterr().out.count("a step\n") >= STEPS_TRIED


def test_a_random_law_draws_anew_at_each_sample():
    class Random:
        def __init__(self) -> None:
            self.source = np.random.default_rng(7)

        def step(self, memory: Any, m: Any, r: Any) -> Any:
            return memory, self.source.normal(size=6)

    log, _ = called_back(Random())
    assert np.array_equal(log["command_torque"], np.random.default_rng(7).normal(size=(SAMPLES, 6)))


def test_laws_with_state_are_refused_where_nothing_can_call_them_back():
    with pytest.raises(cutpoint.errors.TraceError, match="Counting keeps state in itself"):
        run(Counting(), hold=False)
    with pytest.raises(cutpoint.errors.TraceError, match="Counting keeps state in itself"):
        cutpoint.control.slowest_pole(robot("xia2019"), Counting(), np.zeros(6), 1e-3)


# what is pure is compiled: warnings are errors


class Cached(Spring):
    @cached_property
    def gains(self) -> Any:
        return self.k * np.ones(6)

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return memory, self.gains * (r.theta - m.theta)


class WritingOverWhatItIsGiven:
    def start(self) -> Any:
        return np.zeros(6)

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        error = r.theta
        error -= m.theta
        memory += error * m.period
        return memory, 300.0 * error + memory


def test_caches_and_arrays_of_its_own_do_no_harm():
    log = run(Cached(300.0))
    assert np.array_equal(log["command_torque"], 300.0 * (log["motor_reference"] - log["measured_theta"]))
    assert np.isfinite(run(WritingOverWhatItIsGiven())["q"]).all()


def test_a_law_of_the_package_with_another_init_is_the_law_that_it_makes():
    class Soft(PD):
        def __init__(self, k: float) -> None:
            super().__init__(np.full(6, 2 * k), np.full(6, k / 10))

    ours, twin = frictionless(robot("xia2019")), PD([400.0] * 6, [20.0] * 6)
    for mine, theirs in ((Soft(200.0), twin), (Soft(200.0) + Feedforward(ours), twin + Feedforward(ours))):
        assert np.array_equal(run(mine)["q"], run(theirs)["q"])


def test_functions_of_a_robot_are_called_back_and_those_of_definitions_are_compiled():
    ours = frictionless(robot("xia2019"))

    def by_robot(memory: Any, m: Any, r: Any) -> Any:
        return memory, 300.0 * (r.theta - m.theta) + ours.gravity_forces(m.theta)

    def by_definition(memory: Any, m: Any, r: Any) -> Any:
        return memory, 300.0 * (r.theta - m.theta) + np.array(gravity_forces(ours.machine, [*m.theta]))

    log, told = called_back(by_robot)
    assert "functions of cutpoint.definitions with robot.machine" in told and f"({__file__}:" in told
    assert np.allclose(log["command_torque"], run(by_definition)["command_torque"], rtol=1e-12, atol=1e-12)

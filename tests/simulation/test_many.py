"""Many runs at once: each is the run it would be alone, whatever the others are and do."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Log, Motor, Robot, Sensors, SimulationError, State, simulate
from cutpoint.control import PD, Command, Feedforward, Law
from cutpoint.simulation import UntracedControllerWarning, simulate_many
from cutpoint.trajectories import cycloid
from robot_library import Array, robot

KP, KD = np.array([2000.0, 2000, 1000, 500, 300, 200]), np.array([60.0, 60, 35, 20, 12, 10])
END = np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5])
MOVE = cycloid(END, 0.1)


def weaker(ours: Robot, share: float) -> Robot:
    """The same arm with another static friction and other rotors."""
    drives = {}
    for name, drive in ours.drives.items():
        rotor = drive.rotor and replace(drive.rotor, inertia=drive.rotor.inertia * share)
        drives[name] = replace(drive, rotor=rotor)
    return ours.with_drives(drives)


def same(one: Log, other: Log) -> bool:
    return all(np.array_equal(one[name], other[name]) for name in one.channels) and one.meta == other.meta


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_a_run_among_many_is_the_run_alone_to_the_last_bit(backend):
    """Plants that the law does not know, other gains, noise and starts: eleven runs, two packs."""
    ours, count = robot("xia2019", backend), 11 if backend == "llvm" else 3
    shared: dict[str, Any] = {"duration": 0.02 if backend == "llvm" else 3e-3, "substeps": 4}
    plants = [weaker(ours, 1 + 0.05 * k) for k in range(count)]
    laws = [PD(KP / (10 + k), KD / 10) + Feedforward(ours) for k in range(count)]
    sensors = [Sensors(motor_noise=1e-5, speeds="differenced", delay=2e-3, seed=k) for k in range(count)]
    starts = [State(q=0.01 * np.sin(np.arange(6) + k)) for k in range(count)]
    runs = simulate_many(plants, laws, MOVE, initial=starts, sensors=sensors, **shared)
    assert len(runs) == count
    for k in range(count):
        alone = simulate(plants[k], laws[k], MOVE, initial=starts[k], sensors=sensors[k], **shared)
        assert same(runs[k], alone)
        assert runs[k].run.robot is plants[k]
    assert not np.array_equal(runs[0]["q"], runs[1]["q"])


def test_drives_may_be_of_all_kinds_and_the_base_may_float():
    ours = robot("mixed_floating")
    starts = [State(v=0.1 * np.cos(np.arange(ours.nv) + k)) for k in range(3)]
    runs = simulate_many(ours, None, duration=0.01, initial=starts)
    assert all(same(run, simulate(ours, None, duration=0.01, initial=s)) for run, s in zip(runs, starts, strict=True))


def test_references_and_disturbances_may_differ_too():
    """Over more samples than a pack holds at a time."""
    ours, law, many = robot("xia2019"), PD(KP, KD), {"control_period": 2e-5, "sensors": Sensors(link_noise=1e-6)}
    moves = [cycloid(END * share, 0.05) for share in (0.2, 0.5, 1.0)]
    pushes = [lambda t, k=k: np.outer(np.sin(300 * t), np.eye(6)[k]) for k in range(3)]
    runs = simulate_many(ours, law, moves, disturbances=pushes, **many)
    for run, move, push in zip(runs, moves, pushes, strict=True):
        assert same(run, simulate(ours, law, move, disturbances=push, **many))


class Remembering(Law):
    """An integral."""

    def __init__(self, gain: float) -> None:
        self.gain = gain

    def start(self) -> Array:
        return np.zeros(6)

    def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
        memory = memory + (reference.q - measurement.q) * measurement.period
        return memory, Command(self.gain * memory + 500.0 * (reference.theta - measurement.theta))


def test_runs_of_other_structures_are_run_apart():
    ours, laws = robot("xia2019"), [PD(KP, KD), Remembering(10.0), PD(KP / 2, KD)]
    shared: dict[str, Any] = {"duration": 0.02, "substeps": 4}
    runs = simulate_many(ours, laws, MOVE, **shared)
    assert all(same(run, simulate(ours, law, MOVE, **shared)) for run, law in zip(runs, laws, strict=True))


def test_one_that_diverges_stops_alone():
    """Gains a thousand times too high."""
    ours = robot("flexspline")
    laws = [PD(KP, KD), PD(1e3 * KP, 1e3 * KD), PD(KP / 2, KD)]
    runs = simulate_many(ours, laws, cycloid(END, 0.5), substeps=4)
    with pytest.raises(SimulationError) as alone:
        simulate(ours, laws[1], cycloid(END, 0.5), substeps=4)
    assert [*runs.errors] == [1]
    with pytest.raises(SimulationError, match=r"diverged at t = \S+ s: .* of 'joint\d' is ") as caught:
        runs[1]
    assert str(caught.value) == str(alone.value)
    assert same(caught.value.log, alone.value.log)
    assert caught.value.evidence == alone.value.evidence
    assert same(runs[2], simulate(ours, laws[2], cycloid(END, 0.5), substeps=4))
    assert len(runs.finished) == 2
    assert repr(runs) == "Runs(2 of 3 runs reached their end)"


@pytest.mark.parametrize("threads", [1, 3])
def test_what_each_makes_of_a_log_is_kept_in_order(threads):
    ours, starts = robot("xia2019"), [State(q=np.full(6, 0.01 * k)) for k in range(20)]
    ends = simulate_many(ours, None, duration=0.01, initial=starts, each=lambda log: log["q"][0, 0], threads=threads)
    assert ends[:] == [0.01 * k for k in range(20)]


def test_the_run_that_needs_most_steps_sets_them_for_all():
    plants = [robot("rigid"), robot("linear")]
    runs = simulate_many(plants, None, duration=0.01)
    most = simulate(plants[1], None, duration=0.01).meta
    assert all(run.meta["steps_set_by"] == most["steps_set_by"] for run in runs)


def test_a_law_that_cannot_be_compiled_runs_one_by_one():
    def step(memory: Any, m: Any, r: Any) -> Any:
        return memory, m.q * (-10.0 if m.time > 4.5e-3 else 0.0)

    ours, starts = robot("xia2019"), [State(q=np.full(6, x)) for x in (0.1, 0.2)]
    with pytest.warns(UntracedControllerWarning, match=r"run by run"):
        runs = simulate_many(ours, step, duration=0.01, initial=starts)
    with pytest.warns(UntracedControllerWarning):
        alone = simulate(ours, step, duration=0.01, initial=starts[1])
    assert same(runs[1], alone)


def test_ctrl_c_gives_what_there_is():
    """As far as it is heard: here, while the first pack's logs are looked at."""

    def impatient(log: Log) -> float:
        if log["q"][0, 0] == 0.0:
            raise KeyboardInterrupt
        return float(log["q"][0, 0])

    starts = [State(q=np.full(6, 0.01 * k)) for k in range(40)]
    runs = simulate_many(robot("xia2019"), None, duration=0.01, initial=starts, each=impatient)
    assert 0 in runs.errors
    with pytest.raises(SimulationError, match=r"interrupted"):
        runs[0]


def test_an_error_in_each_is_the_users_own():
    def broken(log: Log) -> float:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        simulate_many(robot("xia2019"), None, duration=0.01, initial=[State(), State()], each=broken)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, r"lists must have one entry per run, at least 1; there are none"),
        ({"initial": []}, r"there are 0 of initial"),
        ({"initial": (State() for _ in "ab")}, r"initial is a generator; give one for all runs, or a list with one"),
        ({"controller": np.array([None, None])}, r"controller is a ndarray; give one for all runs, or a list"),
        ({"initial": [State()] * 2, "sensors": [Sensors()] * 3}, r"there are 2 of initial, 3 of sensors"),
        ({"initial": [State()] * 2, "threads": 0}, r"threads 0 must be a whole number, at least 1"),
        ({"initial": [State()] * 2, "accuracy": "reference"}, r"accuracy 'reference' must be 'standard' or 'fine'"),
        ({"initial": [State()] * 2, "duration": None}, r"simulate_many: without a trajectory, give duration="),
        ({"initial": [State(), State(q=np.zeros(5))]}, r"run 1: initial.q has shape"),
        ({"initial": [State(), 0.0]}, r"run 1: initial must be a State"),
        ({"sensors": [Sensors(), Sensors(delay=1e-4)]}, r"run 1: sensors: delay 0.0001 s must be a whole number"),
        ({"controller": [None, PD(KP[:5], KD[:5])]}, r"run 1: "),
        (
            {"trajectory": [MOVE, cycloid(END[:5], 0.1)]},
            r"run 1: the trajectory has 5 joints, but the robot has 6 drives",
        ),
        ({"initial": [State()] * 2, "channels": "q"}, r"run 0: channels='q' must be a collection of names"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        simulate_many(robot("xia2019"), **{"duration": 0.1, **options})


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_a_command_that_is_on_its_way_arrives_late_in_each_run(backend):
    ours = robot("xia2019", backend)
    ours = ours.with_drives({name: replace(d, motor=Motor(0.1, delay=1e-3)) for name, d in ours.drives.items()})
    shared: dict[str, Any] = {"duration": 3e-3, "substeps": 2, "channels": ["motor_torque"]}
    laws = [PD(KP / (10 + k), KD / 10) for k in range(2)]
    runs = simulate_many(ours, laws, MOVE, **shared)
    assert all(same(run, simulate(ours, law, MOVE, **shared)) for run, law in zip(runs, laws, strict=True))


def test_laws_alike_in_their_numbers_or_not_are_those_alone():
    """What depends on the reference alone is found once for all runs where it can be."""
    ours, count = robot("xia2019"), 9
    shared: dict[str, Any] = {"duration": 0.02, "substeps": 4}
    sensors = [Sensors(motor_noise=1e-5, seed=k) for k in range(count)]
    alike, apart = [Feedforward(ours)] * count, [Feedforward(weaker(ours, 1 + 0.1 * k)) for k in range(count)]
    for laws in (alike, apart):
        whole = [PD(KP / 10, KD / 10) + law for law in laws]
        runs = simulate_many(ours, whole, MOVE, sensors=sensors, **shared)
        for k in (0, 3, 8):
            assert same(runs[k], simulate(ours, whole[k], MOVE, sensors=sensors[k], **shared))


def test_an_interruption_ends_the_runs_that_are_called_back_too():
    class Interrupting:
        def step(self, memory: Any, m: Any, r: Any) -> Any:
            if m.time > 2.5e-3:
                raise KeyboardInterrupt
            return memory, KP * (r.theta - m.theta)

    with pytest.warns(UntracedControllerWarning):
        runs = simulate_many(robot("xia2019"), [Interrupting() for _ in range(3)], MOVE, duration=0.01)
    assert len(runs.errors[0].log.time) == 3
    assert [str(runs.errors[k]) for k in (1, 2)] == ["interrupted before it ended"] * 2

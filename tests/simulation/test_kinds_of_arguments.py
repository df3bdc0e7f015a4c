"""Arguments of another kind than is wanted are refused: which, what it must be, what it is."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, MaxwellSlip, Motor, Sensors, State, simulate, simulate_many
from cutpoint.control import PD
from cutpoint.studies.sizing import sizing
from cutpoint.trajectories import cycloid, from_samples
from robot_library import frictionless, robot


@pytest.mark.parametrize("go", [simulate, simulate_many])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"robot": "arm.urdf"}, r"robot must be a Robot \(cutpoint.load reads files\), got 'arm.urdf'"),
        ({"trajectory": np.zeros(6)}, r"trajectory must be a trajectory: one of .* got an array \(6,\) of float64"),
        ({"initial": np.zeros(6)}, r"initial must be a State, .* got an array \(6,\)"),
        ({"duration": 1.0, "disturbances": np.zeros(6)}, r"disturbances must be a function of times .* got an array"),
        ({"duration": 1.0, "disturbances": lambda: 0}, r"disturbances must take \(times\), but takes \(\)"),
        ({"duration": 1.0, "disturbances": lambda t, q: 0}, r"disturbances must take \(times\), but takes \(t, q\)"),
        ({"duration": 1.0, "sensors": {}}, r"sensors must be Sensors, .* got {}"),
        ({"duration": 1.0, "channels": 3}, "channels must be a collection of names, got 3"),
        ({"duration": 1.0, "channels": [3]}, r"channels must be a collection of names, got \[3\]"),
        (
            {"duration": 1.0, "channels": np.array(3)},
            r"channels must be a collection of names, got an array \(\) of int",
        ),
        ({"duration": "1"}, "duration must be one number, s, got '1'"),
        ({"duration": True}, "duration must be one number, s, got True"),
        ({"duration": 1.0, "control_period": None}, "control_period must be one number, s, got None"),
        ({"duration": 1.0, "substeps": "4"}, "substeps '4' must be a whole number, at least 1"),
        ({"duration": 1.0, "sensors": Sensors(delay="a")}, "sensors: delay must be one number, s, got 'a'"),
        ({"duration": 1.0, "sensors": Sensors(link_noise="a")}, "sensors: link_noise a must be positive; leave it out"),
        ({"duration": 1.0, "sensors": Sensors(seed=1.5)}, "sensors: seed 1.5 must be a whole number, at least 0"),
        ({"duration": 1.0, "sensors": Sensors(seed=-1)}, "sensors: seed -1 must be a whole number, at least 0"),
    ],
)
def test_an_argument_of_another_kind_is_refused_by_its_name(options, message, go):
    given = {"robot": robot("xia2019"), "controller": None if go is simulate else [None, None], **options}
    with pytest.raises(InputError, match=message):
        go(**given)


def test_hold_is_true_or_false():
    with pytest.raises(InputError, match="hold must be True or False, got 'False'"):
        simulate(robot("xia2019"), duration=0.01, hold="False")


def test_a_motor_with_a_delay_cannot_act_at_every_instant():
    ours = frictionless(robot("xia2019"))
    drives = {name: replace(d, motor=Motor(0.1, delay=5e-4)) for name, d in ours.drives.items()}
    with pytest.raises(InputError, match=r"hold=False is for .* without memory; motors with a delay go by samples"):
        simulate(ours.with_drives(drives), duration=0.01, hold=False)


@pytest.mark.parametrize("go", [simulate, simulate_many])
def test_disturbances_of_one_time_are_told_that_they_are_given_many(go):
    with pytest.raises(ValueError, match="truth value") as failed:
        go(robot("xia2019"), [None][: go is simulate_many] or None, duration=0.01, disturbances=lambda t: 1 if t else 0)
    assert failed.value.__notes__[0].startswith("disturbances is given all times at once, an array of shape (11,)")


@pytest.mark.parametrize(
    ("each", "threads", "name"),
    [(3, 1, "each"), (lambda: 0, 1, "each must take"), (None, 1.5, "threads"), (None, "2", "threads")],
)
def test_what_many_runs_are_told_beside_is_looked_at_too(each, threads, name):
    with pytest.raises(InputError, match=f"simulate_many: {name} "):
        simulate_many(robot("xia2019"), [None], duration=0.01, each=each, threads=threads)


def test_a_trajectory_of_ones_own_is_one():
    class Mine:
        """What a cycloid does, by hand."""

        duration, size = 0.02, 6

        def derivatives(self, t: Any, order: int) -> Any:
            return cycloid(np.full(6, 0.1), 0.02).derivatives(t, order)

    ours = robot("xia2019")
    assert np.array_equal(simulate(ours, None, Mine())["q"], simulate(ours, None, cycloid(np.full(6, 0.1), 0.02))["q"])


def test_a_trajectory_of_ones_own_may_write_into_the_same_array_again():
    class Mine:
        duration, size = 0.02, 6

        def __init__(self) -> None:
            self.kept = np.zeros((5, 21, 6))

        def derivatives(self, t: Any, order: int) -> Any:
            self.kept += 0.1
            return self.kept

    ours, mine = robot("xia2019"), Mine()
    first = simulate(ours, None, mine)
    second = simulate(ours, None, mine)
    assert np.all(first["reference_q"] == 0.1) and np.all(second["reference_q"] == 0.2)
    assert first.run and np.all(first.run.reference == 0.1)


@pytest.mark.parametrize(("part", "size"), [("q", 6), ("v", 6), ("theta", 6), ("theta_dot", 6), ("strains", 0)])
@pytest.mark.parametrize("law", [None, PD([1.0] * 6, [1.0] * 6)])
def test_a_run_has_one_start(part, size, law):
    told = rf"initial.{part} has shape \(1, {size}\), but must have \({size},\)"
    with pytest.raises(InputError, match=told):
        simulate(robot("xia2019"), law, duration=0.01, initial=State(**{part: np.zeros((1, size))}))


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda t: [1, 2], r"has shape \(2,\): its last axis must be 6"),
        (lambda t: np.zeros((3, len(t), 6)), r"has shape \(3, 21, 6\): it must be \(5, 21, 6\): position"),
        (lambda t: np.full((5, len(t), 6), np.nan), r"\[0, 0, 0\] is nan: every number must be finite"),
        (lambda t: "no", "must be numbers of shape"),
    ],
)
def test_what_a_trajectory_of_ones_own_gives_is_looked_at(made, message):
    class Mine:
        duration, size = 0.02, 6

        def derivatives(self, t: Any, order: int) -> Any:
            return made(t)

    with pytest.raises(InputError, match=r"simulate: trajectory.derivatives\(times, 4\).*" + message):
        simulate(robot("xia2019"), None, Mine())


def test_a_trajectory_of_other_joints_is_refused():
    """Columns of a file are taken by their place: names in another order would move the wrong joints."""
    ours = robot("xia2019")
    moves = [from_samples(np.arange(5.0), np.zeros((5, 6)), joints=names) for names in (ours.joints, ours.joints[::-1])]
    assert simulate(ours, None, moves[0], 0.01) is not None
    message = (
        r"the trajectory is for 'joint6', .*, but the robot's joints are 'joint1', .*: read it with joints=robot.joints"
    )
    with pytest.raises(InputError, match="simulate: " + message):
        simulate(ours, None, moves[1], 0.01)
    with pytest.raises(InputError, match="sizing: " + message):
        sizing(ours, moves[1])


def test_strains_beyond_where_elements_slip_are_refused():
    ours = robot("xia2019")
    slipping = {name: replace(x, hysteresis=MaxwellSlip((400.0,), (1e-3,))) for name, x in ours.drives.items()}
    ours = ours.with_drives(slipping)
    simulate(ours, None, duration=0.01, initial=State(strains=np.full(6, -1e-3)))
    with pytest.raises(InputError, match=r"initial strain joint2: hysteresis 1 is 0.1, but it slips at 0.001"):
        simulate(ours, None, duration=0.01, initial=State(strains=[0, 0.1, 0, 0, 0, 0]))


def test_a_start_that_wants_arguments_is_refused():
    class Wanting:
        def start(self, robot: object) -> tuple[float, ...]:
            return (0.0,)

        def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
            return memory, np.zeros(6)

    with pytest.raises(InputError, match=r"controller Wanting: start\(\) must take no arguments: missing a required"):
        simulate(robot("xia2019"), Wanting(), duration=0.01)

"""A run that fails says when, where and why, and keeps what it had reached."""

from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, SimulationError, State, simulate
from cutpoint.control import PD, Feedforward
from cutpoint.simulation import UntracedControllerWarning
from cutpoint.trajectories import cycloid
from robot_library import frictionless, robot

MOVE = cycloid(np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5]), 1.0)
LINK_SIDE = PD([2000.0, 2000, 1000, 500, 300, 200], [60.0, 60, 35, 20, 12, 10], side="link")


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_stiff_feedback_of_the_link_around_an_undamped_spring_diverges_and_says_so(backend):
    ours = frictionless(robot("xia2019", backend))
    message = r"diverged at t = \S+ s: .*speed of 'joint\d' is \S+ rad/s; lower the gains"
    with pytest.raises(SimulationError, match=message) as caught:
        simulate(ours, LINK_SIDE, MOVE, substeps=4)
    log, time = caught.value.log, caught.value.evidence["time"]
    assert log.time[-1] == time < 1.0
    assert len(log["q"]) == len(log.time) > 10
    assert np.isfinite(log["q"]).all()


@pytest.mark.parametrize("accuracy", ["standard", "reference"])
def test_a_command_that_is_no_number_stops_the_run(accuracy):
    def broken(memory: Any, m: Any, r: Any) -> Any:
        return memory, m.q * (np.inf if m.time > 4.5e-3 else 0.0)

    ours = frictionless(robot("xia2019"))
    with pytest.warns(UntracedControllerWarning), pytest.raises(SimulationError, match=r"t = 0.00\d s") as caught:
        simulate(ours, broken, duration=0.1, initial=State(q=np.ones(6)), accuracy=accuracy)
    assert 5 <= len(caught.value.log.time) <= 7


def test_an_error_in_a_controller_is_the_users_own():
    def broken(memory: Any, m: Any, r: Any) -> Any:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        simulate(robot("xia2019"), broken, duration=0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "without a trajectory, give duration="),
        ({"duration": 0.0}, "duration 0.0 s must be at least one control period"),
        ({"duration": np.nan}, "duration nan s must be at least one control period"),
        ({"duration": 1.0, "control_period": 0.0}, "control_period 0.0 s must be positive"),
        ({"duration": 1.0, "accuracy": "perfect"}, "accuracy 'perfect' must be 'standard', 'fine' or 'reference'"),
        ({"duration": 1.0, "substeps": 0}, "substeps 0 must be a whole number, at least 1"),
        ({"duration": 1.0, "substeps": 2.5}, "substeps 2.5 must be a whole number, at least 1"),
        ({"duration": 1.0, "initial": State(q=np.zeros(5))}, "initial.q has shape .5,., its last axis must be 6"),
        ({"duration": 1.0, "initial": State(v=[0, 0, np.nan, 0, 0, 0])}, r"initial.v\[2\] is nan"),
        ({"duration": 1.0, "disturbances": lambda t: np.zeros((3, 6))}, "disturbances.times. has shape .3, 6."),
        ({"duration": 1.0, "controller": PD([1.0] * 5, [1.0] * 5)}, "PD is for 5 drives, the robot has 6"),
        ({"duration": 1.0, "controller": 7}, "controller 7 has no step"),
        ({"trajectory": cycloid([0.1] * 5, 1.0)}, "the trajectory has 5 joints, the robot has 6 drives"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        simulate(robot("xia2019"), **options)


def test_a_reference_in_degrees_is_recognised():
    message = r"'shoulder_lift_joint': position 60 rad exceeds its limits .* looks like degrees"
    with pytest.raises(InputError, match=message):
        simulate(robot("ur10"), None, cycloid([0.0, 60.0, 0.0, 0.0, 0.0, 0.0], 1.0))


def test_feedforward_for_a_floating_base_is_refused():
    with pytest.raises(InputError, match="a floating base has no motor"):
        Feedforward(robot("floating"))

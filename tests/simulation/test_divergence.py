"""A run that fails says when, where and why, and keeps what it had reached."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Robot, Sensors, SimulationError, State, simulate, simulate_many, where
from cutpoint.control import PD, Command, Feedforward
from cutpoint.formats import parse_urdf
from cutpoint.simulation import UntracedControllerWarning
from cutpoint.trajectories import cycloid
from robot_library import frictionless, robot, shoulder

ARM = frictionless(shoulder())

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


def test_a_run_that_diverges_says_first_that_its_reference_looks_like_degrees():
    move = cycloid(np.array([10.0, 90.0, -60.0]), 0.5)
    law = replace(LINK_SIDE, kp=LINK_SIDE.kp[:3], kd=LINK_SIDE.kd[:3])
    told = r"diverged .*; the reference of 'joint2' reaches 90 rad, which looks like degrees: give radians .*lower the"
    with pytest.raises(SimulationError, match=told):
        simulate(ARM, law, move, substeps=4)
    assert re.search(told, str(simulate_many(ARM, [law, law], move, substeps=4).errors[1]))


@pytest.mark.parametrize("accuracy", ["standard", "reference"])
def test_a_command_that_is_no_number_stops_the_run(accuracy):
    def broken(memory: Any, m: Any, r: Any) -> Any:
        return memory, m.q * (np.inf if m.time > 4.5e-3 else 0.0)

    with pytest.warns(UntracedControllerWarning), pytest.raises(SimulationError, match=r"t = 0.00\d s") as caught:
        simulate(ARM, broken, duration=0.1, initial=State(q=np.ones(3)), accuracy=accuracy)
    assert 5 <= len(caught.value.log.time) <= 7


def undefined(memory: Any, m: Any, r: Any) -> Any:
    """The third drive's command is not a number from 5 ms on."""
    return memory, np.array([0.0, 0.0, where(m.time < 4.5e-3, 0.0, np.nan)])


def called_undefined(memory: Any, m: Any, r: Any) -> Any:
    return undefined(memory, m, r) if m.time < 1e3 else None


WAYS: list[dict[str, Any]] = [{}, {"accuracy": "reference"}, {"duration": 0.005}, {"channels": ["q"]}]

NO_NUMBER = (
    r"controller (called_)?undefined commands torque nan for 'joint3' at t = 0.005 s, which is not a finite number"
)


@pytest.mark.parametrize(
    ("law", "effort", "options"),
    [
        *((law, effort, {}) for law in (undefined, called_undefined) for effort in (np.inf, 50.0)),
        *((undefined, 50.0, options) for options in WAYS[1:]),
        (called_undefined, np.inf, {"accuracy": "reference"}),
    ],
)
@pytest.mark.filterwarnings("ignore::cutpoint.simulation.UntracedControllerWarning")
def test_a_command_that_is_not_a_number_is_told_with_its_drive_and_time(law, effort, options):
    """Whether or not there is a limit that it could be taken for."""
    drives = {name: replace(d, limits=replace(d.limits, effort=effort)) for name, d in ARM.drives.items()}
    with pytest.raises(SimulationError, match=NO_NUMBER) as caught:
        simulate(ARM.with_drives(drives), law, **{"duration": 0.02, **options})
    log = caught.value.log
    assert log.time[-1] == caught.value.evidence["time"] == pytest.approx(0.005) and np.isfinite(log["q"]).all()
    if "channels" not in options:
        assert np.isnan(log["motor_torque"][-1, 2]) and np.isfinite(log["motor_torque"][:-1]).all()


def test_a_command_that_is_not_a_number_is_told_among_many_and_between_samples():
    runs = simulate_many([ARM, ARM], undefined, duration=0.02, channels=["q"])
    for number in range(2):
        with pytest.raises(SimulationError, match=NO_NUMBER):
            runs[number]
    with pytest.raises(SimulationError, match=r"commands torque nan for 'joint3' at t = 0.004\d* s"):
        simulate(ARM, undefined, duration=0.02, hold=False)


@pytest.mark.parametrize(
    ("part", "options"),
    [*((part, {}) for part in ("feedforward", "theta", "theta_dot")), *(("theta", options) for options in WAYS[1:])],
)
def test_a_part_of_a_command_that_moves_nothing_must_be_a_number_too(part, options):
    def odd(memory: Any, m: Any, r: Any) -> Any:
        nothing = np.zeros(3)
        own = np.array([0.0, where(m.time < 4.5e-3, 0.0, np.nan), 0.0])
        return memory, Command(nothing, **{part: own})

    message = rf"odd commands {part} nan for 'joint2' at t = 0.005 s, which is not"
    with pytest.raises(SimulationError, match=message) as caught:
        simulate(ARM, odd, **{"duration": 0.02, **options})
    assert caught.value.log.time[-1] == pytest.approx(0.005)
    if "accuracy" not in options and options.get("duration") is None:
        with pytest.raises(SimulationError, match=message):
            simulate_many([ARM] * 2, odd, **{"duration": 0.02, **options})[1]


def test_a_law_called_back_without_its_sensors_is_told_of_them():
    def of_links(memory: Any, m: Any, r: Any) -> Any:
        return memory, -m.q if m.time < 1e3 else None

    message = (
        r"commands torque nan for 'joint1' at t = 0 s, .*; sensors are on the motor side only, so it reads NaN for"
    )
    with pytest.warns(UntracedControllerWarning), pytest.raises(SimulationError, match=message):
        simulate(robot("xia2019"), of_links, duration=0.01, sensors=Sensors(sides="motor"))


def kick_at_the_end(memory: Any, m: Any, r: Any) -> Any:
    """So hard from 10 ms on that nothing is finite a millisecond later."""
    return memory, where(m.time > 9.5e-3, 1e9, 0.0) * np.ones(3)


@pytest.mark.parametrize("accuracy", ["standard", "reference"])
def test_what_would_follow_the_last_sample_does_not_count(accuracy):
    until = 0.01
    with pytest.raises(SimulationError, match=r"diverged at t = 0.011 s"):
        simulate(ARM, kick_at_the_end, duration=0.012)
    log = simulate(ARM, kick_at_the_end, duration=until, accuracy=accuracy)
    assert log.time[-1] == pytest.approx(until) and all(np.isfinite(x).all() for x in log.channels.values())


def test_what_would_follow_the_last_sample_does_not_count_among_many():
    runs = simulate_many([ARM, ARM], kick_at_the_end, duration=0.01, channels=["q"])
    alone = simulate(ARM, kick_at_the_end, duration=0.01, channels=["q"])
    assert not runs.errors and [*runs[1].channels] == ["q"]
    assert np.array_equal(runs[1]["q"], alone["q"])


def test_an_error_in_a_controller_is_the_users_own():
    def broken(memory: Any, m: Any, r: Any) -> Any:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        simulate(robot("xia2019"), broken, duration=0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "without a trajectory, give duration="),
        ({"duration": 0.0}, "duration 0.0 s must be more than half a control period"),
        ({"duration": np.nan}, "duration nan s must be more than half a control period"),
        ({"duration": 4e-4}, "duration 0.0004 s must be more than half a control period"),
        ({"duration": np.inf}, "duration inf s at control_period 0.001 s takes inf samples"),
        ({"duration": 1.0, "control_period": 0.0}, "control_period 0.0 s must be positive"),
        ({"duration": 1.0, "accuracy": "perfect"}, "accuracy 'perfect' must be 'standard', 'fine' or 'reference'"),
        ({"duration": 1.0, "substeps": 0}, "substeps 0 must be a whole number, at least 1"),
        ({"duration": 1.0, "substeps": 10**12}, r"substeps 1e\+12 must be at most 100,000; leave it out"),
        ({"duration": 1.0, "substeps": 2.5}, "substeps 2.5 must be a whole number, at least 1"),
        ({"duration": 1.0, "initial": State(q=np.zeros(5))}, "initial.q has shape .5,.: its last axis must be 6"),
        ({"duration": 1.0, "initial": State(v=[0, 0, np.nan, 0, 0, 0])}, r"initial.v\[2\] is nan"),
        ({"duration": 1.0, "disturbances": lambda t: np.zeros((3, 6))}, "disturbances.times. has shape .3, 6."),
        ({"duration": 1.0, "controller": PD([1.0] * 5, [1.0] * 5)}, "PD is for 5 drives, but the robot has 6"),
        ({"duration": 1.0, "controller": 7}, "controller 7 has no step"),
        (
            {"duration": 1e12},
            r"duration 1e\+12 s at control_period 0.001 s takes 1e\+15 samples, but at most 10,000,000",
        ),
        ({"duration": 1.0, "control_period": 1e-12}, r"duration 1 s at control_period 1e-12 s takes 1e\+12 samples"),
        (
            {"duration": 0.05, "controller": PD([1.0] * 6, [1.0] * 6), "sensors": Sensors(delay=0.1)},
            "delay 0.1 s is as long as the run, 0.05 s, so PD would see nothing but its start; is it in ms?",
        ),
        ({"duration": 1.0, "sensors": Sensors(delay=1e9)}, r"delay 1e\+09 s is 1e\+12 control periods of 0.001 s"),
        ({"trajectory": cycloid([0.1] * 5, 1.0)}, "the trajectory has 5 joints, but the robot has 6 drives"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        simulate(robot("xia2019"), **options)


def test_a_reference_in_degrees_is_recognised():
    message = r"'shoulder_lift_joint': position 60 rad exceeds its limits .* looks like degrees"
    with pytest.raises(InputError, match=message):
        simulate(robot("ur10"), None, cycloid([0.0, 60.0, 0.0, 0.0, 0.0, 0.0], 1.0))


def test_millimetres_of_a_joint_that_slides_are_recognised():
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    ends, limit = '<parent link="base"/><child link="arm"/>', '<limit lower="0" upper="0.3"/>'
    lift = f'<joint name="lift" type="prismatic">{ends}{limit}</joint>'
    rail = Robot(parse_urdf(f'<robot name="r"><link name="base"/><link name="arm">{inertial}</link>{lift}</robot>'))
    with pytest.raises(InputError, match=r"'lift': position 200 m exceeds its limits \[0, 0.3\]; this looks like mm"):
        simulate(rail, None, cycloid([200.0], 1.0))
    assert simulate(rail, None, cycloid([0.4], 1.0)).max("reference_q")[0] == pytest.approx(0.4)


@pytest.mark.filterwarnings("ignore::cutpoint.simulation.UntracedControllerWarning")
def test_ctrl_c_before_the_first_sample_leaves_no_log():
    def stopped(memory: Any, m: Any, r: Any) -> Any:
        if isinstance(m.time, float):
            raise KeyboardInterrupt
        return memory, m.q if m.time < 1e3 else None

    with pytest.raises(SimulationError, match="interrupted before it began") as caught:
        simulate(robot("xia2019"), stopped, duration=0.01)
    assert caught.value.log is None and not caught.value.evidence["diverged"]


def test_what_diverges_is_named_by_its_joint_and_in_its_unit():
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    links = "".join(f'<link name="{name}">{inertial}</link>' for name in ("cart", "arm"))
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/></joint>'
        for name, kind, parent, child in (("sheet", "planar", "base", "cart"), ("rail", "prismatic", "cart", "arm"))
    )
    loose = Robot(parse_urdf(f'<robot name="r"><link name="base"/>{links}{joints}</robot>'))
    with pytest.raises(SimulationError, match=r"diverged .* speed of joint 'sheet' is 1e\+0[78]"):
        simulate(loose, None, duration=0.1, initial=State(v=[1e7, 0.0, 0.0, 0.0]))


def test_feedforward_for_a_floating_base_is_refused():
    with pytest.raises(InputError, match="a floating base has no motor"):
        Feedforward(robot("floating"))

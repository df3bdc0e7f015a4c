"""Arguments that are not a robot, recording, motion, path or number are refused by name, wherever they are passed."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Log, Sensors, derivatives, load, simulate
from cutpoint.analysis import followed_hysteresis, frequency_response, linearize, modes, torque_bound
from cutpoint.control import PD, slowest_pole, tune
from cutpoint.formats import dump_drives, load_mjcf, load_urdf, parse_drives, parse_mjcf, parse_urdf, save_drives
from cutpoint.identification import (
    Channel,
    Recording,
    Table,
    aligned,
    arm_torque,
    base_parameters,
    clock_skew,
    derivative,
    identify,
    identify_drives,
    identify_rigid,
    load_mapping,
    low_pass,
    low_passed,
    noise_cutoff,
    parse_mapping,
    read_recording,
    read_table,
    recording_of,
    skews,
)
from cutpoint.robots import XIA2019_URDF
from cutpoint.studies.sizing import sizing
from cutpoint.trajectories import cycloid
from robot_library import robot

TIME = np.linspace(0.0, 1.0, 200)
Q = np.sin(np.outer(TIME, np.arange(1.0, 7.0)))
MOVE = cycloid(end=np.full(6, 0.3), duration=0.2)
NO_ROBOT = r"{}: robot must be a Robot \(cutpoint.load reads files\), got None"
NO_RECORDING = r"{}: recording must be a Recording \(read_recording reads logs\), got None"


def recording() -> Recording:
    return Recording(TIME, robot("xia2019").joints, q=Q, theta=Q)


@pytest.mark.parametrize(
    ("function", "given"),
    [
        (linearize, {"q": Q[0]}),
        (torque_bound, {"theta": Q, "q": Q, "sensors": Sensors()}),
        (followed_hysteresis, {"theta": Q, "q": Q}),
        (sizing, {"trajectory": MOVE}),
        (tune, {"bandwidth": 1.0}),
        (slowest_pole, {"law": PD([1.0], [1.0]), "q": Q[0], "control_period": 1e-3}),
        (base_parameters, {}),
        (identify_rigid, {"recording": recording()}),
        (identify_drives, {"recording": recording()}),
        (arm_torque, {"joint": "joint1"}),
    ],
)
def test_what_is_no_robot(function: Callable[..., Any], given: dict[str, Any]):
    with pytest.raises(InputError, match=NO_ROBOT.format(function.__name__)):
        function(None, **given)


@pytest.mark.parametrize("function", [aligned, skews, low_passed])
def test_what_is_no_recording(function: Callable[..., Any]):
    with pytest.raises(InputError, match=NO_RECORDING.format(function.__name__)):
        function(None)


@pytest.mark.parametrize("function", [identify_rigid, identify_drives])
def test_what_is_no_recording_of_a_robot(function: Callable[..., Any]):
    with pytest.raises(InputError, match=NO_RECORDING.format(function.__name__)):
        function(robot("xia2019"), None)


@pytest.mark.parametrize(
    "function",
    [Log.load, load_mapping, read_table, read_recording, load_urdf, load_mjcf, partial(save_drives, drives={})],
)
def test_what_is_no_path(function: Callable[..., Any]):
    with pytest.raises(InputError, match=r"path must be the path of .*, got 7"):
        function(7)


MAPPING = {"version": 1, "q": "q"}

LINEAR = {"frequencies": [1.0, 2.0], "joint": "joint1"}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: modes(None, Q[0]), r"modes: robot must be a Robot"),
        (lambda: linearize(None, Q[0]), r"linearize: robot must be a Robot"),
        (lambda: frequency_response(None, **LINEAR), r"frequency_response: model must be the linear model of a robot"),
        (lambda: frequency_response(linearize(robot("xia2019"), Q[0]), [1.0], Q), r"no driven joint is named array"),
        (lambda: sizing(robot("xia2019"), None), r"sizing: trajectory must be a trajectory: one of .*, got None"),
        (lambda: sizing(robot("xia2019"), MOVE, dwell=None), r"sizing: dwell must be one number, s, got None"),
        (lambda: sizing(robot("xia2019"), MOVE, period=[1e-3]), r"sizing: period must be one number, s, got \[0.001\]"),
        (lambda: sizing(robot("xia2019"), MOVE, life="long"), r"sizing: life must be one number, h, got 'long'"),
        (lambda: cycloid(end=[10**400], duration=1.0), r"end must be an array of numbers, got \[1000"),
        (lambda: cycloid(end=[1.0], duration=10**400), r"duration must be within 1e\+15, got 1000"),
        (
            lambda: aligned(recording(), 1e-3),
            r"aligned: delays must be a mapping of joint names to delays, s, got",
        ),
        (lambda: aligned(recording(), {}, "q"), r"aligned: channels must be names of channels, got 'q'"),
        (lambda: recording()[["q"]], r"no recorded channel is named \['q'\]; there are: 'q', 'theta'"),
        (lambda: recording().between("start", 1.0), r"between: start must be one number, s, got 'start'"),
        (lambda: base_parameters(robot("xia2019"), rotors=None), r"rotors must be True, False, or names of joints"),
        (lambda: recording().resampled("1 ms"), r"resampled: period must be one number, s, got '1 ms'"),
        (lambda: recording().with_notes("late"), r"with_notes: notes must be texts, got 'late'"),
        (lambda: aligned(recording(), {"joint1": "late"}), r"aligned: delay must be one number, s, got 'late'"),
        (lambda: aligned(recording(), {"joint1": np.nan}), r"aligned: delay nan s must be finite"),
        (
            lambda: identify_rigid(robot("xia2019"), recording(), rotor_errors={"joint": 1.0}),
            r"no driven joint is named 'joint'; there are: 'joint1'",
        ),
        (
            lambda: identify_rigid(robot("xia2019"), recording(), rotor_errors={"joint1": -1.0}),
            r"identify_rigid: rotor_errors\['joint1'\] -1.0 kg m2 must be finite",
        ),
        (lambda: identify_rigid(robot("xia2019"), recording(), level="most"), r"level must be one number, got 'most'"),
        (lambda: identify(robot("xia2019"), recording(), hold_out="0.3"), r"hold_out must be one number, got '0.3'"),
        (lambda: identify(robot("xia2019"), recording(), torque_delay="1"), r"torque_delay must be one number, s, got"),
        (lambda: parse_urdf(3), r"parse_urdf: content must be the text of a URDF .*, got 3"),
        (lambda: parse_mjcf(3), r"parse_mjcf: content must be the text of an MJCF file .*, got 3"),
        (
            lambda: parse_drives(3, robot("xia2019").mechanism),
            r"parse_drives: content must be the text of a drive file",
        ),
        (lambda: dump_drives([1]), r"dump_drives: drives must be a mapping of joint names to Drives, got \[1\]"),
        (lambda: cycloid([1.0], np.array("abc")), r"duration must be one number, s, got an array \(\) of <U3"),
        (lambda: clock_skew("x", Q, 1e-3), r"clock_skew: x must be numbers, got 'x'"),
        (lambda: clock_skew(Q[:, 0], Q, None), r"clock_skew: period must be one number, s, got None"),
        (lambda: low_pass(Q, np.nan, 20.0), r"low_pass: period nan s must be positive and finite"),
        (lambda: low_pass(None, 1e-3, 20.0), r"low_pass: values must be numbers, got None"),
        (lambda: low_pass([], 1e-3, 20.0), r"low_pass: values have shape \(0,\): they must be \(N, \.\.\.\)"),
        (lambda: derivative(1.0, 1e-3), r"derivative: values have shape \(\): they must be \(N, \.\.\.\)"),
        (lambda: derivative(Q, 1e-3, 3), r"derivative: order 3 must be 1 or 2"),
        (lambda: noise_cutoff(Q, "1 ms"), r"noise_cutoff: period must be one number, s, got '1 ms'"),
        (lambda: parse_mapping(None), r"parse_mapping: content must be text, or a dict of its fields, got None"),
        (
            lambda: Recording(TIME, "joint1", q=Q),
            r"Recording: joints must be names, such as robot.joints, got 'joint1'",
        ),
        (lambda: Recording(TIME, ("joint1",), q=Q[:, :1], notes="late"), r"Recording: notes must be sentences, got"),
        (
            lambda: recording_of(3, parse_mapping(MAPPING)),
            r"recording_of: table must be a Table \(read_table reads files\)",
        ),
        (
            lambda: recording_of(Table("", {"q": Channel(Q[:, 0])}), 4),
            r"recording_of: mapping must be a ChannelMap \(load_mapping reads files\)",
        ),
        (lambda: derivative([1.0, 2.0], 1e-3), r"derivative: values has 2 samples; at least 3 are needed"),
        (
            lambda: identify_drives(robot("xia2019"), recording(), "coarse"),
            r"identify_drives: resolution must be numbers, got 'coarse'",
        ),
        (
            lambda: identify_drives(robot("xia2019"), recording(), [-1.0] * 6),
            r"identify_drives: resolution must be one number, or one for each joint, rad \(m\), not negative, got",
        ),
        (
            lambda: identify(robot("xia2019"), recording(), source=3),
            r"identify: path must be the path of a file, got 3",
        ),
        (
            lambda: identify(robot("xia2019"), recording(), springs="no"),
            r"identify: springs must be True or False, got",
        ),
        (lambda: identify(robot("xia2019"), recording(), align=1), r"identify: align must be True or False, got 1"),
        (lambda: load(XIA2019_URDF, floating_base="no"), r"load: floating_base must be True or False, got 'no'"),
        (lambda: load_urdf(XIA2019_URDF, mend_inertia="no"), r"mend_inertia must be True or False, got 'no'"),
        (lambda: robot("xia2019").modes(Q[0], friction="no"), r"friction must be True or False, got 'no'"),
        (
            lambda: parse_drives("version: 1", robot("xia2019")),
            r"parse_drives: mechanism must be a Mechanism, as robot.mechanism, got <Robot",
        ),
        (
            lambda: simulate(robot("xia2019"), None, MOVE, hold=False, accuracy="fast"),
            r"accuracy 'fast' must be 'stand",
        ),
        (
            lambda: simulate(robot("xia2019"), None, MOVE, hold=False, accuracy="fine"),
            r"'fine' has no effect with hold",
        ),
        (lambda: derivatives.inverse_dynamics(None, *Q[:3]), r"derivatives: robot must be a Robot"),
        (lambda: Log("now", {}, {}, ("a",)), r"Log: time must be numbers, got 'now'"),
        (lambda: Log(TIME, None, {}, ("a",)), r"Log: channels must be arrays by name, got None"),
        (lambda: Log(TIME, {}, None, ("a",)), r"Log: units must be the unit of every channel, by name, got None"),
        (lambda: Log(TIME, {}, {}, None), r"Log: joints must be names, such as robot.joints, got None"),
        (lambda: Log(TIME, {"q": "still"}, {"q": "rad"}, ("a",)), r"Log: q must be numbers, got 'still'"),
        (lambda: Recording("now", ("joint1",), q=Q[:, :1]), r"Recording: time must be numbers, got 'now'"),
        (lambda: Recording(TIME, ("joint1",), q="still"), r"Recording: q must be numbers, got 'still'"),
    ],
)
def test_what_is_of_another_kind(call: Callable[[], Any], message: str):
    with pytest.raises(InputError, match=message):
        call()

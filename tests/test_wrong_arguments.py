"""Whatever is given in an argument's place, a public call accepts it or refuses it by its own error, twice alike."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cutpoint import (
    CutpointError,
    Sensors,
    State,
    analysis,
    control,
    derivatives,
    formats,
    identification,
    simulate,
    trajectories,
)
from cutpoint.identification import drives
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.studies.sizing import sizing
from robot_library import robot

WRONG: list[Any] = [
    "abc", -1, 0, [], np.nan, np.inf, [np.nan] * 6, object(), {"a": 1}, True, None, np.zeros((2, 3)), 1e14, 1e300,
    np.array(3.0), [[1.0, 2.0], [3.0]],
]  # fmt: skip

ARM = robot("xia2019")
SIX, TIME = np.full(6, 30.0), np.linspace(0.0, 1.0, 600)
LAW, MOVE = control.PD(SIX, SIX), trajectories.quintic(0.01 * SIX, 0.01)
WAVE = np.sin(40.0 * TIME)
RIGID: dict[str, Any] = {"robot": ARM, "parameters": None, "side": "motor"}
SLIDING: dict[str, Any] = {**RIGID, "position_gain": SIX, "speed_gain": SIX}
JOINTS: dict[str, Any] = {"robot": ARM, "position_gain": SIX, "speed_gain": SIX, "motor_gain": SIX, "spring_gain": SIX}
LOOP: dict[str, Any] = {"robot": ARM, "law": LAW, "q": 0 * SIX, "control_period": 1e-3, "sensors": None}
OPTIONS: dict[str, Any] = {"initial": None, "disturbances": None, "accuracy": "fine", "hold": True, "channels": None}
SENSORS: dict[str, Any] = {"delay": 0.0, "speeds": "true", "seed": 0, "motor_noise": None, "sides": "both"}
MOTION: dict[str, Any] = dict.fromkeys(("q", "v", "a", "jerk", "snap"), 0.01 * SIX)
MOTION |= {"friction_rates": True, "quasi_rigid": True}
BENCH: dict[str, Any] = {"theta": 0.01 * WAVE, "period": 2e-3, "ratio": 100.0}


def run(**given: Any) -> Any:
    return simulate(**{"robot": ARM, "controller": LAW, "trajectory": MOVE, "duration": 0.003, **given})


URDF = '<robot name="a"><link name="b"/></robot>'

CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "a robot file": (formats.parse_urdf, {"content": URDF, "lock": None, "mimic": "coupled", "floating_base": False}),
    "a joint's drive": (formats.drive_of, {"joint": ARM.mechanism.bodies[0].joint}),
    "slipping elements": (MaxwellSlip.smooth, {"torque": 1.0, "reach": 1e-3, "elements": 4}),
    "PD": (control.PD, {"kp": SIX, "kd": SIX, "side": "motor"}),
    "PID": (control.PID, {"kp": SIX, "ki": SIX, "kd": SIX, "limit": SIX, "side": "link"}),
    "computed torque": (control.ComputedTorque, {**RIGID, "kp": SIX, "kd": SIX}),
    "robust": (control.Robust, {**SLIDING, "bound": SIX, "width": 0.1}),
    "Slotine-Li": (control.SlotineLi, {**SLIDING, "rate": 1.0, "torque_limit": None}),
    "super-twisting": (control.SuperTwisting, {**SLIDING, "root_gain": SIX, "twist": SIX}),
    "elastic computed torque": (control.ElasticComputedTorque, {"robot": ARM, "bandwidth": 50.0}),
    "full state feedback": (control.FullStateFeedback, {"robot": ARM, "kp": SIX, "kd": SIX, "shaping": 0.5}),
    "gravity": (control.GravityCompensation, {"robot": ARM, "side": "link"}),
    "feedforward": (control.Feedforward, {"robot": ARM, "rung": "elastic", "parameters": None}),
    "VDC": (control.VDC, {**JOINTS, "body_gain": 1.0, "derivatives": "model", "filter_bandwidth": 20.0}),
    "adaptive VDC": (control.AdaptiveVDC, {**JOINTS, "update": "natural", "body_rate": 1.0, "uncertainty": 0.1}),
    "observer": (control.DisturbanceObserver, {**RIGID, "law": LAW, "gain": SIX, "torque_limit": None}),
    "guard": (control.Guard, {"robot": ARM, "law": LAW, "reactions": {}, "ramp_time": 0.2, "speed_limit": None}),
    "speed filter": (control.SpeedFilter, {"law": LAW, "bandwidth": 100.0}),
    "sum": (control.Sum, {"parts": (LAW, LAW)}),
    "tune": (control.tune, {"robot": ARM, "bandwidth": 4.0, "law": control.PD, "damping": 1.0, "q": None}),
    "margins": (control.margins, LOOP),
    "slowest pole": (control.slowest_pole, LOOP),
    "linearize": (analysis.linearize, {"robot": ARM, "q": SIX, "v": None, "motor_torque": None, "friction": True}),
    "modes": (analysis.modes, {"robot": ARM, "q": SIX}),
    "cycloid": (trajectories.cycloid, {"end": SIX, "duration": 1.0, "start": None}),
    "waypoints": (trajectories.waypoints, {"times": [0.0, 1.0, 2.0], "points": np.zeros((3, 6))}),
    "samples": (trajectories.from_samples, {"times": TIME, "q": WAVE[:, None], "bandwidth": 40.0, "at_rest": False}),
    "sizing": (sizing, {"robot": ARM, "trajectory": MOVE, "dwell": 0.0, "period": 1e-3}),
    "simulate": (run, {"robot": ARM, "controller": LAW, "trajectory": MOVE, "duration": 0.003, "substeps": None}),
    "simulate, options": (run, OPTIONS),
    "sensors": (lambda **x: run(sensors=Sensors(**x)), SENSORS),
    "state": (lambda **x: run(initial=State(**x)), {"q": None, "v": None, "theta": None, "strains": None}),
    "inverse dynamics": (ARM.inverse_dynamics, {"q": SIX, "v": SIX, "a": SIX}),
    "elastic inverse dynamics": (ARM.elastic_inverse_dynamics, MOTION),
    "its derivatives": (lambda **x: derivatives.elastic_inverse_dynamics(ARM, **x), MOTION),
    "jacobian": (ARM.jacobian, {"q": SIX, "frame": "tool", "expressed_in": "world"}),
    "machine": (ARM.machine_with, {"parameters": ARM.drive_parameters}),
    "payload": (ARM.with_payload, {"mass": 1.0, "com": [0.0, 0.0, 0.1], "inertia": np.eye(3), "frame": "tool"}),
    "noise": (identification.noise_cutoff, {"values": WAVE, "period": 2e-3, "otherwise": 3.0}),
    "two encoders": (drives.two_encoders, {**BENCH, "q": 0 * WAVE, "joint_torque": 80.0 * WAVE, "resolution": 1e-6}),
    "motor side": (drives.motor_side, {**BENCH, "joint_torque": WAVE, "torque": WAVE, "cutoff": 30.0, "delay": 0.0}),
    "locked output": (drives.locked_output, {**BENCH, "torque": 80.0 * WAVE, "share": 0.03, "rated_torque": 40.0}),
    "motor response": (drives.motor_response, {"theta": WAVE, "torque": WAVE, "period": 2e-3, "window": 0.2}),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", CALLS)
def test_a_wrong_argument_is_refused_or_accepted_twice_alike(name: str) -> None:
    call, good = CALLS[name]
    call(**good)
    for argument in good:
        for wrong in WRONG:
            given = {**good, argument: wrong}
            assert refuses(call, given) == refuses(call, given), (argument, wrong)


def refuses(call: Callable[..., Any], given: dict[str, Any]) -> str:
    """The call's own error, which anything else than that is not."""
    try:
        call(**given)
    except CutpointError as error:
        return str(error)
    return ""

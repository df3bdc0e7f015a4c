"""Invalid arguments are refused where they are given: thing, value, rule, remedy."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from law_library import elbow, law

from cutpoint import InputError, Motor, Robot, simulate
from cutpoint.control import (
    PD,
    PID,
    VDC,
    AdaptiveVDC,
    ComputedTorque,
    DisturbanceObserver,
    ElasticComputedTorque,
    Feedforward,
    FullStateFeedback,
    GravityCompensation,
    Guard,
    Robust,
    SlotineLi,
    SpeedFilter,
    Sum,
    slowest_pole,
    tune,
)
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import robot

A = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
TILTED = A + np.eye(6, k=1)
GAINS = (9.0, 5.0, 3.0, 60.0)


def balls() -> Robot:
    """An arm with a hinge on a ball joint."""
    links = [Link("base"), *(Link(name, 1.0, inertia=np.eye(3)) for name in ("upper", "lower"))]
    joints = [Joint("socket", "spherical", "base", "upper"), Joint("hinge", "revolute", "upper", "lower")]
    return Robot(build("balls", links, joints))


def renamed(*names: str) -> Robot:
    """The elbow with other names of its joints."""
    own = elbow().mechanism
    bodies = [replace(body, joint=replace(body.joint, name=name)) for body, name in zip(own.bodies, names, strict=True)]
    return Robot(replace(own, bodies=tuple(bodies)), dict(zip(names, elbow().drives.values(), strict=True)))


def late(delay: float) -> Robot:
    drives = {name: replace(drive, motor=Motor(0.1, delay=delay)) for name, drive in elbow().drives.items()}
    return elbow().with_drives(drives)


def vdc(**options: Any) -> VDC:
    return VDC(elbow(), *GAINS, **options)


REFUSED = {
    "a body gain that is negative": (
        lambda: vdc(body_gain=-1.0),
        r"VDC: body_gain of body 0 must be positive definite; its least eigenvalue is -1",
    ),
    "a body gain of zero": (lambda: vdc(body_gain=0.0), r"body_gain of body 0 must be positive .*eigenvalue is 0"),
    "the second body's, indefinite": (
        lambda: vdc(body_gain=[A, A - 1.5 * np.eye(6)]),
        r"VDC: body_gain of body 1 must be positive definite; its least eigenvalue is -0.5",
    ),
    "a body gain that is not symmetric": (lambda: vdc(body_gain=TILTED), r"body_gain of body 0 must be .*symmetric"),
    "a body gain that is not finite": (lambda: vdc(body_gain=np.nan * A), r"body_gain of body 0 must be finite"),
    "a body gain of another shape": (
        lambda: vdc(body_gain=[A] * 3),
        r"VDC: body_gain has shape \(3, 6, 6\); it must have one of \(\), \(6,\), \(6, 6\) or \(2, 6, 6\)",
    ),
    "the adaptive law's own name": (lambda: AdaptiveVDC(elbow(), *GAINS, body_gain=-1.0), r"^AdaptiveVDC: body_gain"),
    "position gain zero": (
        lambda: VDC(elbow(), 0.0, 5.0, 3.0, 60.0),
        r"VDC: position_gain = 0.0 must be finite and positive, one for each drive",
    ),
    "another number of gains": (
        lambda: VDC(elbow(), [9.0] * 3, 5.0, 3.0, 60.0),
        r"VDC: position_gain has 3 numbers; it must have one, or one for each of 2 drives",
    ),
    "rates of each joint": (
        lambda: AdaptiveVDC(elbow(), *GAINS, body_rate=[1.0, 2.0]),
        r"^AdaptiveVDC: body_rate has 2 numbers; it must have one$",
    ),
    "a rate below zero": (
        lambda: AdaptiveVDC(elbow(), *GAINS, joint_rate=-1.0),
        r"^AdaptiveVDC: joint_rate = -1.0 must be finite and not negative$",
    ),
    "a gain that is nothing": (lambda: PD(None, 1.0), r"PD: kp must be numbers, one for each drive, got None"),
    "gains that are nothing": (lambda: PD([None] * 2, 1.0), r"PD: kp must be numbers, .*, got \[None, None\]"),
    "gains of different lengths": (lambda: PD([[1.0, 2.0], [3.0]], 1.0), r"PD: kp must be numbers, one for each drive"),
    "body gains of different lengths": (lambda: vdc(body_gain=[[1.0], [2.0, 3.0]]), r"body_gain must be numbers, got"),
    "a reaction that is a list": (
        lambda: Guard(elbow(), PD(1.0, 1.0), reactions={"speed": ["stop"]}),
        r"no reaction is named \['stop'\]; there are: 'hold', 'ramp', 'stop'",
    ),
    "a model of another robot": (
        lambda: vdc(parameters=[1.0, 2.0]),
        r"VDC: parameters must be [0-9]+ numbers, as robot.drive_parameters, got shape \(2,\)",
    ),
    "a model that is a text": (lambda: vdc(parameters="abc"), r"VDC: parameters must be 20 numbers, as .*, got 'abc'"),
    "a model with NaN": (
        lambda: vdc(parameters=np.nan * elbow().drive_parameters),
        r"VDC: parameters must be [0-9]+ numbers, as robot.drive_parameters, got NaN among them",
    ),
    "a tuned law's bound": (lambda: tune(elbow(), 3.0, Robust, bound="x"), r"Robust: bound must be numbers, .*got 'x'"),
    "a tuned law's shaping": (
        lambda: tune(elbow(), 3.0, FullStateFeedback, shaping=[0.5] * 3),
        r"FullStateFeedback: shaping has 3 numbers; it must have one, or one for each of 2 drives",
    ),
    "a time that is a text": (lambda: Guard(elbow(), PD(1.0, 1.0), ramp_time="a"), r"Guard: ramp_time must be one num"),
    "a limit that is a text": (lambda: Guard(elbow(), PD(1.0, 1.0), torque_limit="a"), r"limit must be numbers"),
    "faults without names": (lambda: Guard(elbow(), PD(1.0, 1.0), reactions=5), r"reactions must be a reaction for"),
    "a whole bandwidth below zero": (
        lambda: SpeedFilter(PD(1.0, 1.0), np.int64(-1)),
        r"SpeedFilter: bandwidth -1.0 Hz must be positive",
    ),
    "a negative gain": (
        lambda: VDC(elbow(), 9.0, -5.0, 3.0, 60.0),
        r"VDC: speed_gain = -5.0 must be finite and not neg",
    ),
    "a gain matrix for numbers": (
        lambda: VDC(elbow(), 9.0, A[:2, :2], 3.0, 60.0),
        r"VDC: speed_gain has shape \(2, 2\); it must be a number, or a list of one for each drive",
    ),
    "a filter that stands still": (
        lambda: vdc(derivatives="filter", filter_bandwidth=0.0),
        r"VDC: filter_bandwidth .*pos",
    ),
    "a filter of no bandwidth": (lambda: vdc(derivatives="filter", filter_bandwidth=np.nan), r"VDC: filter_bandwidth"),
    "unknown derivatives": (lambda: vdc(derivatives="both"), r"VDC: derivatives 'both' must be 'model' or 'filter'"),
    "model derivatives on a mixed robot": (
        lambda: VDC(robot("mixed"), *GAINS),
        r"VDC: the drive of '\w+' is rigid, so .* its link; use AdaptiveVDC, or in Python derivatives='filter'",
    ),
    "model derivatives while learning": (
        lambda: AdaptiveVDC(elbow(), *GAINS, derivatives="model"),
        r"AdaptiveVDC: derivatives must be 'filter': a model that is being learnt has no jerk",
    ),
    "unknown update": (
        lambda: AdaptiveVDC(elbow(), *GAINS, update="fast"),
        r"update 'fast' must be 'projection' or 'nat",
    ),
    "a negative rate": (lambda: AdaptiveVDC(elbow(), *GAINS, body_rate=-1.0), r"AdaptiveVDC: body_rate = -1.0 must be"),
    "two rates": (
        lambda: AdaptiveVDC(elbow(), *GAINS, joint_rate=[1.0, 2.0]),
        r"AdaptiveVDC: joint_rate has 2 numbers",
    ),
    "numbers that could turn negative": (
        lambda: AdaptiveVDC(elbow(), *GAINS, uncertainty=1.5),
        r"AdaptiveVDC: uncertainty .*1.5.* must be .*(below|less than|at most) 1",
    ),
    "a floating base": (lambda: VDC(robot("floating"), *GAINS), r"VDC: a floating base has no motor"),
    "gravity compensation of a floating base": (
        lambda: GravityCompensation(robot("floating")),
        r"GravityCompensation: a floating base has no motor \('root_joint'\)",
    ),
    "tuning a floating base": (lambda: tune(robot("floating"), 3.0), r"tune: a floating base has no motor"),
    "tuning a ball joint": (lambda: tune(balls(), 3.0), r"tune: a spherical joint has no motor \('socket'\)"),
    "a pole of a ball joint": (
        lambda: slowest_pole(balls(), PD([1.0], [1.0]), [0.0] * 5, 1e-3),
        r"slowest_pole: a spherical joint has no motor \('socket'\)",
    ),
    "elastic computed torque of a rigid drive": (
        lambda: ElasticComputedTorque(robot("rigid"), 10.0),
        r"ElasticComputedTorque: the drive of 'joint1' is rigid; give it a compliance and a rotor, or",
    ),
    "elastic computed torque tuned for a rigid drive": (
        lambda: tune(robot("mixed"), 5.0, ElasticComputedTorque),
        r"ElasticComputedTorque: the drive of '.*' is rigid; give it a compliance and a rotor, or",
    ),
    "shaping that makes rotors heavier": (
        lambda: FullStateFeedback(elbow(), 9.0, 1.0, 1.5),
        r"FullStateFeedback: shaping \[1.5 1.5\] must be at most 1",
    ),
    "shaping away the rotor": (
        lambda: FullStateFeedback(elbow(), 9.0, 1.0, 0.0),
        r"shaping = 0.0 must be finite and pos",
    ),
    "a robust law without width": (
        lambda: Robust(elbow(), 9.0, 5.0, 1.0, 0.0),
        r"Robust: width = 0.0 must be .*positive",
    ),
    "a PID without limit": (lambda: PID([9.0] * 2, 1.0, 1.0, 0.0), r"PID: limit = 0.0 must be finite and positive"),
    "a side that there is not": (
        lambda: ComputedTorque(elbow(), 9.0, 1.0, side="both"),
        r"side 'both' must be 'motor' or 'l",
    ),
    "an observer's negative gain": (
        lambda: DisturbanceObserver(elbow(), law("PD"), -1.0),
        r"DisturbanceObserver: gain = -1.0",
    ),
    "an observer whose robot and law are exchanged": (
        lambda: DisturbanceObserver(law("PD"), elbow(), 30.0),
        r"DisturbanceObserver: robot must be a Robot.*, got PD\(",
    ),
    "an observer around no law": (
        lambda: DisturbanceObserver(elbow(), elbow(), 30.0),
        r"controller .*Robot.* has no step\(memory, measurement, reference\)",
    ),
    "a guard whose law and robot are exchanged": (
        lambda: Guard(law("PD"), elbow()),
        r"Guard: robot must be a Robot.*, got PD\(",
    ),
    "a guard around no law": (lambda: Guard(elbow(), elbow()), r"has no step\(memory, measurement, reference\)"),
    "a speed filter of a class": (lambda: SpeedFilter(PD), r"controller PD is a class; pass an instance"),
    "gravity of a law": (lambda: GravityCompensation(law("PD")), r"GravityCompensation: robot must be a Robot"),
    "a speed filter that stands still": (
        lambda: SpeedFilter(law("PD"), 0.0),
        r"SpeedFilter: bandwidth 0.0 Hz must be positive",
    ),
    "parameters of bending drives for a rigid law": (
        lambda: SlotineLi(elbow(), 9.0, 5.0, parameters=elbow().drive_parameters),
        r"SlotineLi: parameters must be those of rigid drives; give a robot whose drives are rigid",
    ),
    "tuning an unknown law": (
        lambda: tune(elbow(), 3.0, SpeedFilter),
        r"no law that can be tuned is named 'SpeedFilter'.*there are: 'PD', .*'SuperTwisting'",
    ),
    "tuning for no bandwidth": (lambda: tune(elbow(), np.nan), r"tune: bandwidth nan .*must be positive"),
    "tuning without damping": (lambda: tune(elbow(), 3.0, damping=0.0), r"tune: damping 0.0 .*must be positive"),
    "tuning without a period": (
        lambda: tune(elbow(), 3.0, control_period=-1e-3),
        r"tune: control_period -0.001 .*must be",
    ),
    "tuning for six bandwidths": (lambda: tune(elbow(), [5.0] * 6), r"tune: bandwidth must be one number, Hz, got \["),
    "tuning in words": (lambda: tune(elbow(), "4"), r"tune: bandwidth must be one number, Hz, got '4'"),
    "tuning nothing": (lambda: tune(None, 4.0), r"tune: robot must be a Robot .*, got None"),
    "tuning a law by its name": (lambda: tune(elbow(), 4.0, "VDC"), r"tune: law must be a law's class, .* got 'VDC'"),
    "tuning a law that is made": (lambda: tune(elbow(), 4.0, law("PD")), r"tune: law must be a law's class, .* PD\("),
    "a pole at no period": (
        lambda: slowest_pole(elbow(), law("PD"), [0.0] * 2, 0),
        r"slowest_pole: control_period 0.0 s must be positive and finite",
    ),
    "a pole at a period gone by": (
        lambda: slowest_pole(elbow(), law("PD"), [0.0] * 2, -1e-3),
        r"_period -0.001 s must",
    ),
    "a pole at an unknown period": (
        lambda: slowest_pole(elbow(), law("PD"), [0.0] * 2, np.nan),
        r"_period nan s must",
    ),
    "a pole at an endless period": (
        lambda: slowest_pole(elbow(), law("PD"), [0.0] * 2, np.inf),
        r"_period inf s must",
    ),
    "a pole of a class": (
        lambda: slowest_pole(elbow(), PD, [0.0] * 2, 1e-3),
        r"controller PD is a class; pass an inst",
    ),
    "a guard around a law for another number of drives": (
        lambda: Guard(elbow(), PID([9.0] * 3, 1.0, 1.0, 1.0) + law("PD")),
        r"PID is for 3 drives, but the robot has 2: make it for as many",
    ),
    "an observer around a law for one drive": (
        lambda: DisturbanceObserver(elbow(), SpeedFilter(PD(1.0, 1.0)), 30.0),
        r"PD is for 1 drive, but the robot has 2",
    ),
    "a pole of a law for another robot": (
        lambda: slowest_pole(elbow(), SpeedFilter(law("PD") + PD(1.0, 1.0)), [0.0] * 2, 1e-3),
        r"PD is for 1 drive, but the robot has 2",
    ),
    "a pole where commands come too late": (
        lambda: slowest_pole(late(5e-3), law("PD"), [0.0] * 2, 1e-3),
        r"slowest_pole: joint 'shoulder': its motor's delay 0.005 s must not exceed .* 0.001 s; is it in ms\?  State",
    ),
    "a pole of a law that commands no number": (
        lambda: slowest_pole(elbow(), lambda memory, m, r: (memory, m.q + np.nan), [0.0] * 2, 1e-3),
        r"slowest_pole: <lambda> commands or remembers a number that is not finite at rest",
    ),
    "tuning what is found by tuning": (
        lambda: tune(elbow(), 3.0, kp=1.0),
        r"tune: kp of PD is determined by tune; leave it out",
    ),
    "tuning with an unknown option": (
        lambda: tune(elbow(), 3.0, sides="motor"),
        r"no option of PD is named 'sides'.*'side'",
    ),
    "tuning at several poses": (lambda: tune(elbow(), 3.0, q=[[0.0] * 2]), r"q has shape \(1, 2\); give a single"),
    "a sum of nothing": (
        lambda: Sum(()),
        r"Sum: it has no parts, so its number of drives is unknown; give it at least one law",
    ),
    "a model whose joints are in another order": (
        lambda: simulate(elbow(), tune(elbow(), 3.0) + Feedforward(renamed("elbow", "shoulder")), duration=0.01),
        r"Feedforward: the joints of its robot are 'elbow', 'shoulder', but those of this one 'shoulder', 'elbow'",
    ),
    "poles with the model of another robot": (
        lambda: slowest_pole(elbow(), tune(renamed("a", "b"), 3.0, ComputedTorque), [0.0] * 2, 1e-3),
        r"ComputedTorque: the joints of its robot are 'a', 'b', but those of this one 'shoulder', 'elbow'",
    ),
    "tuning elsewhere": (lambda: tune(elbow(), 3.0, q=[0.0]), r"tune: q has shape \(1,\)"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_law_that_makes_no_sense_is_refused_with_thing_value_and_rule(name):
    make, message = REFUSED[name]
    with pytest.raises(InputError, match=message):
        make()

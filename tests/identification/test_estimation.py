"""Models from logs: intervals hold the truth as often as they say, bodies exist, and new motions are predicted."""

import re
import sys
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom
from simulated_logs import NOISE, Known, exists, known_arm, recorded
from two_joints import two_joints

from cutpoint import Coulomb, Drive, Grease, LinearSpring, Robot, Rotor, Stribeck
from cutpoint.errors import CutpointError, InputError
from cutpoint.formats import parse_urdf
from cutpoint.identification import Recording
from cutpoint.identification.conditioning.motion import motion_of, slide_with_motors, still_joints
from cutpoint.identification.rigid.bodies import bodies_of, with_parameters
from cutpoint.identification.rigid.identify_rigid import Method, RigidEstimate, identify_rigid
from cutpoint.identification.rigid.least_squares import least_squares
from cutpoint.identification.rigid.physical import Solver
from cutpoint.identification.rigid.regression import Regression
from cutpoint.identification.rigid.rigid_robot import RigidModel, stated_laws
from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from cutpoint.trajectories import from_samples

CUTOFF = 40.0
ARMS = 20


@pytest.mark.parametrize("method", ["huber", "weighted", "instrumental"])
def test_intervals_hold_the_truth_as_often_as_they_say(method: Method):
    hits = []
    for seed in range(ARMS):
        arm = known_arm(seed, 2 + seed % 2)
        found = identify_rigid(
            arm.file, recorded(arm.robot, seed), friction="stated", method=method, solver="lmi_trace", cutoff=CUTOFF
        )
        base, truth = arm.base()
        true = dict(zip(base.names, truth, strict=True)) | {p.name: p.prior for p in found.parameters[truth.size :]}
        hits += [p.low <= true[p.name] <= p.high for p in found.parameters if np.isfinite(p.high)]
    # hits of one arm are related: as if a third of them were not, the count lies within what chance allows
    count, hit = len(hits) // 3, sum(hits) // 3
    assert binom.cdf(hit, count, 0.95) > 0.005
    assert binom.sf(hit - 1, count, 0.95) > 0.005


@pytest.mark.parametrize(("solver", "seed"), [("lmi", 0), ("lmi", 1), ("lmi_trace", 1), ("log_cholesky", 0)])
def test_identified_bodies_exist_and_predict_new_motions(solver: str, seed: int):
    arm = known_arm(seed)
    found = identify_rigid(arm.file, recorded(arm.robot, seed), solver=solver, cutoff=CUTOFF)  # type: ignore[arg-type]
    assert exists(found.robot)
    assert (found.model.rotors >= 0.0).all()
    new = recorded(arm.robot, seed + 100)
    floor = truly(arm.robot, arm.file, new) - new["torque"]
    missed = found.prediction(new, CUTOFF) - new["torque"]
    known = np.isfinite(missed).all(axis=1)
    assert (missed[known].std(axis=0) < 2.0 * floor[known].std(axis=0)).all()
    assert (found.noise < NOISE).all()


def truly(robot: Robot, file: Robot, recording: Recording) -> np.ndarray:
    """What the true parameters predict of a recording."""
    motion = motion_of(robot, recording, CUTOFF)
    rotors = np.array([float(drive.reflected_inertia) for drive in robot.drives.values()])
    laws = stated_laws(robot, motion)
    still, on_motor = np.zeros(len(laws)), slide_with_motors(file)
    return RigidModel(robot.inertial_parameters, rotors, still, laws, {}, on_motor, {}).torque(file, motion)


@pytest.mark.parametrize("seed", [2, 5, 8])
def test_two_ways_to_bodies_that_exist_agree(seed: int):
    arm = known_arm(seed)
    recording = recorded(arm.robot, seed)
    by_cones, by_factors = (
        identify_rigid(arm.file, recording, friction="stated", cutoff=CUTOFF, solver=solver)
        for solver in ("lmi_trace", "log_cholesky")
    )
    assert np.allclose(by_cones.model.inertial, by_factors.model.inertial, rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("smoothing", [0.03, 0.1])
def test_the_shape_of_friction_is_found_and_no_richer_law_is_taken(smoothing: float):
    arm = known_arm(1)
    drives = {
        joint: replace(drive, link_friction=Coulomb(1.5, 0.3, smoothing)) for joint, drive in arm.robot.drives.items()
    }
    found = identify_rigid(arm.file, recorded(arm.robot.with_drives(drives), 1), cutoff=CUTOFF)
    assert {choice.family for choice in found.friction} == {"coulomb"}
    assert [choice.law.smoothing for choice in found.friction] == pytest.approx([smoothing] * 3, rel=0.2)
    assert "chosen among (RMS error of held-out torques, N m) coulomb" in str(found.friction[0])


@pytest.mark.parametrize("method", ["huber", "instrumental"])
def test_variances_grow_with_the_square_of_what_rotors_are_known_to(method: Method):
    arm = known_arm(1, 2)
    recording = recorded(arm.robot, 1)
    variances = []
    for error in (0.0, 0.01, 0.02):
        errors = dict.fromkeys(arm.file.joints, error)
        found = identify_rigid(arm.file, recording, friction="stated", method=method, rotors=False, rotor_errors=errors)
        variances.append(np.array([(p.high - p.low) ** 2 for p in found.parameters]))
    none, once, twice = variances
    assert (once >= none).all()
    assert (once > 1.1 * none).any()
    assert twice - none == pytest.approx(4.0 * (once - none), rel=1e-6, abs=1e-9 * none.max())


def test_some_rotors_are_sought_beside_others_that_are_known():
    arm = known_arm(1, 3)
    first, *others = arm.robot.joints
    drives = {joint: replace(arm.file.drives[joint], rotor=arm.robot.drives[joint].rotor) for joint in others}
    file = arm.file.with_drives({first: replace(arm.file.drives[first], rotor=Rotor(1e-4)), **drives})
    found = identify_rigid(file, recorded(arm.robot, 1), friction="stated", rotors=[first], cutoff=CUTOFF)
    reflected = [float(arm.robot.drives[joint].reflected_inertia) for joint in others]
    assert found.model.rotors[1:].tolist() == reflected
    base, truth = arm.base([first])
    assert {p.name for p in found.parameters} >= set(base.names)
    for name, true in zip(base.names, truth.tolist(), strict=True):
        assert abs(found[name].value - true) < 3.0 * (found[name].high - found[name].value)


@pytest.mark.parametrize("method", ["huber", "instrumental"])
def test_intervals_know_that_the_shape_of_friction_was_sought(method: Method):
    arm = known_arm(1, 2)
    recording = recorded(arm.robot, 1)
    chosen = identify_rigid(arm.file, recording, method=method, cutoff=CUTOFF)
    laws = {choice.joint: choice.law for choice in chosen.friction}
    given = identify_rigid(arm.file, recording, friction=laws, method=method, cutoff=CUTOFF)
    for joint in laws:
        name = f"coulomb.{joint}"
        assert chosen[name].value == pytest.approx(given[name].value, rel=1e-6)
        assert chosen[name].high - chosen[name].low > given[name].high - given[name].low


def test_a_joint_that_does_not_move_is_said_to_tell_nothing():
    arm = known_arm(0)
    recording = recorded(arm.robot, 0)
    q, torque = (np.array(recording[name]) for name in ("q", "torque"))
    q[:, 2] = q[0, 2]
    still = Recording(recording.time, recording.joints, q=q, torque=torque)
    found = identify_rigid(arm.file, still, friction="stated", cutoff=CUTOFF)
    joint = still.joints[2]
    assert not found[f"viscous.{joint}"].told
    assert f"viscous.{joint}: this motion does not excite it" in " ".join(found.untold)
    assert exists(found.robot)


@pytest.mark.parametrize("late", [-0.006, 0.0, 0.006])
def test_torques_that_come_late_are_said_with_by_how_much(late: float):
    arm = known_arm(1, 2)
    recording = recorded(arm.robot, 1)
    time, torque = recording.time, np.array(recording["torque"])
    moved = np.column_stack([np.interp(time - late, time, x) for x in torque.T])
    doubts = identify_rigid(arm.file, replace(recording, torque=moved), friction="stated", cutoff=CUTOFF).doubts
    said = [re.match(r"torques come (\S+) \+- (\S+) ms (later|earlier) than the motion", doubt) for doubt in doubts]
    found = [(1e-3 if x[3] == "later" else -1e-3) * float(x[1]) for x in said if x]
    assert found == pytest.approx([late] if late else [], abs=1.5e-3)


def test_torques_of_one_joint_that_come_late_are_said_with_its_name():
    arm = known_arm(1, 3)
    recording = recorded(arm.robot, 1)
    torque = np.array(recording["torque"])
    torque[:, 1] = np.interp(recording.time - 0.01, recording.time, torque[:, 1])
    doubts = identify_rigid(arm.file, replace(recording, torque=torque), friction="stated", cutoff=CUTOFF).doubts
    (said,) = [doubt for doubt in doubts if "than the motion they belong to" in doubt]
    found = re.match(rf"torques of {recording.joints[1]} come (\S+) \+- \S+ ms later .* unlike those of other", said)
    assert found and float(found[1]) == pytest.approx(10.0, abs=1.5)
    assert said.endswith("}, ('torque', 'current')) moves only these")


def test_a_joint_whose_torques_come_in_time_is_not_said_to_be_late():
    arm = known_arm(1, 3)
    recording = recorded(arm.robot, 1)
    torque = np.array(recording["torque"])
    for j in (0, 2):
        torque[:, j] = np.interp(recording.time - 0.01, recording.time, torque[:, j])
    doubts = identify_rigid(arm.file, replace(recording, torque=torque), friction="stated", cutoff=CUTOFF).doubts
    said = [doubt for doubt in doubts if "than the motion they belong to" in doubt]
    assert said and all(doubt.startswith(f"torques of all joints but {recording.joints[1]} come") for doubt in said)


def test_instruments_that_tell_little_are_said_to():
    arm = known_arm(1, 3)
    recording = recorded(arm.robot, 1)
    methods: tuple[tuple[Method, float], ...] = (("instrumental", 10.0), ("instrumental", 2.0), ("huber", 2.0))
    found = [
        identify_rigid(arm.file, recording, friction="stated", method=method, bandwidth=width, cutoff=CUTOFF)
        for method, width in methods
    ]
    assert ["their motion is" in " ".join(each.notes) for each in found] == [False, True, False]
    assert found[1].told < found[2].told


def test_too_few_torques_are_said_to_be_so_for_gaps():
    arm = known_arm(1, 3)
    whole = recorded(arm.robot, 1)
    torque = np.array(whole["torque"])
    torque[np.arange(len(torque)) % 2400 > 560] = np.nan
    with pytest.raises(InputError, match=r"torques \(gaps leave \d+ of \d+ means\) are too few .* without gaps"):
        identify_rigid(arm.file, replace(whole, torque=torque), friction="stated", cutoff=CUTOFF, bandwidth=8.0)


def test_a_file_of_placeholders_is_said_to_hold_the_bodies_back():
    arm = known_arm(1, 2)
    bodies = bodies_of(arm.file)
    tiny = np.tile(1e-5 * np.eye(4), (bodies.count, 1, 1))
    file = Robot(with_parameters(arm.file.mechanism, bodies.parameters(tiny)), dict(arm.file.drives))
    notes = [
        identify_rigid(x, recorded(arm.robot, 1), friction="stated", cutoff=CUTOFF).notes for x in (arm.file, file)
    ]
    strained = [[note for note in each if "bodies miss the intervals of" in note] for each in notes]
    assert not strained[0] and len(strained[1]) == 1
    assert re.search(r"torque errors are larger for it \(\d+\.\d\d times at \w+", strained[1][0])


def test_outliers_do_not_lead_huber_astray():
    arm = known_arm(1, 2)
    recording = recorded(arm.robot, 1)
    torque = np.array(recording["torque"])
    torque[2000:2300] += 20.0
    hit = replace(recording, torque=torque)
    misses = {}
    methods: tuple[Method, ...] = ("weighted", "huber")
    for method in methods:
        found = identify_rigid(arm.file, hit, friction="stated", method=method, cutoff=CUTOFF)
        told = [p for p in found.parameters if p.name.startswith("coulomb")]
        misses[method] = max(abs(p.value - p.prior) for p in told)
    assert misses["huber"] < 0.2 * misses["weighted"]


def test_currents_are_torques_by_the_constants_that_are_given():
    arm = known_arm(0)
    recording = recorded(arm.robot, 0)
    constants = dict(zip(arm.file.joints, (2.0, 4.0, 8.0), strict=True))
    order = [arm.file.joints.index(joint) for joint in recording.joints]
    current = recording["torque"] / np.array(list(constants.values()))[order]
    asked = {"friction": "stated", "solver": "lmi_trace", "cutoff": CUTOFF}
    whole = identify_rigid(arm.file, recording, **asked)
    found = identify_rigid(
        arm.file, replace(recording, torque=None, current=current), torque_constants=constants, **asked
    )
    assert [p.value for p in found.parameters] == pytest.approx([p.value for p in whole.parameters], rel=1e-9, abs=1e-9)


LINK, MOTOR = Coulomb(2.0, 0.0, 0.05), Coulomb(1.0, 0.5, 0.05, per_load=0.15)
WHOLE = Coulomb(3.0, 0.5, 0.05, per_load=0.15)


def test_a_joint_that_errs_slowly_is_as_uncertain_beside_quick_ones_as_alone():
    rng, M, n = np.random.default_rng(3), 2000, 6
    time = 0.05 * np.arange(M)
    slow = lfilter([np.sqrt(1.0 - 0.975**2)], [1.0, -0.975], rng.normal(size=2 * M))[M:]
    columns, torque = np.zeros((M, n, 2 * n)), rng.normal(size=(M, n))
    for j in range(n):
        columns[:, j, 2 * j], columns[:, j, 2 * j + 1] = 1.0, np.sin(0.1257 * (1 + j) * time)
    torque[:, 0] = slow
    names = tuple(f"{k}" for k in range(2 * n))
    both = least_squares(Regression(names, columns, torque, time), "weighted")
    alone = least_squares(Regression(names[:2], columns[:, :1, :2], torque[:, :1], time), "weighted")
    assert both.spread.deviations()[:2] == pytest.approx(alone.spread.deviations(), rel=0.05)


@pytest.mark.parametrize("seed", [0, 4])
@pytest.mark.parametrize("stated", [True, False])
def test_friction_of_links_is_load_of_their_drives(seed: int, stated: bool):
    """Taken for the motor's, it turns what grows with load into half of it, and moments leave their intervals."""
    arm = known_arm(seed)

    def with_friction(robot: Robot, **laws: Coulomb | None) -> Robot:
        sides: dict[str, Any] = {"rotor": Rotor(1e-7), **laws}
        return robot.with_drives({joint: replace(drive, **sides) for joint, drive in robot.drives.items()})

    true = with_friction(arm.robot, link_friction=LINK, motor_friction=MOTOR)
    sides = (
        {"link_friction": LINK, "motor_friction": MOTOR} if stated else {"link_friction": None, "motor_friction": WHOLE}
    )
    file = with_friction(arm.file, **sides)
    known = None if stated else dict.fromkeys(file.joints, LINK)
    found = identify_rigid(
        file, recorded(true, seed), friction="stated", solver="lmi_trace", cutoff=CUTOFF, link_friction=known
    )
    _, truth = Known(true, file).base()
    for p, value in zip(found.parameters, truth, strict=False):
        assert not p.told or abs(p.value - value) < 2.0 * (p.high - p.value)
    for joint in file.joints:
        assert found[f"per_load.{joint}"].value == pytest.approx(0.15, abs=0.015)


def test_a_rotor_that_weighs_nothing_is_not_the_files():
    file = known_arm(0).file
    laws = {joint: Coulomb(1.0, 0.5, 0.05) for joint in file.joints}
    model = RigidModel(file.inertial_parameters, np.zeros(3), np.zeros(3), laws, {}, slide_with_motors(file), {})
    assert [float(drive.reflected_inertia) for drive in model.robot(file).drives.values()] == [0.0] * 3


@pytest.mark.parametrize("solver", ["lmi", "log_cholesky"])
def test_rotors_that_no_file_states_may_be_far_heavier_than_a_light_wrist(solver: Solver):
    arm = known_arm(0).robot
    light = with_parameters(arm.mechanism, arm.inertial_parameters * np.repeat([1.0, 1.0, 1e-3], 10))
    robot = Robot(light, arm.drives)
    file = Robot(light, {joint: replace(drive, rotor=None) for joint, drive in arm.drives.items()})
    found = identify_rigid(file, recorded(robot, 0), friction="stated", solver=solver, cutoff=CUTOFF)
    reflected = float(robot.drives["joint2"].reflected_inertia)
    assert np.diag(robot.mass_matrix(robot.neutral()))[2] - reflected < 0.01 * reflected
    assert found.model.rotors[2] == pytest.approx(reflected, rel=0.02)
    assert not any("placeholders" in note for note in found.notes)


def test_no_side_of_a_drive_has_less_friction_at_rest_than_in_motion():
    """The file states Coulomb's law for the link: all of what is more at rest is the motor's."""
    sides = {"link_friction": Coulomb(1.2, 0.9, 0.1), "motor_friction": Stribeck(2.4, 3.6, 2.4, 0.4, 0.1)}
    file = two_joints().with_drives(dict.fromkeys(("shoulder", "elbow"), Drive(100.0, Rotor(2e-5), **sides)))
    bodies, still, rng = file.inertial_parameters, np.zeros(2), np.random.default_rng(0)
    for coulomb, more in zip(rng.uniform(1.0, 8.0, 300).tolist(), rng.uniform(0.0, 3.0, 300).tolist(), strict=True):
        law = Stribeck(coulomb, coulomb + more, 2.0, 0.4, 0.1)
        model = RigidModel(bodies, still, still, dict.fromkeys(file.joints, law), {}, slide_with_motors(file), {})
        drive = model.robot(file).drives["elbow"]
        assert drive.link_friction.static == drive.link_friction.coulomb  # type: ignore[union-attr]
        both = drive.link_friction.static + drive.motor_friction.static  # type: ignore[union-attr]
        assert both == pytest.approx(law.static, rel=1e-14)


def test_bodies_are_sought_near_the_files_with_the_rotors_that_their_links_do_not_hold():
    rotor = Rotor(2e-5, in_link_inertia=False, mass=2.0, transverse=1e-5)
    robot = two_joints().with_drives(dict.fromkeys(("shoulder", "elbow"), Drive(100.0, rotor)))
    near = bodies_of(robot).parameters(np.repeat(np.eye(4)[None], 2, axis=0))
    assert near[::10] == pytest.approx([6.0, 2.5])  # the base carries the shoulder's


def test_what_the_model_has_otherwise_than_drives_state_is_said():
    arm = known_arm(0, 2)
    first = replace(arm.file.drives["joint0"], rotor=Rotor(2e-5, coupling="full"))
    laws = {"joint0": Coulomb(1.0, 0.5, 0.05), "joint1": Coulomb(1.0, 0.5, 0.05, per_load=0.1)}
    second = replace(arm.file.drives["joint1"], rotor=Rotor(0.0))
    file, recording = arm.file.with_drives({"joint0": first, "joint1": second}), recorded(arm.robot, 0)
    found = identify_rigid(file, recording, friction=laws, rotors=False, cutoff=CUTOFF)
    assert any(words.startswith("at joint0, rotors are fully coupled") for words in found.notes)
    assert any(words.startswith("at joint1, friction grows with load") for words in found.notes)
    assert found.robot.drives["joint1"].motor_friction is not None
    # the fit went by the links' speeds, and so does what it predicts
    motors = replace(recording, theta=1.1 * np.array(recording["q"]))
    own, other = (found.prediction(each, CUTOFF)[:, 1] for each in (recording, motors))
    assert np.array_equal(own, other, equal_nan=True)


def wheel(mass: float, inertia: float) -> Robot:
    link = Link("axle", mass, com=np.zeros(3), inertia=inertia * np.diag([0.5, 0.5, 1.0]))
    axle = Joint("axle", "continuous", "base", "axle", axis=np.array([0.0, 0.0, 1.0]))
    return Robot(build("bench", [Link("base"), link], [axle]), {"axle": Drive(ratio=100.0, rotor=Rotor(1e-7))})


def test_bodies_that_are_small_beside_the_robot_are_as_their_file_states():
    parameters = bodies_of(wheel(0.1, 2e-5)).parameters(np.eye(4)[None])
    assert parameters[[0, 9]] == pytest.approx([0.1, 2e-5])


def test_a_joint_that_moves_little_beside_one_that_turns_often_does_not_stand_still():
    time, arm = 1e-3 * np.arange(8000), known_arm(0, 2).file
    q = np.column_stack([90.0 * time, 0.25 * np.sin(2.0 * np.pi * time)])
    recording = Recording(time, arm.joints, q=q, torque=np.ones_like(q))
    assert still_joints(arm, motion_of(arm, recording, CUTOFF)) == []


def test_times_are_those_of_the_recording():
    arm = known_arm(0, 2)
    recording = recorded(arm.robot, 0)
    whole, part = (
        identify_rigid(arm.file, each, friction="stated", cutoff=CUTOFF)
        for each in (recording, recording.between(5.0, 10.0))
    )
    assert 5.0 < part.times[0] < 5.5 and part.times[-1] == pytest.approx(whole.times[-1], abs=0.2)


def test_viscous_friction_stays_that_of_the_files_temperature():
    arm = known_arm(0, 2)
    grease = Grease(45.0, 0.03)
    warm = {j: replace(d, link_friction=Coulomb(1.0, 2.0, 0.15, grease=grease)) for j, d in arm.robot.drives.items()}
    file = arm.file.with_drives(
        {j: replace(d, link_friction=Coulomb(1.0, 2.0, 0.03, grease=grease)) for j, d in arm.file.drives.items()}
    )
    found = identify_rigid(file, recorded(arm.robot.with_drives(warm), 0), cutoff=CUTOFF)
    for joint in file.joints:
        assert found[f"viscous.{joint}"].value == pytest.approx(2.0, rel=0.1)


class OwnFriction:
    def torque(self, speed: Any, load: Any = 0) -> Any:
        return 2.0 * speed

    def resistance(self, speed: Any, load: Any = 0) -> Any:
        return 2.0

    def share_of_load(self, speed: Any) -> Any:
        return 0.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"instruments": "reference.csv", "method": "instrumental"},
            r"identify_rigid: instruments must be a Recording .*, got 'reference.csv'",
        ),
        (
            {"rotor_errors": [0.1]},
            r"rotor_errors must be a mapping of joint names to standard deviations, kg m2, got \[0.1\]",
        ),
        ({"rotor_errors": {"joint0": np.inf}, "rotors": False}, r"rotor_errors\['joint0'\] inf kg m2 must be finite"),
        ({"rotor_errors": {"joint0": 0.1}}, r"rotor_errors\['joint0'\] is for a rotor that is sought"),
        (
            {"friction": {"joint0": "coulomb"}},
            r"friction\['joint0'\] must be Coulomb's or Stribeck's law, got 'coulomb'",
        ),
        ({"link_friction": {"elbow": LINK}}, r"no driven joint is named 'elbow'"),
        ({"link_friction": {"joint0": 3.0}}, r"link_friction\['joint0'\] must be a law of friction, got 3.0"),
        ({"link_friction": [LINK]}, r"link_friction must be a mapping of joint names to laws"),
        ({"method": "least"}, r"no method of identification is named 'least'; there are: 'ordinary', 'weighted'"),
        ({"solver": "sdp"}, r"no solver is named 'sdp'"),
        ({"prior_spread": 0.0}, r"prior_spread 0.0 must be a positive share"),
        ({"level": 95.0}, r"level 95.0 must lie between 0 and 1, such as 0.95"),
        ({"friction": "viscous"}, r"friction 'viscous' must be 'choose', 'stated', or laws by joint"),
        ({"friction": {"elbow": Coulomb(1.0, 0.0, 0.1)}}, r"no driven joint is named 'elbow'"),
        ({"bandwidth": 600.0}, r"bandwidth 600.0 Hz must lie between 0 and 500 Hz, half the sampling rate"),
        ({"torque_constants": {"joint0": 1.0}}, r"the recording holds no current; there are: q, torque"),
    ],
)
def test_what_cannot_be_identified_is_refused(options: dict[str, object], message: str):
    arm = known_arm(0)
    with pytest.raises(InputError, match=message):
        identify_rigid(arm.file, recorded(arm.robot, 0), **({"friction": "stated", "cutoff": CUTOFF} | options))  # type: ignore[arg-type]


def test_friction_of_a_law_of_ones_own_is_refused():
    arm = known_arm(0, 2)
    own: Any = OwnFriction()
    file = arm.file.with_drives({"joint1": replace(arm.file.drives["joint1"], link_friction=own)})
    with pytest.raises(
        InputError, match=r"friction of 'joint1' is OwnFriction, whose parameters cannot be identified: state"
    ):
        identify_rigid(file, recorded(arm.robot, 0))


def test_a_joint_that_was_not_recorded_is_named():
    arm = known_arm(0, 2)
    with pytest.raises(InputError, match=r"joint 'joint1' was not recorded; there are: 'joint0'"):
        identify_rigid(arm.file, recorded(arm.robot, 0).joint("joint0"))


def test_all_joints_that_were_not_recorded_are_named_at_once():
    arm = known_arm(2, 3)
    log = recorded(arm.robot, 2).joint("joint0")
    rule = r"joints '.*', '.*' were not recorded; there are: 'joint0'; map their .* lock them"
    with pytest.raises(InputError, match=rule):
        identify_rigid(arm.file, log)


def test_a_solver_that_is_not_installed_is_named_before_any_work(monkeypatch: pytest.MonkeyPatch) -> None:
    known = known_arm(0, 2)
    few = Recording(np.arange(3) * 1e-3, known.file.joints, q=np.zeros((3, 2)), torque=np.zeros((3, 2)))
    with pytest.raises(InputError, match=r"samples|moves"):
        identify_rigid(known.file, few)
    monkeypatch.setitem(sys.modules, "clarabel", None)
    with pytest.raises(CutpointError, match=r"pip install 'cutpoint\[identify\]', or use .*--solver log_cholesky"):
        identify_rigid(known.file, few)


def test_friction_that_differs_by_direction_does_not_stand_for_an_offset():
    """On a lift, whose weight is constant, a torque's offset leaves its mass untold, whatever law friction has."""
    text = (
        '<robot name="lift"><link name="base"/><link name="plate"><inertial><mass value="1.2"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="z" type="prismatic"><parent link="base"/><child link="plate"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="100" velocity="2"/></joint></robot>'
    )
    lift = Robot(parse_urdf(text)).with_drives({"z": Drive(ratio=100.0, rotor=Rotor(1e-5))})
    time = 2e-3 * np.arange(5000)
    q, v, a = (0.1 * (2.0 * np.pi * 0.5) ** k * np.sin(np.pi * time + k * np.pi / 2)[:, None] for k in range(3))
    law = Coulomb(4.0, 8.0, 0.01)
    force = lift.inverse_dynamics(q, v, a) + law.torque(v) + 5.0
    force += 0.02 * np.random.default_rng(0).normal(size=force.shape)
    leaning = Coulomb(1.0, 1.0, 0.002, asymmetry=0.1)
    found = identify_rigid(lift, Recording(time, ("z",), q=q, torque=force), friction={"z": leaning})
    masses = [p for p in found.parameters if p.name.startswith(("m.", "offset"))]
    assert masses and not any(p.told for p in masses)


def lift_log(noise: float, share: float) -> tuple[Robot, Recording]:
    """A lift that bends, its file with this share of mass and rotor, and a log with this noise of the torque, N."""

    def lift(share: float) -> Robot:
        cart = Link("cart", mass=4.0 * share, com=np.zeros(3), inertia=0.05 * np.eye(3))
        up = Joint("up", "prismatic", "base", "cart", axis=(0.0, 0.0, 1.0))
        return Robot(
            build("lift", [Link("base"), cart], [up]), {"up": Drive(300.0, Rotor(1e-4 * share), LinearSpring(2e6))}
        )

    true, file = lift(1.0), lift(share)
    time, rng = 1e-3 * np.arange(8001), np.random.default_rng(0)
    waves = [(0.1, 0.5), (0.05, 1.3), (0.005, 4.3)]
    away = np.sin(np.pi * time / 8.0) ** 2 * sum(x * np.sin(2.0 * np.pi * f * time) for x, f in waves)
    motion = from_samples(time, away[:, None], bandwidth=30.0)(time)
    exact = true.elastic_inverse_dynamics(*motion)
    q, theta = (x + 1e-7 * rng.normal(size=x.shape) for x in (motion.q, exact.theta))
    force = exact.motor_torque + noise * rng.normal(size=exact.motor_torque.shape)
    return file, Recording(time, ("up",), q=q, theta=theta, torque=force)


def test_how_springs_wind_does_not_tell_a_lifts_mass_from_an_offset():
    """Two encoders differ by the spring and by their noise: masses came out a fifth off, far beyond their intervals."""
    found = identify_rigid(*lift_log(0.01, 1.0), solver="lmi_trace")
    assert {p.name for p in found.parameters if not p.told} >= {"m.cart", "I_m.up", "offset.up"}
    assert found.robot.inertial_parameters[0] == pytest.approx(4.0, rel=0.01)


@pytest.mark.parametrize("rotors", [True, False])
@pytest.mark.parametrize("noise", [1e-3, 0.01, 0.1])
def test_bodies_without_constraints_are_those_with_constraints_whatever_the_noise(noise: float, rotors: bool):
    """Where there was hardly any noise, the search without constraints stalled far from what fits best."""
    file, log = lift_log(noise, 0.75)
    free, bound = (identify_rigid(file, log, rotors=rotors, solver=solver) for solver in ("log_cholesky", "lmi_trace"))
    assert free.robot.inertial_parameters == pytest.approx(bound.robot.inertial_parameters, rel=1e-3, abs=1e-3)
    assert free.noise == pytest.approx(bound.noise, rel=1e-2)


@dataclass(frozen=True)
class Churning(Sliding):
    """A law of a user's own."""

    coulomb: float
    churning: float
    viscous: float = 0.0
    smoothing: float = 0.05
    asymmetry = per_load = grease = None
    coefficients = ("coulomb", "churning", "viscous")

    def plateau(self, speed: Any) -> Any:
        return self.coulomb + self.churning * speed * speed


def test_friction_of_a_users_own_law_is_identified_as_stated_or_replaced_by_a_known_one():
    arm = known_arm(1, 2)
    own = Churning(1.0, 0.5, 0.3)
    true = arm.robot.with_drives({n: replace(d, link_friction=own) for n, d in arm.robot.drives.items()})
    wrong = {n: replace(d, link_friction=Churning(0.5, 0.1)) for n, d in arm.file.drives.items()}
    file, log = arm.file.with_drives(wrong), recorded(true, 1)
    found = identify_rigid(file, log, friction="stated", cutoff=CUTOFF)
    for joint in file.joints:
        assert found[f"churning.{joint}"].value == pytest.approx(0.5, abs=0.02)
    chosen = identify_rigid(file, log, cutoff=CUTOFF)
    assert {choice.family.partition(",")[0] for choice in chosen.friction} <= {"coulomb", "stribeck"}


def test_friction_that_grows_with_load_is_chosen_where_it_does_though_the_files_bodies_hang_elsewhere():
    """Friction of 0.1 of a load that the file has a quarter of a turn away, along the other axis."""
    true = two_joints()
    elsewhere = true.inertial_parameters.copy()
    elsewhere[13], elsewhere[11] = -elsewhere[11], 0.0  # h_z and h_x of the last body
    file = Robot(with_parameters(true.mechanism, elsewhere), true.drives)
    time, phases = np.arange(0.0, 15.0, 0.002), np.array([0.3, 1.1])
    turns = 2.0 * np.pi * np.array([[0.2, 0.3], [0.5, 0.7]])
    angles = time[:, None, None] * turns + phases
    q = np.sin(angles).sum(axis=1)
    v, a = (turns * np.cos(angles)).sum(axis=1), -(turns**2 * np.sin(angles)).sum(axis=1)
    load, noise = true.inverse_dynamics(q, v, a), 0.02 * np.random.default_rng(0).normal(size=q.shape)

    def identified(share: float, **friction: Any) -> RigidEstimate:
        torque = load + (1.0 + share * np.abs(load)) * np.tanh(v / 0.02) + noise
        recording = Recording(time, true.joints, q=q, torque=torque)
        return identify_rigid(file, recording, solver="lmi_trace", rotors=False, **friction)

    found = identified(0.1)
    assert all(choice.family.endswith("with load") for choice in found.friction)
    assert [found[f"per_load.{joint}"].value for joint in file.joints] == pytest.approx([0.1, 0.1], rel=0.05)
    # a log whose friction does not grow with load does not keep such a law
    without = identified(0.0, friction=found.friction)
    assert not any(choice.family.endswith("with load") for choice in without.friction)
    assert all(drive.motor_friction is None for drive in without.robot.drives.values())
    assert [without[f"coulomb.{joint}"].value for joint in file.joints] == pytest.approx([1.0, 1.0], rel=0.01)


@pytest.mark.parametrize(("shift", "offset"), [(0.0, 0.0), (-3.0, -2.0)])
@pytest.mark.parametrize(("stated", "seed"), [(None, 0), (0.4, 0), (0.4, 1)])
def test_what_friction_explains_as_well_as_an_offset_is_friction(
    shift: float, offset: float, stated: float | None, seed: int
):
    """The shoulder turns one way, with 1 N m of dry friction: beside an offset, which no file holds, a log of it
    determines the sum only.  Friction cannot be negative: of -3 N m an offset takes at least what is left."""
    law = None if stated is None else Coulomb(stated, 0.5, 0.02)
    file = two_joints().with_drives(dict.fromkeys(("shoulder", "elbow"), Drive(1.0, Rotor(0.1), link_friction=law)))
    time = np.arange(0.0, 15.0, 0.002)
    turns = 2.0 * np.pi * np.array([0.2, 0.3])
    ahead, waves = np.array([0.15, 0.0]), np.array([0.05, 0.8])
    angles = time[:, None] * turns
    q, v, a = (
        ahead * time[:, None] + waves * np.sin(angles),
        ahead + waves * turns * np.cos(angles),
        -waves * turns**2 * np.sin(angles),
    )
    torque = file.inverse_dynamics(q, v, a) + 0.1 * a + np.tanh(v / 0.02) + 0.5 * v + [shift, 0.0]
    torque += 0.02 * np.random.default_rng(seed).normal(size=q.shape)
    found = identify_rigid(file, Recording(time, file.joints, q=q, torque=torque), solver="lmi_trace")
    assert not found["offset.shoulder"].told and not found["coulomb.shoulder"].told
    friction = found.model.laws["shoulder"]
    assert friction.torque(0.2) + found.model.offsets[0] == pytest.approx(1.1 + shift, abs=0.05)
    if offset == 0.0:
        assert found.model.offsets[0] == pytest.approx(0.0, abs=0.02)
    else:
        assert found.model.offsets[0] < offset + 0.05


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("held", [0.4, -1.2])
def test_the_weight_of_a_joint_that_stands_still_is_its_bodies(held: float, seed: int):
    """Its friction, zero but for rounding, does not push: no offset is needed."""
    file, time, turn = two_joints(), np.arange(0.0, 15.0, 0.002), 0.6 * np.pi
    q, v, a = np.zeros((3, time.size, 2))
    q[:, 0] = held
    q[:, 1] = 0.8 * np.sin(turn * time) + 0.3 * np.sin(2.0 * turn * time)
    v[:, 1] = turn * (0.8 * np.cos(turn * time) + 0.6 * np.cos(2.0 * turn * time))
    a[:, 1] = -(turn**2) * (0.8 * np.sin(turn * time) + 1.2 * np.sin(2.0 * turn * time))
    torque = 1.2 * file.inverse_dynamics(q, v, a) + 0.02 * np.random.default_rng(seed).normal(size=q.shape)
    recording = Recording(time, file.joints, q=q, torque=torque)
    found = identify_rigid(file, recording, solver="lmi_trace", friction="stated")
    assert not found["offset.shoulder"].told
    assert abs(found.model.offsets[0]) < 1e-5


def test_a_brief_contact_in_a_log_without_noise_leaves_its_parameters_and_intervals():
    wheel = Link("wheel", mass=2.0, com=np.zeros(3), inertia=0.5 * np.eye(3))
    robot = Robot(build("bench", [Link("base"), wheel], [Joint("axle", "continuous", "base", "wheel")]))
    times, rate = np.arange(10_000) * 1e-3, 1.4 * np.pi
    q, v, a = (0.8 * rate**k * f(rate * times) for k, f in enumerate([np.sin, np.cos, lambda x: -np.sin(x)]))
    torque = 0.5 * a + 2.0 * v
    torque[3000:3050] += 1.0
    recording = Recording(times, robot.joints, q=q[:, None], torque=torque[:, None])
    found = identify_rigid(robot, recording, friction="stated")
    assert found["viscous.axle"].value == pytest.approx(2.0, rel=1e-4)
    assert np.isfinite(found["viscous.axle"].high)

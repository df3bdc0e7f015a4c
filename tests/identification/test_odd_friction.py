"""Friction without a known law, or hardly determined by a log: the judged model is the saved one, and is physical."""

import re
from pathlib import Path

import numpy as np
import pytest
from arm_logs import LAW, TIME, TRUTH, Array, channels, motions

import cutpoint
from cutpoint import Coulomb, Drive, Robot, Rotor, Stribeck
from cutpoint.formats.drives.drives import parse_drives
from cutpoint.identification import Recording, base_parameters, low_pass
from cutpoint.identification.conditioning.motion import motion_of
from cutpoint.identification.output import Identification, identify
from cutpoint.identification.output.torque_errors import stated_torque
from cutpoint.identification.rigid.friction_choice import FrictionChoice
from cutpoint.identification.rigid.least_squares import Method, least_squares
from cutpoint.identification.rigid.regression import Regression
from robot_library import urdf

RIGID = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, Drive(100.0)))


def rising(v: Array) -> Array:
    """Less at rest than in motion, as no law here has it."""
    return 4.0 * np.tanh(v / 0.01) * (1.8 - 0.8 * np.exp(-((v / 0.15) ** 2))) + 3.0 * v


def even(v: Array) -> Array:
    return np.asarray(LAW.torque(v))


def identified(rubs: Array, **how: object) -> Identification:
    q, v, a = motions()
    noise = np.random.default_rng(0).normal(size=(2, *q.shape))
    torque = TRUTH.inverse_dynamics(q, v, a) + rubs + 0.01 * noise[1]
    return identify(RIGID, Recording(TIME, TRUTH.joints, q=q + 1e-6 * noise[0], torque=torque), **how)  # type: ignore[arg-type]


@pytest.mark.parametrize("law", ["choose", "stribeck"])
@pytest.mark.parametrize("friction", [rising, even])
@pytest.mark.parametrize("solver", ["lmi", "log_cholesky"])
def test_the_robot_that_is_saved_is_the_one_that_is_judged(law: str, friction: object, solver: str, tmp_path: Path):
    given = dict.fromkeys(TRUTH.joints, Stribeck(1.0, 1.0, 1.0, 0.15, 0.02)) if law == "stribeck" else law
    found = identified(friction(motions()[1]), friction=given, solver=solver)  # type: ignore[operator]
    drives = found.save(tmp_path)[1].read_text()
    saved = found.robot.with_drives(parse_drives(drives, found.robot.mechanism))
    motion, errors = motion_of(saved, found.recording, found.rigid.cutoff), found.errors
    torque = stated_torque(saved, motion) + found.rigid.model.offsets
    after = low_pass(torque, motion.period, errors.bandwidth)
    known = np.isfinite(after)
    assert np.abs(after - errors.after)[known].max() < 1e-9 * np.abs(after[known]).max()
    for number in found.numbers:
        if number.path and number.told and not number.low <= number.used <= number.high:
            assert f"{number.remark}" in drives and "from the log alone; " in number.remark


def test_friction_that_is_less_at_rest_is_not_written_as_even_after_it_was_judged():
    found = identified(rising(motions()[1]))
    errors = found.errors.rms("after", held_out=True)
    assert (errors < 0.1 * found.errors.size()).all()
    for drive in found.robot.drives.values():
        law = drive.link_friction
        assert not isinstance(law, Stribeck) or law.static >= law.coulomb
    assert not any("rises from rest" in note for note in found.notes)


def bent(v: Array) -> Array:
    """Rises with a power of the speed, as no law here has it."""
    return (6.0 + 4.0 * np.abs(v) ** 0.6) * np.tanh(v / 0.005)


def peaked(v: Array) -> Array:
    return np.asarray(Stribeck(4.0, 6.0, 3.0, 0.15, 0.02).torque(v))


def test_a_law_that_fits_only_the_speeds_of_the_log_is_said_to_be_a_curve():
    said = r"(.*): friction is a curve through this log's speeds, up to .* \(stribeck_velocity .* does not extrapolate"
    found = identified(bent(motions()[1]))
    named = [words[1] for note in found.notes if (words := re.match(said, note))]
    for joint, law in found.rigid.model.laws.items():
        fastest = np.abs(motions()[1]).max()
        assert (joint in named) == (isinstance(law, Stribeck) and law.stribeck_velocity > 0.5 * fastest)
    assert named
    assert not any(re.match(said, note) for note in identified(peaked(motions()[1])).notes)


def test_friction_at_its_bound_is_zero():
    laws = identified(bent(motions()[1])).rigid.model.laws
    values = [float(getattr(law, name)) for law in laws.values() for name in law.coefficients]
    assert min(values) == 0.0 and all(x == 0.0 or x > 1e-6 for x in values)


def test_friction_of_both_sides_is_shared_as_the_files_share_it(tmp_path: Path):
    """Torques tell its sum; a side's friction at rest is no less than in motion whatever the shares."""
    both = Drive(100.0, link_friction=Stribeck(1.0, 3.0, 0.5, 0.1, 0.02), motor_friction=Coulomb(3.0, 1.5, 0.02))
    q, v, a = motions()
    log = Recording(TIME, TRUTH.joints, q=q, torque=TRUTH.inverse_dynamics(q, v, a) + even(v))
    robot = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, both))
    found = identify(robot, log)
    numbers = {number.name: number for number in found.numbers}
    for joint, drive in found.robot.drives.items():
        link, motor = drive.link_friction, drive.motor_friction
        for name in ("coulomb", "viscous"):
            own = [float(getattr(law, name)) for law in (link, motor)]
            assert own[1] == pytest.approx(3.0 * own[0], rel=1e-9)
            assert sum(own) == pytest.approx(getattr(LAW, name), rel=0.02)
            assert numbers[f"{name}.{joint}"].prior == pytest.approx(getattr(both.motor_friction, name) * 4 / 3)
    drives = found.save(tmp_path)[1].read_text()
    assert parse_drives(drives, found.robot.mechanism) == found.robot.drives
    assert "coulomb" in drives and not re.search(r"coulomb: \S+  #", drives)  # the interval is of the sum


def test_numbers_that_are_not_told_are_none_and_told_ones_have_ends():
    """One joint moves after the other: whole blocks of the log know nothing of a column."""
    robot = cutpoint.load(urdf("ur10_robot.urdf"))
    time = 8e-3 * np.arange(3600)
    n, one = len(robot.joints), 3600 // len(robot.joints)
    q, v, a = np.zeros((3, time.size, n))
    phase = np.linspace(0.0, 4.0 * np.pi, one, endpoint=False)
    speed = 4.0 * np.pi / (one * 8e-3)
    for j in range(n):
        rows = slice(j * one, (j + 1) * one)
        # starts and ends at rest, with all derivatives that count
        q[rows, j] = 0.4 * (np.sin(phase) - 0.5 * np.sin(2.0 * phase))
        v[rows, j] = 0.4 * speed * (np.cos(phase) - np.cos(2.0 * phase))
        a[rows, j] = 0.4 * speed**2 * (2.0 * np.sin(2.0 * phase) - np.sin(phase))
    torque = robot.inverse_dynamics(q, v, a) + Coulomb(3.0, 2.0, 0.02).torque(v)
    torque = torque + 0.1 * np.random.default_rng(0).normal(size=q.shape)
    found = identify(robot, Recording(time, robot.joints, q=q, torque=torque))
    for number in found.numbers:
        assert not number.told or number.low <= number.value <= number.high
        assert number.name[:7] != "coulomb" or not number.told or number.low < 3.0 < number.high or number.value > 1.0
    for choice in found.rigid.friction:
        sizes = [held.error for held in choice.compared.values()]
        assert max(sizes) < 3.0 * np.abs(torque).max()


@pytest.mark.parametrize("law", ["choose", "stated"])
def test_friction_that_is_not_told_stays_near_what_the_file_states(law: str):
    """The elbow creeps: its viscous friction is nothing beside noise."""
    drive = Drive(100.0, link_friction=Coulomb(2.0, 1.0, 1e-4))
    before = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, drive))
    q, v, a = (x * [1.0, 0.003] for x in motions())
    rng = np.random.default_rng(3)
    torque = (
        TRUTH.inverse_dynamics(q, v, a) + Coulomb(4.0, 3.0, 1e-4).torque(v) + [1.0, 20.0] * rng.normal(size=q.shape)
    )
    found = identify(before, Recording(TIME, TRUTH.joints, q=q, torque=torque), friction=law)  # type: ignore[arg-type]
    numbers = {number.name: number for number in found.numbers}
    creeping, moving = numbers["viscous.elbow"], numbers["viscous.shoulder"]
    assert not creeping.told and creeping.used == pytest.approx(1.0, abs=0.5)
    assert moving.told and moving.used == pytest.approx(3.0, rel=0.1)
    assert any("viscous.elbow" in words and "stays near what its file says" in words for words in found.untold)


@pytest.mark.parametrize("noise", [0.3, 0.0])
@pytest.mark.parametrize("turned", [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]])
def test_torques_of_turned_sign_are_said_with_their_joints(turned: list[float], noise: float):
    given, rng = channels(), np.random.default_rng(5)
    torque = given["torque"] * turned + noise * rng.normal(size=given["torque"].shape)
    log = Recording(TIME, TRUTH.joints, q=given["q"], torque=torque)
    doubts = " ".join(identify(RIGID, log, friction="stated").doubts)
    joints = {joint for joint, sign in zip(TRUTH.joints, turned, strict=True) if sign < 0.0}
    (said,) = re.findall(r"friction or inertia of (.*) comes out negative: is the sign of the torque", doubts)
    assert set(said.split(", ")) == joints


@pytest.mark.parametrize("apart", [1e-3, 1e-7, 1e-8])
@pytest.mark.parametrize("method", ["ordinary", "weighted", "huber"])
def test_what_columns_hardly_tell_apart_has_a_variance(method: Method, apart: float):
    """Twelve columns that are alike in most of what they are: rounding must not make a variance negative."""
    rng = np.random.default_rng(1)
    common = rng.normal(size=(300, 2, 1))
    columns = (common + apart * rng.normal(size=(300, 2, 12))) * np.geomspace(1e-3, 1e3, 12)
    torque = common[..., 0] + 0.1 * rng.normal(size=(300, 2))
    names = tuple(f"c{k}" for k in range(12))
    found = least_squares(Regression(names, columns, torque, 0.05 * np.arange(300)), method)
    deviations = found.spread.deviations()
    assert (deviations > 0.0).all() and np.isfinite(deviations).all()


def test_an_asymmetry_is_not_played_off_against_an_offset():
    """Both are the same but for the moments of rest, and only the asymmetry reaches the drive file."""
    law = Coulomb(1.0, 1.0, 0.02, asymmetry=-0.05)
    chosen = tuple(FrictionChoice(joint, "coulomb, asymmetric", law, {}) for joint in TRUTH.joints)
    found = identified(even(motions()[1]), friction=chosen)
    assert [round(x.asymmetry, 6) for x in found.rigid.model.laws.values()] == [-0.05] * len(TRUTH.joints)


def test_sums_of_what_slides_are_masses():
    slider = "<joint name='{0}' type='prismatic'><parent link='{1}'/><child link='{2}'/><axis xyz='{3}'/></joint>"
    body = "<link name='{0}'><inertial><mass value='{1}'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    links = "".join(f"{body.format(*each)}</inertial></link>" for each in (("bridge", 30), ("cart", 10)))
    joints = slider.format("x", "base", "bridge", "1 0 0") + slider.format("y", "bridge", "cart", "0 1 0")
    text = f"<robot name='gantry'><link name='base'/>{links}{joints}</robot>"
    gantry = cutpoint.formats.parse_urdf(text.encode(), "gantry.urdf")
    robot = Robot(gantry, dict.fromkeys(("x", "y"), Drive(10.0, Rotor(1e-3))))
    names = base_parameters(robot, rotors=True).names
    time = 2e-3 * np.arange(4000)
    q = np.column_stack([np.sin(1.7 * time) + 0.3 * np.cos(5.1 * time), 0.5 * np.sin(2.9 * time)])
    a = np.column_stack([-2.89 * np.sin(1.7 * time) - 7.803 * np.cos(5.1 * time), -4.205 * np.sin(2.9 * time)])
    torque = robot.inverse_dynamics(q, np.gradient(q, time, axis=0), a)
    found = identify(robot, Recording(time, robot.joints, q=q, torque=torque))
    sums = {number.name: number.unit for number in found.numbers if "m." in number.name}
    assert any(name.startswith("I_m.") and " + " in name for name in names)
    assert sums and set(sums.values()) == {"kg"}, sums


@pytest.mark.parametrize("solver", ["lmi", "log_cholesky"])
def test_friction_that_would_take_the_whole_load_is_bounded(solver: str):
    q, v, a = motions()
    given = dict.fromkeys(TRUTH.joints, Coulomb(1.0, 1.0, 0.02, per_load=0.1))
    found = identified(1.3 * np.abs(TRUTH.inverse_dynamics(q, v, a)) * np.tanh(v / 0.02), friction=given, solver=solver)
    shares = [drive.motor_friction.per_load for drive in found.robot.drives.values()]  # type: ignore[union-attr]
    assert 0.9 < max(shares) < 1.0
    assert any("nor take the whole load" in note for note in found.notes)

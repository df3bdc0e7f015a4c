"""Files that an identification leaves: a user's own robot file with other inertias, and drives with intervals."""

import re
from dataclasses import replace

import numpy as np
import pytest

import cutpoint
from cutpoint import Drive, Harmonic, KinematicError, LinearSpring, MaxwellSlip, Rotor, Stribeck
from cutpoint.errors import InputError
from cutpoint.formats import parse_drives, parse_urdf
from cutpoint.formats.drives.file_writing import remarked_drives, worded
from cutpoint.formats.urdf.writing import MOVED, updated_urdf
from cutpoint.identification.output.numbers import Number
from cutpoint.identification.rigid.bodies import with_parameters
from cutpoint.model import Mechanism
from robot_library import COULOMB, mixed_drives, tree, urdf

INERTIAL = re.compile(rb"<inertial>.*?</inertial>", re.DOTALL)

ODD = b"""<?xml version='1.0' encoding='UTF-8'?>\r
<!-- an arm; <inertial/> in a comment is none -->\r
<robot name='odd'>\r
  <link name = 'base' />\r
  <link name='upper'>\r
    <!-- kept -->\r
    <inertial>\r
      <origin rpy='0.1 0.2 0.3' xyz='0.1 0 0'/> <mass value='2'/>\r
      <inertia ixx='0.02' ixy='0' ixz='0' iyy='0.03' iyz='0' izz='0.025'/>\r
    </inertial>\r
    <visual><geometry><mesh filename="a>b.stl"/></geometry></visual>\r
  </link>\r
  <link name='wrist'/>\r
  <link name='gripper'><inertial><mass value='0.5'/>\r
    <inertia ixx='0.001' ixy='0' ixz='0' iyy='0.001' iyz='0' izz='0.001'/></inertial></link>\r
  <joint name='elbow' type='revolute'><parent link='base'/><child link='upper'/><axis xyz='0 1 0'/></joint>\r
  <joint name='roll' type='continuous'><parent link='upper'/><child link='wrist'/><origin xyz='0.4 0 0'/></joint>\r
  <joint name='mount' type='fixed'><parent link='wrist'/><child link='gripper'/>\r
    <origin xyz='0 0.1 0.2' rpy='1 0 0'/></joint>\r
</robot>\r
"""
"""Line ends of Windows, quotes of both kinds, comments, a link that closes itself and one that is fixed to it."""


def heavier(mechanism: Mechanism, seed: int = 0) -> Mechanism:
    """Every body scaled by a factor of its own, which keeps it possible."""
    rng = np.random.default_rng(seed)
    robot = cutpoint.Robot(mechanism)
    factors = np.repeat(rng.uniform(0.5, 2.0, len(mechanism.bodies)), 10)
    return with_parameters(mechanism, robot.inertial_parameters * factors)


def parameters(mechanism: Mechanism) -> np.ndarray:
    return cutpoint.Robot(mechanism).inertial_parameters


@pytest.mark.parametrize("content", [ODD, urdf("ur10_robot.urdf").read_bytes(), urdf("panda.urdf").read_bytes()])
def test_inertias_come_back_from_the_text(content: bytes):
    before = parse_urdf(content, mimic="coupled")
    after = heavier(before)
    text, _ = updated_urdf(content, before, after)
    found, wanted = parameters(parse_urdf(text, mimic="coupled")), parameters(after)
    assert np.abs(found - wanted).max() <= 1e-12 * np.abs(wanted).max()


def test_no_byte_outside_inertials_changes():
    content = urdf("ur10_robot.urdf").read_bytes()
    before = parse_urdf(content)
    assert updated_urdf(content, before, before) == (content, ())
    text, _ = updated_urdf(content, before, heavier(before))
    assert text != content
    assert INERTIAL.sub(b"", text).replace(MOVED, b"") == INERTIAL.sub(b"", content)


def test_links_that_gain_or_lose_an_inertial_keep_all_else():
    before = parse_urdf(ODD)
    text, _ = updated_urdf(ODD, before, heavier(before))
    assert b"\n" not in text.replace(b"\r\n", b"")
    opened = ODD.replace(b"<link name='wrist'/>", b"<link name='wrist'>  </link>")
    left = INERTIAL.sub(b"", text).replace(MOVED, b"")
    assert left.split() == INERTIAL.sub(b"", opened).split()


def test_only_links_that_changed_are_touched():
    before = parse_urdf(ODD)
    bodies = (before.bodies[0], heavier(before).bodies[1])
    text, _ = updated_urdf(ODD, before, Mechanism(before.name, bodies, before.frames))
    end = ODD.index(b"<link name='wrist'")
    assert text[:end] == ODD[:end]


def test_mass_fixed_to_a_link_goes_there_and_is_said():
    before = parse_urdf(ODD)
    text, notes = updated_urdf(ODD, before, heavier(before))
    assert notes == ("link 'wrist' now includes mass and inertia of gripper, fixed to it",)
    gripper = text[text.index(b"<link name='gripper'>") :]
    assert b"<inertial>" not in gripper[: gripper.index(b"</link>")]


def test_what_a_locked_joint_carried_is_in_the_link_before_it_and_the_lock_is_said():
    before = parse_urdf(ODD, lock={"roll": 0.3})
    after = heavier(before)
    text, notes = updated_urdf(ODD, before, after)
    assert "load it with roll locked as now: the links they move have no mass left" in notes
    found, wanted = parameters(parse_urdf(text, lock={"roll": 0.3})), parameters(after)
    assert np.abs(found - wanted).max() <= 1e-12 * np.abs(wanted).max()


def test_a_text_of_another_robot_is_refused():
    other = parse_urdf(urdf("ur10_robot.urdf").read_bytes())
    with pytest.raises(InputError, match=r"the URDF has no link 'shoulder_link'"):
        updated_urdf(ODD, other, other)
    mine = parse_urdf(ODD)
    with pytest.raises(cutpoint.ModelError, match=r"document type"):
        updated_urdf(b"<!DOCTYPE robot>" + ODD[ODD.index(b"<robot") :], mine, heavier(mine))


def test_drives_come_back_with_their_remarks():
    robot = tree(seed=3, size=5)
    drives = mixed_drives(robot)
    told = {("rotor", "inertia"): "1 to 2", ("nowhere",): "lost", ("friction", "link", "coulomb"): "two\nlines # :"}
    text = remarked_drives(drives, dict.fromkeys(drives, told), ["of a log\nversion: 7"])
    assert parse_drives(text, robot.mechanism) == drives
    assert text.count("# 1 to 2") == sum(drive.rotor is not None for drive in drives.values())
    assert "coulomb: 0.4  # two lines # :" in text and "lost" not in text


@pytest.mark.parametrize(
    ("low", "used", "high", "words"),
    [
        (1.0, 1.5, 2.0, "1 to 2"),
        (44.999_61, 44.999_64, 45.000_02, "44.9996 to 45"),
        (200.001_4, 200.001_41, 200.001_42, "200.0014 to 200.00142"),
        (3.0, 5.0, 4.0, "3 to 4 from the log alone; of possible bodies and friction, this fits best"),
        (2.0, 2.0, 2.0, "2 to 2"),
    ],
)
def test_an_interval_shows_that_its_number_is_within(low: float, used: float, high: float, words: str):
    assert Number("elbow", "coulomb.elbow", "N m", used, low, high, used, np.nan).remark == words


@pytest.mark.parametrize("name", ["a: b", "- x", "#1", "'quoted'", "ü", "1.0", "true"])
def test_names_that_are_yaml_stay_names(name: str):
    inertia = "<mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    links = f"<link name='a'/><link name='b'><inertial>{inertia}</inertial></link>"
    joint = f"<joint type='continuous' name=\"{name}\"><parent link='a'/><child link='b'/></joint>"
    mechanism = parse_urdf(f"<robot name='r'>{links}{joint}</robot>")
    drives = {name: Drive(ratio=50.0, rotor=Rotor(1e-5))}
    text = remarked_drives(drives, {name: {("rotor", "inertia"): "told"}})
    assert parse_drives(text, mechanism) == drives
    assert "inertia: 1.0e-05  # told" in text


FOUND = MaxwellSlip((430.0, 280.0, 40.0, 500.0), (1e-4, 4e-4, 7e-4, 1.2e-3))
"""Elements as encoders tell them: in no order that a file could state."""


def loop(law: MaxwellSlip, reach: float) -> tuple[float, float]:
    """Height, N m, and area, J, of the loop along a deflection from `reach` to its opposite and back."""
    path = np.concatenate([np.linspace(reach, -reach, 20001), np.linspace(-reach, reach, 20001)])
    strains, torques = law.reach, []
    for step in np.diff(path):
        strains = law.strains(strains, step)
        torques.append(law.torque(strains))
    return float(np.ptp(torques)), float(np.dot(torques, np.diff(path)))


def test_hysteresis_in_a_files_words_keeps_wide_loops():
    drive = Drive(ratio=100.0, rotor=Rotor(1e-5), compliance=LinearSpring(7e3), hysteresis=FOUND)
    found, notes = worded(drive)
    assert isinstance(found.hysteresis, MaxwellSlip)
    assert "hysteresis of 4 elements" in notes[0]
    for a, b in zip(loop(found.hysteresis, 5e-3), loop(FOUND, 5e-3), strict=True):
        assert abs(a - b) < 1e-3 * abs(b)  # the path's steps are 1e-4 of it


def test_what_a_file_can_say_is_not_changed():
    smooth = MaxwellSlip.smooth(1.5, 2e-3, 5)
    error = KinematicError((Harmonic(2, 1e-4, 0.3), Harmonic(4, 2e-5, 0.0)))
    drive = Drive(100.0, Rotor(1e-5), LinearSpring(7e3), 3.0, hysteresis=smooth, kinematic_error=error)
    assert worded(drive) == (drive, ())


def test_a_rotor_that_is_found_to_be_nothing_does_not_cost_the_file():
    rigid = Drive(100.0, Rotor(0.0))
    assert worded(rigid) == (Drive(100.0), ("a rotor without inertia is written as no rotor",))
    elastic = replace(rigid, compliance=LinearSpring(7e3))
    assert worded(elastic) == (elastic, ())  # a spring needs one: there is no word for it


def test_every_worded_drive_can_be_written():
    robot = tree(seed=1, size=1)
    (joint,) = robot.joints
    falling = Stribeck(coulomb=1.0, static=1.2, viscous=0.1, stribeck_velocity=0.1, smoothing=0.02)
    elastic = Drive(100.0, Rotor(1e-5), LinearSpring(7e3), hysteresis=FOUND)
    drive, notes = worded(replace(elastic, link_friction=COULOMB, motor_friction=falling))
    assert len(notes) == 1
    (found,) = parse_drives(remarked_drives({joint: drive}, {}), robot.mechanism).values()
    assert found.motor_friction == drive.motor_friction and found.link_friction == drive.link_friction
    assert isinstance(found.hysteresis, MaxwellSlip) and isinstance(drive.hysteresis, MaxwellSlip)
    assert np.allclose(found.hysteresis.stiffness, drive.hysteresis.stiffness, rtol=1e-12)
    assert np.allclose(found.hysteresis.reach, drive.hysteresis.reach, rtol=1e-12)

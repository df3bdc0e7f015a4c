"""Meaning of a URDF document beyond comparison with Pinocchio: order, defaults, options, warnings, xacro."""

import re
import sys
import warnings
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xacro
from scipy.spatial.transform import Rotation
from urdf_text import ARM, joint, link, robot

import cutpoint
from cutpoint import Drive, Robot
from cutpoint.errors import InputError, ModelError
from cutpoint.formats import DegreesWarning, MimicWarning, NotCarriedOver, load_urdf, parse_urdf
from cutpoint.model import WORLD, Limits, Mechanism

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def one_joint(inside: str = "", kind: str = "revolute") -> str:
    return robot(link("base"), link("arm"), joint("elbow", "base", "arm", kind, inside))


def only(mechanism: Mechanism):
    (body,) = mechanism.bodies
    return body.joint


def gripper(multiplier: float = -2.0, offset: float = 0.5, leader: str = "left") -> str:
    mimic = f'<mimic joint="{leader}" multiplier="{multiplier}" offset="{offset}"/>'
    return robot(
        link("hand"),
        link("a"),
        link("b"),
        joint("left", "hand", "a"),
        joint("right", "hand", "b", inside=mimic),
    )


def test_bodies_come_depth_first_in_the_order_of_the_file() -> None:
    text = robot(
        *map(link, ("root", "b", "a", "b2", "a2")),
        joint("to_b2", "b", "b2"),
        joint("to_b", "root", "b"),
        joint("to_a2", "a", "a2"),
        joint("to_a", "root", "a"),
    )
    assert [body.joint.name for body in parse_urdf(text).bodies] == ["to_b", "to_b2", "to_a", "to_a2"]
    assert [body.parent for body in parse_urdf(text).bodies] == [WORLD, 0, WORLD, 2]


def test_what_urdf_leaves_open_has_its_default() -> None:
    elbow = only(parse_urdf(one_joint()))
    np.testing.assert_array_equal(elbow.axis, (1, 0, 0))
    np.testing.assert_array_equal(elbow.placement, np.eye(4))
    assert elbow.limits == Limits()
    assert (elbow.damping, elbow.friction, elbow.mimic) == (0, 0, None)


def test_of_two_bounds_the_one_not_stated_is_zero() -> None:
    assert only(parse_urdf(one_joint('<limit upper="2" effort="5"/>'))).limits == Limits(0, 2, effort=5)


def test_infinite_bounds_are_no_bounds() -> None:
    assert only(parse_urdf(one_joint('<limit lower="-inf" upper="inf"/>'))).limits == Limits()


def test_a_continuous_joint_has_no_position_limits() -> None:
    inside = '<limit lower="-1" upper="1" velocity="3"/>'
    assert only(parse_urdf(one_joint(inside, "continuous"))).limits == Limits(velocity=3)


def test_axes_come_out_with_unit_length() -> None:
    np.testing.assert_allclose(only(parse_urdf(one_joint('<axis xyz="0 3 4"/>'))).axis, (0, 0.6, 0.8), rtol=1e-15)


def test_meshes_are_never_opened() -> None:
    mesh = '<visual><geometry><mesh filename="package://nowhere/a.stl"/></geometry></visual>'
    text = robot(f'<link name="base">{mesh}</link>', link("arm"), joint("elbow", "base", "arm"))
    assert len(parse_urdf(text).bodies) == 1


def test_an_independent_mimic_is_a_coordinate_of_its_own_and_is_warned_of_once() -> None:
    with pytest.warns(MimicWarning, match=r"mimic joints 'right' are .* \(hand.urdf\)") as caught:
        hand = parse_urdf(gripper(), "hand.urdf")
    assert len(caught) == 1
    assert not hand.coupled
    assert hand.bodies[1].joint.mimic is not None


def test_a_coupled_mimic_keeps_its_relation() -> None:
    hand = parse_urdf(gripper(), mimic="coupled")
    mimic = hand.bodies[1].joint.mimic
    assert hand.coupled
    assert mimic is not None
    assert (mimic.joint, mimic.multiplier, mimic.offset) == ("left", -2.0, 0.5)


def test_a_mimic_of_nothing_is_free_or_an_error() -> None:
    with pytest.warns(MimicWarning, match=r"ties them, but the file has no movable leader for 'right'"):
        assert parse_urdf(gripper(leader="lost")).bodies[1].joint.mimic is None
    with pytest.raises(ModelError, match=r"joint 'right': mimics joint 'lost', which does not exist"):
        parse_urdf(gripper(leader="lost"), mimic="coupled")


@pytest.mark.parametrize("scale", [1.0, -3.0, 1e-200, 1e200])
def test_an_origin_may_be_stated_by_a_quaternion(scale: float) -> None:
    turn = Rotation.from_euler("xyz", [0.3, -0.7, 1.9])
    stated = " ".join(repr(float(x)) for x in scale * turn.as_quat())
    by_quaternion = parse_urdf(one_joint(f'<origin xyz="1 2 3" quat_xyzw="{stated}"/>')).bodies[0].placement
    by_angles = parse_urdf(one_joint('<origin xyz="1 2 3" rpy="0.3 -0.7 1.9"/>')).bodies[0].placement
    np.testing.assert_allclose(by_quaternion, by_angles, atol=1e-15)


@pytest.mark.parametrize(
    "stated",
    [
        ('<dynamics armature="0.1"/>', ""),
        ("", '<transmission><joint name="elbow"/><actuator><d:rotor_inertia value="1e-4"/></actuator></transmission>'),
    ],
)
def test_inertia_of_rotors_that_a_urdf_states_is_not_lost_in_silence(stated: tuple[str, str]) -> None:
    inside, beside = stated
    text = robot(link("base"), link("arm"), joint("elbow", "base", "arm", "revolute", inside), beside)
    text = text.replace("<robot", '<robot xmlns:d="http://drake.mit.edu"', 1)
    with pytest.warns(NotCarriedOver, match="rotor inertia of joints 'elbow': rotor and ratio in a drive file"):
        parse_urdf(text)
    parse_urdf(text.replace("0.1", "0.0").replace("1e-4", "0"))


def test_loops_and_forces_beside_the_tree_are_not_lost_in_silence() -> None:
    beside = '<loop_joint name="a"/><d:loop_joint name="b"/><d:force_element name="c"/><frame name="d"/>'
    beside += '<gazebo><joint name="e" type="revolute"/></gazebo><gazebo reference="arm"><mu1>1</mu1></gazebo>'
    text = robot(link("base"), link("arm"), joint("elbow", "base", "arm", "revolute"), beside)
    text = text.replace("<robot", '<robot xmlns:d="http://drake.mit.edu"', 1)
    told = r"not carried over: <loop_joint> \(2\); <force_element> \(1\); <joint> in <gazebo> \(1\) \("
    with pytest.warns(NotCarriedOver, match=told):
        parse_urdf(text)


def test_friction_by_its_name_in_early_urdf_is_not_lost_in_silence() -> None:
    early = '<joint_properties damping="{}" friction="0.0"/>'
    text = robot(link("base"), link("arm"), joint("elbow", "base", "arm", "revolute", early))
    with pytest.warns(NotCarriedOver, match="<joint_properties> of joints 'elbow': state it in <dynamics>"):
        parse_urdf(text.format("0.7"))
    parse_urdf(text.format("0.0"))


def test_a_mimic_of_a_joint_that_is_fixed_is_free_or_an_error() -> None:
    fixed = gripper().replace('name="left" type="revolute"', 'name="left" type="fixed"')
    with pytest.warns(MimicWarning, match="mimic joints 'right' .* but the file has no movable leader for 'right'"):
        assert [body.joint.name for body in parse_urdf(fixed).bodies] == ["right"]
    with pytest.raises(ModelError, match=r"'left', which is fixed; .* can be locked; or load with independent mimics"):
        parse_urdf(fixed, mimic="coupled")


def test_only_two_ways_to_read_a_mimic_exist() -> None:
    with pytest.raises(InputError, match="mimic 'both' must be 'independent' or 'coupled'"):
        parse_urdf(gripper(), mimic="both")  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize("bounds", ["-170 170", "0 135", "-90 22.5"])
def test_limits_that_look_like_degrees_are_warned_of(bounds: str) -> None:
    lower, upper = bounds.split()
    with pytest.warns(DegreesWarning, match="limits of joints 'elbow' look like degrees; URDF angles are radians"):
        parse_urdf(one_joint(f'<limit lower="{lower}" upper="{upper}"/>'))


@pytest.mark.parametrize("bound", [3.0, 10.0, 9.42, 62.8, 62.83185307179586, 1e16])
def test_wide_limits_in_radians_pass(bound: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parse_urdf(one_joint(f'<limit lower="{-bound}" upper="{bound}"/>'))


def test_a_robot_without_name_has_that_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / "nameless.urdf"
    path.write_text(one_joint().replace(' name="arm"', "", 1))
    assert load_urdf(path).name == "nameless"


def test_planar_and_floating_joints_stand_anywhere() -> None:
    """A planar joint's axis is the normal of its plane; neither has position limits."""
    plane = '<axis xyz="0 0 2"/><limit lower="-1" upper="1" velocity="3"/>'
    joints = joint("j", "base", "a"), joint("slide", "a", "b", "planar", plane), joint("free", "b", "c", "floating")
    _, slide, free = parse_urdf(robot(*map(link, ("base", "a", "b", "c")), *joints)).bodies
    assert (slide.joint.kind, slide.joint.limits) == ("planar", Limits(velocity=3))
    np.testing.assert_array_equal(slide.joint.axis, [0, 0, 1])
    assert (free.joint.kind, free.parent) == ("floating", 1)


def test_gravity_and_floating_base_are_passed_on() -> None:
    arm = parse_urdf(ARM, gravity=(0, 0, -1.62), floating_base=True)
    np.testing.assert_array_equal(arm.gravity, (0, 0, -1.62))
    assert arm.bodies[0].joint.kind == "floating"


@pytest.mark.parametrize("name", ["arm.urdf.xacro", "ARM.XACRO"])
def test_a_xacro_file_is_expanded(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    mass = f'<xacro:property name="m" value="${{2 * 1.5}}"/>{link("arm", "${m}")}'
    path.write_text(f'<robot name="r" {XACRO}>{link("base")}{mass}{joint("elbow", "base", "arm")}</robot>')
    assert load_urdf(path).bodies[0].mass == 3.0


def test_a_xacro_file_that_cannot_be_expanded_says_why(tmp_path: Path) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(f'<robot {XACRO}><link name="${{nowhere}}"/></robot>')
    with pytest.raises(ModelError, match=r"xacro cannot expand this file: name 'nowhere' is not defined.*arm\.xacro\)"):
        load_urdf(path)


def including(file: str) -> str:
    """A robot of what another file defines."""
    return f'<robot name="r" {XACRO}><xacro:include filename="{file}"/></robot>'


def test_what_is_wrong_in_an_included_file_is_said_of_that_file(tmp_path: Path) -> None:
    (path := tmp_path / "arm.xacro").write_text(including("parts.xacro"))
    for wrong, told in {'<link name="${1/0}"/>': "division by zero .*", "<link>": "mismatched tag: .*"}.items():
        (tmp_path / "parts.xacro").write_text(f"<robot {XACRO}>{wrong}</robot>")
        with pytest.raises(ModelError, match=rf"cannot expand this file: {told} \({re.escape(str(tmp_path))}/parts\."):
            load_urdf(path)


def test_what_is_wrong_in_a_macro_is_said_of_it_and_of_what_calls_it(tmp_path: Path) -> None:
    finger = '<xacro:macro name="finger"><link name="${nowhere}"/></xacro:macro>'
    hand = '<xacro:macro name="hand"><xacro:finger/></xacro:macro>'
    (tmp_path / "parts.xacro").write_text(f"<robot {XACRO}>{finger}{hand}</robot>")
    (path := tmp_path / "arm.xacro").write_text(including("parts.xacro").replace("</robot>", "<xacro:hand/></robot>"))
    with pytest.raises(ModelError, match=r", in macro 'finger' of '.*parts\.xacro', in macro 'hand' of '.*arm\.xacro"):
        load_urdf(path)


def test_files_that_include_each_other_in_a_circle_are_named(tmp_path: Path) -> None:
    for file, included in {"arm": "left", "left": f"../{tmp_path.name}/right", "right": "left"}.items():
        (tmp_path / f"{file}.xacro").write_text(including(f"{included}.xacro"))
    circle = r"in a circle, '[^']*left\.xacro' -> '[^']*right\.xacro' -> '[^']*left\.xacro'; take one of these"
    turned = r"in a circle, '[^']*right\.xacro' -> '[^']*left\.xacro' -> '[^']*right\.xacro'; take one of these"
    with pytest.raises(ModelError, match=rf"files include each other ({circle}|{turned})"):
        load_urdf(tmp_path / "arm.xacro")


def test_macros_that_call_themselves_without_end_are_named(tmp_path: Path) -> None:
    macro = '<xacro:macro name="link_of" params="k"><xacro:link_of k="${k + 1}"/></xacro:macro>'
    (path := tmp_path / "arm.xacro").write_text(f'<robot name="r" {XACRO}>{macro}<xacro:link_of k="0"/></robot>')
    with pytest.raises(ModelError, match=r"macros call each other in a circle, 'link_of' -> 'link_of'; end it by an"):
        load_urdf(path)


def test_a_xacro_file_leaves_no_trace_in_the_xacro_package(tmp_path: Path) -> None:
    """Even where it fails, in a macro of an included file."""
    macro = '<xacro:arg name="side" default="left"/><xacro:macro name="m"><link name="${nowhere}"/></xacro:macro>'
    (tmp_path / "parts.xacro").write_text(f"<robot {XACRO}>{macro}<xacro:m/></robot>")
    (path := tmp_path / "arm.xacro").write_text(including("parts.xacro"))
    names = ("filestack", "macrostack", "all_includes", "substitution_args_context")
    before = [repr(getattr(xacro, name)) for name in names]
    with pytest.raises(ModelError, match="name 'nowhere' is not defined"):
        load_urdf(path, xacro={"name": "arm"})
    assert [repr(getattr(xacro, name)) for name in names] == before


@pytest.mark.parametrize("home", ["arm_description", "arm_parts"])
def test_packages_around_a_xacro_file_are_found_without_ros(tmp_path: Path, home: str) -> None:
    """The one that holds the file, whatever its folder is called, and one beside it."""
    for folder, name in {"cloned": "arm_description", "arm_parts": "arm_parts"}.items():
        (tmp_path / folder / "urdf").mkdir(parents=True)
        (tmp_path / folder / "package.xml").write_text(f'<package format="3">\n  <name>{name}</name></package>')
    parts = f"{link('base')}{link('arm')}{joint('elbow', 'base', 'arm')}"
    folder = "cloned" if home == "arm_description" else home
    (tmp_path / folder / "parts.xacro").write_text(f"<robot {XACRO}>{parts}</robot>")
    path = tmp_path / "cloned" / "urdf" / "arm.urdf.xacro"
    path.write_text(f'<robot name="r" {XACRO}><xacro:include filename="$(find {home})/parts.xacro"/></robot>')
    assert load_urdf(path).bodies[0].joint.name == "elbow"
    assert "ament_index_python" not in sys.modules


def test_a_package_without_package_xml_is_the_nearest_folder_of_its_name(tmp_path: Path) -> None:
    """Unless another is the package by its package.xml."""
    near, far = tmp_path / "robots" / "parts", tmp_path / "parts_of_all"
    for folder, mass in {near: 1.0, far: 2.0}.items():
        folder.mkdir(parents=True)
        moving = f"{link('base')}{link('arm', mass)}{joint('elbow', 'base', 'arm')}"
        (folder / "arm.xacro").write_text(f"<robot {XACRO}>{moving}</robot>")
    (tmp_path / "robots" / "arm").mkdir()
    (path := tmp_path / "robots" / "arm" / "arm.xacro").write_text(including("$(find parts)/arm.xacro"))
    assert load_urdf(path).bodies[0].mass == 1.0
    far.rename(far := tmp_path / "parts")
    (far / "package.xml").write_text("<package><name>parts</name></package>")
    assert load_urdf(path).bodies[0].mass == 2.0


def test_where_ros_is_it_knows_the_packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ros = ModuleType("ament_index_python")
    ros.__spec__ = ModuleSpec(ros.__name__, None)
    packages = ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = lambda name: str(tmp_path / "installed" / name)
    monkeypatch.setitem(sys.modules, ros.__name__, ros)
    monkeypatch.setitem(sys.modules, packages.__name__, packages)
    (tmp_path / "installed" / "arm").mkdir(parents=True)
    (tmp_path / "installed" / "arm" / "arm.xacro").write_text(f"<robot>{link('base')}</robot>")
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(f'<robot name="r" {XACRO}><xacro:include filename="$(find arm)/arm.xacro"/></robot>')
    assert not load_urdf(path).bodies


def test_a_package_that_nobody_knows_is_named(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(f'<robot name="r" {XACRO}><xacro:include filename="$(find arm)/arm.xacro"/></robot>')
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm" / "package.xml").write_text("<package><name>another</name></package>")
    rule = r"file: no folder around this file is the package 'arm' or has its name, and ROS, .*; put .*arm\.urdf\.xacro"
    with pytest.raises(ModelError, match=rule):
        load_urdf(path)


def test_a_xacro_file_takes_arguments(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf.xacro"
    hidden = f'<xacro:if value="$(arg bare)"><link name="$(arg name)"/></xacro:if>{link("base")}'
    path.write_text(f'<robot name="$(arg name)" {XACRO}>{hidden}</robot>')
    assert load_urdf(path, xacro={"name": "hand", "bare": False}).name == "hand"  # type: ignore[dict-item]
    rule = r"argument name; give it: load\(\.\.\., xacro={'name': \.\.\.}\), --xacro name:=VALUE"
    with pytest.raises(ModelError, match=rule):
        load_urdf(path)
    plain = tmp_path / "arm.urdf"
    plain.write_text(one_joint())
    with pytest.raises(InputError, match=r"arguments 'name' are for \.xacro files, got .*arm\.urdf"):
        cutpoint.load(plain, xacro={"name": "hand"})


def test_a_namespace_of_all_elements_changes_nothing() -> None:
    spaced = one_joint().replace("<robot ", '<robot xmlns="http://drake.mit.edu" ', 1)
    assert [body.joint.name for body in parse_urdf(spaced).bodies] == ["elbow"]


def test_without_the_xacro_package_the_error_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xacro", None)
    path = tmp_path / "arm.xacro"
    path.write_text(one_joint())
    with pytest.raises(ModelError, match=r'pip install "cutpoint\[xacro\]"'):
        load_urdf(path)


@pytest.mark.parametrize("tag", ["include", "macro", "property"])
def test_xacro_elements_without_its_prefix_do_not_leave_a_smaller_robot(tmp_path: Path, tag: str) -> None:
    text = f'<robot name="r" {XACRO}>{link("base")}\n<{tag} name="p" filename="parts.xacro"/></robot>'
    told = f"^<{tag}> lacks the prefix of xacro, which therefore passes it over; write <xacro:{tag}>, in a file with"
    with pytest.raises(ModelError, match=rf"{told} the ending \.xacro, or remove it \(arm\.urdf:2\)"):
        parse_urdf(text, "arm.urdf")
    (path := tmp_path / "parts.xacro").write_text(text)
    with pytest.raises(ModelError, match=rf"{told} .* \({re.escape(str(path))}:2\)"):
        load_urdf(path)
    (path := tmp_path / "arm.xacro").write_text(including("parts.xacro"))
    with pytest.raises(ModelError, match=rf"{told} .* \({re.escape(str(path))}, expanded:\d+\)"):
        load_urdf(path)


def test_xacro_elements_in_a_urdf_are_pointed_out() -> None:
    text = f'<robot {XACRO}>\n<xacro:macro name="m"/></robot>'
    remedy = r"give the file the ending \.xacro, or remove the element if the file is already expanded"
    with pytest.raises(ModelError, match=rf"^<xacro:macro> is an element of xacro; {remedy} \(arm\.urdf:2\)"):
        parse_urdf(text, "arm.urdf")


@pytest.mark.parametrize(("end", "most"), [(1e16, np.pi), (2.5, 2.5)])
def test_random_positions_take_limits_that_no_joint_has_for_none(end: float, most: float) -> None:
    limits = f'<limit lower="{-end}" upper="{end}" effort="1" velocity="1"/>'
    q = Robot(parse_urdf(one_joint(limits))).random(0, 1000)
    assert 0.9 * most < np.abs(q).max() <= most


@pytest.mark.parametrize("limits", [Limits(lower=4.0), Limits(upper=-4.0), Limits(lower=1.0), Limits(upper=0.5)])
def test_random_positions_keep_to_one_limit_alone(limits: Limits) -> None:
    arm = Robot(parse_urdf(one_joint('<limit effort="1" velocity="1"/>').replace("revolute", "continuous")))
    q = arm.with_drives({"elbow": Drive(limits=limits)}).random(0, 1000)
    assert limits.lower <= q.min() and q.max() <= limits.upper
    assert 0.9 * np.pi < np.ptp(q) <= 2 * np.pi


def test_random_positions_keep_to_the_drives_limits_too_which_must_leave_some() -> None:
    arm = Robot(parse_urdf(one_joint('<limit lower="-2" upper="2.5" effort="1" velocity="1"/>')))
    q = arm.with_drives({"elbow": Drive(limits=Limits(-0.1, 3.0))}).random(0, 1000)
    assert -0.1 <= q.min() < 0.0 and 2.4 < q.max() <= 2.5
    with pytest.raises(
        ModelError, match=r"its drive's position limits, \[4, 5\], and the robot's, \[-2, 2.5\], do not overlap"
    ):
        arm.with_drives({"elbow": Drive(limits=Limits(4.0, 5.0))})

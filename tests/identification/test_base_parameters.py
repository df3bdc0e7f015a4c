"""Base parameters: as many as motion can identify, and enough for every torque."""

import numpy as np
import pytest
from two_joints import two_joints

import cutpoint
from cutpoint import Drive, Robot, Rotor
from cutpoint.formats import parse_urdf
from cutpoint.identification import base_parameters
from robot_library import assert_close, robot, states

ROBOTS = ("xia2019", "ur10", "panda", "panda_coupled", "mixed", "weightless")

SIX_JOINTS = 36
"""Of arms of six turning joints whose first axis stands upright, as the Puma 560: Khalil and Dombre (2002), ch. 9."""


def motions_of(arm: Robot, seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    v, a = rng.normal(size=(2, count, arm.nv))
    return arm.random(rng, count), v, a


@pytest.mark.parametrize("name", ROBOTS)
def test_base_parameters_are_as_many_as_the_regressor_has_rank(name: str) -> None:
    arm = robot(name)
    Y = arm.regressor(*motions_of(arm, 7, 500)).reshape(-1, arm.inertial_parameters.size)
    sizes = np.linalg.svd(Y, compute_uv=False)
    assert base_parameters(arm).independent.size == (sizes > 1e-10 * sizes[0]).sum()


@pytest.mark.parametrize("name", ["xia2019", "ur10"])
def test_arms_of_six_joints_have_the_textbook_count(name: str) -> None:
    assert base_parameters(robot(name)).independent.size == SIX_JOINTS


@pytest.mark.parametrize("name", ROBOTS)
def test_base_parameters_give_the_torques_of_all_parameters_whatever_they_are(name: str) -> None:
    arm = robot(name)
    found, p = base_parameters(arm), np.random.default_rng(3).normal(size=arm.inertial_parameters.size)
    moved = states(arm)
    assert_close(found.regressor(*moved) @ (found.matrix @ p), arm.regressor(*moved) @ p)
    assert_close(found.regressor(*moved) @ found.nominal, arm.regressor(*moved) @ arm.inertial_parameters)


@pytest.mark.parametrize("name", ["rigid", "ur10"])
def test_with_rotors_base_parameters_give_the_whole_inverse_dynamics(name: str) -> None:
    arm = robot(name)
    found, moved = base_parameters(arm, rotors=True), states(arm)
    assert_close(found.regressor(*moved) @ found.nominal, arm.inverse_dynamics(*moved))


def test_rotors_that_no_link_holds_count_in_the_nominal_base_parameters() -> None:
    arm = robot("rigid")
    heavy = Rotor(2e-5, in_link_inertia=False, mass=2.0, transverse=1e-3, position=0.05)
    arm = arm.with_drives(dict.fromkeys(arm.joints, Drive(100.0, heavy)))
    found, moved = base_parameters(arm, rotors=True), states(arm)
    assert_close(found.regressor(*moved) @ found.nominal, arm.inverse_dynamics(*moved))


def test_two_joints_in_a_vertical_plane_have_six_and_each_is_named() -> None:
    found = base_parameters(two_joints())
    assert found.names == (
        "h_x.upper + 0.5 m.lower",
        "h_z.upper",
        "I_yy.upper + 0.25 m.lower",
        "h_x.lower",
        "h_z.lower",
        "I_yy.lower",
    )
    assert set(found.unidentifiable) >= {"m.upper", "h_y.upper", "h_y.lower", "I_xz.lower"}


def test_a_horizontal_plane_hides_the_first_moment_of_the_first_body() -> None:
    level = two_joints().with_gravity([0.0, 9.81, 0.0])
    assert base_parameters(level).names == ("I_yy.upper + 0.25 m.lower", "h_x.lower", "h_z.lower", "I_yy.lower")


def test_the_first_rotor_cannot_be_told_from_the_first_body_and_the_second_can() -> None:
    arm = two_joints().with_drives({"shoulder": Drive(100.0, Rotor(1e-5))})
    names = base_parameters(arm, rotors=True).names
    assert "I_yy.upper + 0.25 m.lower + I_m.shoulder" in names and "I_m.elbow" in names


def test_rotors_count_at_the_joints_that_are_named() -> None:
    arm = two_joints().with_drives({joint: Drive(100.0, Rotor(1e-5)) for joint in two_joints().joints})
    found = base_parameters(arm, rotors=["elbow"])
    assert "I_m.elbow" in found.names and not any("I_m.shoulder" in name for name in found.names)
    q, v, a = states(arm)
    without = arm.with_drives({"shoulder": Drive(100.0, Rotor(0.0))})
    assert_close(found.regressor(q, v, a) @ found.nominal, without.inverse_dynamics(q, v, a))
    with pytest.raises(cutpoint.InputError, match="no driven joint is named 'wrist'; there are: 'shoulder', 'elbow'"):
        base_parameters(arm, rotors=["wrist"])


def test_a_robot_without_joints_is_refused() -> None:
    from cutpoint.model.build import build
    from cutpoint.model.mechanism import Link

    with pytest.raises(cutpoint.InputError, match="has no joint"):
        base_parameters(Robot(build("block", [Link("block", 1.0)], [])))


THREE_JOINTS = """<robot name="three"><link name="base"/>{links}
<joint name="a" type="continuous"><parent link="base"/><child link="l1"/><origin rpy="{right} 0 0"/>
  <axis xyz="0 1 0"/></joint>
<joint name="b" type="continuous"><parent link="l1"/><child link="l2"/><origin xyz="0.1 0 0.2"/>
  <axis xyz="0 0 1"/></joint>
<joint name="c" type="continuous"><parent link="l2"/><child link="l3"/><origin xyz="0.3 0 0" rpy="0 0 0.4"/>
  <axis xyz="0 0 1"/></joint></robot>"""
LINK = """<link name="l{k}"><inertial><origin xyz="0.1 0.02 0.03"/><mass value="2"/>
<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def test_an_axis_that_is_upright_but_for_rounding_does_not_feel_the_weight() -> None:
    text = THREE_JOINTS.replace("{links}", "".join(LINK.format(k=k) for k in (1, 2, 3)))
    exact, rounded = (
        base_parameters(Robot(parse_urdf(text.format(right=angle)))).independent.tolist()
        for angle in (repr(np.pi / 2), "1.570796")
    )
    assert rounded == exact

"""Joints locked, and angles in degrees or radians, by options of commands."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_runs import OF_COMMANDS, ONE_JOINT, printed, taken_by
from typer.testing import CliRunner

from cutpoint import InputError, ModelError
from cutpoint.commands import app


def test_joints_are_locked_and_gravity_turned_as_the_options_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    hanging = printed("torque", "arm.urdf", "--q", "0")
    lying = printed("torque", "arm.urdf", "--q", "0", "--gravity", "0", "-9.81", "0")
    assert "-0.981" in hanging and "-0.981" not in lying
    locked = [f"--lock=joint{k}=0.1" for k in range(2, 7)]
    told = printed("torque", "xia2019", "--q", "0.1", *locked)
    assert "joint1" in told and "joint2" not in told


def test_a_joint_is_locked_at_one_place() -> None:
    with pytest.raises(InputError, match=r"--lock 'joint2=0.2': 'joint2' is already locked at 0.1; give one position"):
        twice = ["--lock=joint2=0.1", "--lock=joint2=0.2"]
        CliRunner().invoke(app, ["inspect", "xia2019", *twice], catch_exceptions=False)


OF_FIVE = {
    "torque": ("--q", "0,60,0,45,0"),
    "modes": ("--q", "0,60,0,45,0"),
    "simulate": ("--to", "0,3,0,2,0", "--duration", "0.1"),
    "check": ("--to", "0,3,0,2,0", "--duration", "1"),
}


@pytest.mark.parametrize("command", [own for own in OF_COMMANDS if "degrees" in taken_by(own)])
def test_joints_are_locked_in_degrees_where_angles_are_given_in_them(command: str) -> None:
    arguments = (command, "xia2019", *OF_FIVE[command], "--degrees")
    given = [CliRunner().invoke(app, [*arguments, f"--lock=joint2={place}"]).output for place in ("30", "60", "30.0")]
    assert given[0] == given[2] != given[1]
    radians = f"{np.radians(30):.17g}"
    turned = ",".join(f"{np.radians(float(x)):.17g}" for x in OF_FIVE[command][1].split(","))
    rest = (OF_FIVE[command][0], turned, *OF_FIVE[command][2:])
    told = CliRunner().invoke(app, [command, "xia2019", *rest, f"--lock=joint2={radians}"]).output
    assert told == given[0]


@pytest.mark.parametrize(
    ("command", "option", "rest"),
    [
        ("torque", "--q", ()),
        ("modes", "--q", ()),
        ("simulate", "--to", ("--duration", "1")),
        ("check", "--to", ("--duration", "1")),
        ("simulate", "--from", ("--to", "0,0,0,0,0,0", "--duration", "1")),
    ],
)
def test_angles_of_many_turns_are_taken_for_degrees_that_nobody_stated(
    command: str, option: str, rest: tuple[str, ...]
) -> None:
    told = rf"{option}: joint 'joint2': position -12.57 looks like degrees; add --degrees"
    with pytest.raises(InputError, match=told):
        CliRunner().invoke(app, [command, "xia2019", option, "12.56,-12.57,0,0,0,0", *rest], catch_exceptions=False)


def test_lengths_speeds_and_stated_degrees_may_be_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    printed("torque", "xia2019", "--q", "1000,0,0,0,0,0", "--degrees")
    printed("torque", "xia2019", "--q", "0,0,0,0,0,0", "--v", "20,0,0,0,0,0", "--a", "100,0,0,0,0,0")
    sliding = ONE_JOINT.format(joint="slide").replace("revolute", "prismatic").replace('"-1"', '"-50"')
    Path("arm.urdf").write_text(sliding.replace('"1" effort', '"50" effort'), encoding="utf-8")
    printed("torque", "arm.urdf", "--q", "20")


def test_a_joint_that_slides_is_locked_in_metres_also_among_degrees(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    inner = re.findall(r"<link name=\"a.*</joint>", ONE_JOINT.format(joint="slide"), re.DOTALL)[0]
    inner = (
        inner.replace("a[red]", "b")
        .replace("base", "a[red]")
        .replace("revolute", "prismatic")
        .replace("0 1 0", "1 0 0")
    )
    text = ONE_JOINT.format(joint="swing").replace("</robot>", f"{inner}</robot>")
    Path("arm.urdf").write_text(text, encoding="utf-8")
    degrees = printed("torque", "arm.urdf", "--lock", "slide=0.5", "--degrees", "--q", "0")
    assert degrees == printed("torque", "arm.urdf", "--lock", "slide=0.5", "--q", "0")
    assert degrees != printed("torque", "arm.urdf", "--lock", "slide=0.4", "--q", "0")
    with pytest.raises(
        ModelError, match=r"lock of joint 'slide': value 500.0 m is far outside its .*; 500 mm are 0.5 m"
    ):
        CliRunner().invoke(app, ["torque", "arm.urdf", "--lock", "slide=500", "--q", "0"], catch_exceptions=False)


@pytest.mark.parametrize("lock", ["joint2", "joint2=", "=0.1", "joint2=0.1rad"])
def test_a_lock_without_joint_or_place_is_refused(lock: str) -> None:
    with pytest.raises(InputError, match=r"must be JOINT=PLACE, such as finger_joint=0.02, in rad \(m\)"):
        CliRunner().invoke(app, ["inspect", "xia2019", "--lock", lock], catch_exceptions=False)

"""`cutpoint inspect`: robots and drives as they are read."""

import re
from pathlib import Path

import pytest
from command_runs import ELASTIC, ONE_JOINT, printed, saved
from typer.testing import CliRunner

from cutpoint import InputError, ModelError
from cutpoint.commands import app

MOTOR = "ratio: 100, motor: {torque_constant: 0.02, current_limit: 2}"


def test_a_robot_is_saved_with_its_joints_and_drives(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    (tmp_path / "arm.yaml").write_text(ELASTIC, encoding="utf-8")
    found = saved(tmp_path, "inspect", str(tmp_path / "arm.urdf"), "--drives", str(tmp_path / "arm.yaml"))
    assert found["joints"] == {
        "swing": {
            "kind": "revolute", "carries": "a[red]", "carried_by": "world", "mass": 1.0,
            "position_limits": [-1.0, 1.0], "speed_limit": 3.0, "effort_limit": 10.0,
        }
    }  # fmt: skip
    drive = found["drives"]["swing"]
    assert (drive["ratio"], drive["reflected_inertia"], drive["rotor"]["inertia"]) == (100.0, pytest.approx(0.1), 1e-5)
    assert (drive["compliance"], drive["laws"]) == ({"stiffness": 1e4}, {"compliance": "LinearSpring"})
    assert drive["limits"] == {"lower": None, "upper": None, "velocity": None, "effort": None}
    assert found["gravity"] == [0.0, 0.0, -9.81] and "swing" in found["frames"] and "damping" not in drive


def test_an_effort_limit_is_what_the_motor_can_do_with_its_current(tmp_path: Path) -> None:
    arm, drives = tmp_path / "arm.urdf", tmp_path / "arm.yaml"
    arm.write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    drives.write_text(ELASTIC.replace("ratio: 100", MOTOR), encoding="utf-8")
    assert "4 N m" in printed("inspect", str(arm), "--drives", str(drives))
    assert saved(tmp_path, "inspect", str(arm), "--drives", str(drives))["joints"]["swing"]["effort_limit"] == 4.0


def test_limits_of_the_drive_are_shown_beside_those_of_the_robot_file(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    drives = tmp_path / "arm.drives.yaml"
    for torque, counts in ((6.5, "6.5 N m"), (60, "10 N m")):
        limits = f"{{torque: {torque}, velocity: 2.5, position: [-0.5, .inf]}}"
        drives.write_text(f"version: 1\ndrives: {{swing: {{limits: {limits}}}}}\n", encoding="utf-8")
        arguments = ("inspect", str(tmp_path / "arm.urdf"), "--drives", str(drives))
        told = " ".join(printed(*arguments).split())
        assert saved(tmp_path, *arguments)["joints"]["swing"]["position_limits"] == [-0.5, 1.0]
        assert f"-28.65 to 57.3 deg │ 143.2 deg/s │ {counts} │" in told and f"limit {torque} N m" in told
        assert "limit 2.5 rad/s" in told and "from -28.65 to inf deg" in told


FOLLOWING = """<link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
</inertial></link><joint name="finger" type="{kind}"><parent link="base"/><child link="b"/>
<limit lower="-1" upper="1" effort="10" velocity="3"/><mimic joint="swing" {mimic}/></joint></robot>"""


@pytest.mark.parametrize(
    ("kind", "mimic", "told"),
    [
        ("revolute", 'multiplier="-0.5" offset="0.1"', "follows swing x -0.5 + 0.1 rad"),
        ("prismatic", 'multiplier="2" offset="-0.1"', "follows swing x 2 - 0.1 m"),
        ("revolute", 'offset="0.1"', "follows swing + 0.1 rad"),
        ("prismatic", "", "follows swing"),
    ],
)
def test_a_coupled_mimic_joint_is_shown_with_whom_it_follows_and_without_limits(
    kind: str, mimic: str, told: str, tmp_path: Path
) -> None:
    text = ONE_JOINT.format(joint="swing").replace("</robot>", FOLLOWING.format(kind=kind, mimic=mimic))
    (path := tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    _, _, rows = printed("inspect", str(path), "--mimic", "coupled").partition("│ finger ")
    cells = [line.split("│")[1:-1] for line in f"│ finger {rows}".partition("└")[0].splitlines()]
    _, kinds, *_, position, speed, effort = (" ".join(" ".join(x).split()) for x in zip(*cells, strict=True))
    assert (kinds, position, speed, effort) == (f"{kind} {told}", "-", "-", "-")


def test_speed_limits_and_gravity_are_shown(tmp_path: Path) -> None:
    (path := tmp_path / "arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    told = printed("inspect", str(path), "--gravity", "0", "1.5", "-9.7")
    assert " 171.9 deg/s │" in told
    assert "\ngravity: 0, 1.5, -9.7 m/s2 in the world's frame\n" in told
    path.write_text(path.read_text("utf-8").replace("revolute", "prismatic").replace('velocity="3"', 'velocity="0.25"'))
    assert " 0.25 m/s │" in printed("inspect", str(path))
    path.write_text(path.read_text("utf-8").replace('velocity="0.25"', 'velocity="0"'))
    assert "m/s " not in printed("inspect", str(path))


def test_a_robot_that_stands_is_told_in_a_sentence(tmp_path: Path) -> None:
    (path := tmp_path / "rack.urdf").write_text('<robot name="rack"><link name="base"/></robot>', encoding="utf-8")
    gravity = "gravity: 0, 0, -9.81 m/s2 in the world's frame"
    assert printed("inspect", str(path)) == f"rack has no moving joint.\n{gravity}\nframes: 'base'\n"


def test_drives_of_joints_that_slide_are_shown_in_newtons(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sliding = ONE_JOINT.format(joint="swing").replace("revolute", "prismatic")
    Path("arm.urdf").write_text(sliding, encoding="utf-8")
    parts = "damping: 5.0, hysteresis: {loss: 1.0e-5}, ratings: {rated_torque: 100.0}"
    Path("arm.yaml").write_text(ELASTIC.replace("}}}}", f"}}}}, {parts}}}}}"), encoding="utf-8")
    told = printed("inspect", "arm.urdf", "--drives", "arm.yaml")
    assert "damping 5 N s/m" in told and "rated 100 N " in told and "N m" not in told.split("drives, at")[1]
    assert "laws in N, m and s on prismatic joints" in " ".join(told.split())
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    told = " ".join(printed("inspect", "arm.urdf", "--drives", "arm.yaml").split())
    assert "laws in N m, rad and s gravity" in told and ": 2 subsystems, 1 cutting point " in told


def test_inertias_are_mended_on_demand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sound = ONE_JOINT.format(joint="swing")
    Path("arm.urdf").write_text(re.sub('ixx="[^"]*"', 'ixx="9"', sound), encoding="utf-8")
    with pytest.raises(ModelError, match=r"would do; mend_inertia=True does that \(--mend-inertia\)"):
        CliRunner().invoke(app, ["inspect", "arm.urdf"], catch_exceptions=False)
    with pytest.warns(UserWarning, match="physically impossible inertias are increased"):
        assert "swing" in printed("inspect", "arm.urdf", "--mend-inertia")
    Path("arm.xml").write_text("<mujoco><worldbody/></mujoco>", encoding="utf-8")
    with pytest.raises(InputError, match=r'mend_inertia is for URDF files; state <compiler balanceinertia="true"/>'):
        CliRunner().invoke(app, ["inspect", "arm.xml", "--mend-inertia"], catch_exceptions=False)


def test_xacro_files_take_arguments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = ONE_JOINT.format(joint="$(arg side)_swing").replace(
        "<robot ", '<robot xmlns:xacro="http://ros.org/wiki/xacro" '
    )
    Path("arm.urdf.xacro").write_text(text, encoding="utf-8")
    assert "left_swing" in printed("inspect", "arm.urdf.xacro", "--xacro", "side:=left")
    for wrong in ("side=left", ":=left"):
        with pytest.raises(InputError, match=rf"--xacro '{wrong}' must be NAME:=VALUE, such as ur_type:=ur10e"):
            CliRunner().invoke(app, ["inspect", "arm.urdf.xacro", "--xacro", wrong], catch_exceptions=False)

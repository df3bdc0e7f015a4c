"""`cutpoint torque`."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from command_runs import ONE_JOINT, printed, saved
from typer.testing import CliRunner

import cutpoint
from cutpoint import InputError, Log, ModelError, robots
from cutpoint.commands import app

BODY = '<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
TWO_JOINTS = f"""<robot name="cart"><link name="base"/><link name="a"><inertial>{BODY}</inertial></link>
<link name="b"><inertial>{BODY}</inertial></link>
<joint name="glide" type="{{kind}}"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="swing" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint></robot>"""


def test_what_rounding_leaves_of_a_torque_is_printed_as_none() -> None:
    """Where joint5 stands upright gravity asks 1.8e-16 N m of it."""
    table = [line.split("│") for line in printed("torque", "xia2019", "--q", "0,0,0,0,90,0", "--degrees").splitlines()]
    (joint5,) = [cells for cells in table if len(cells) > 1 and cells[1].strip() == "joint5"]
    assert [cell.strip() for cell in joint5[3:7]] == ["0", "0", "0", "0 arcmin"]


def test_torques_that_are_equal_are_printed_equal() -> None:
    """At rest a link's drive bears gravity and nothing else."""
    told = printed("torque", "xia2019", "--q", "0,30,60,0,45,0", "--degrees")
    rows = [[cell.strip() for cell in line.split("│")] for line in told.splitlines() if line.startswith("│")]
    assert len(rows) == 6 and all(gravity == on_link for _, _, _, gravity, on_link, *_ in rows)
    assert "14.2307" in {row[3] for row in rows}
    assert "at rest" in told and "speeds" not in told
    assert "speeds 0, 1, 0, 0, 0, 0" in printed("torque", "xia2019", "--q", "0,0,0,0,0,0", "--v", "0,1,0,0,0,0")


def test_torques_at_a_place_are_saved_as_they_are_computed(tmp_path: Path) -> None:
    given = {"--q": "0,30,60,0,45,0", "--v": "1,2,3,4,5,6", "--a": "6,5,4,3,2,1"}
    found = saved(tmp_path, "torque", "xia2019", *itertools.chain(*given.items()), "--degrees")
    arm = robots.xia2019()
    motion = [np.radians([float(x) for x in text.split(",")]) for text in given.values()]
    u = arm.elastic_inverse_dynamics(*motion, np.zeros(6), np.zeros(6), quasi_rigid=True)
    lead = u.theta - motion[0]
    on_link = u.joint_torque + arm.friction_torques(motion[1])
    expected = [*motion, arm.gravity_forces(motion[0]), on_link, u.motor_torque, lead]
    names = ["position", "speed", "acceleration", "gravity", "joint_torque", "motor_torque", "motor_lead"]
    assert (found["robot"], [*found["joints"]]) == (arm.name, [*arm.joints])
    for name, values in zip(names, expected, strict=True):
        assert [joint[name] for joint in found["joints"].values()] == values.tolist()
    with pytest.raises(InputError, match=r"torque: --json applies only to --q; save a motion's torques by --output"):
        CliRunner().invoke(app, ["torque", "xia2019", "move.csv", "--json", "x.json"], catch_exceptions=False)


def test_torques_along_a_motion_are_those_of_its_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    arm, times = robots.xia2019(), np.linspace(0.0, 1.0, 501)
    q = cutpoint.trajectories.cycloid(np.full(6, 0.5), 1.0)(times).q
    head = ",".join(["t", *(f"{name} [rad]" for name in arm.joints)])
    np.savetxt("move.csv", np.c_[times, q], delimiter=",", header=head, comments="")
    told = printed(
        "torque", "xia2019", "move.csv", "--period", "0.01", "--output", "torques.csv", "--plot", "torques.png"
    )
    log, drives = Log.load("torques.csv"), cutpoint.load(robots.XIA2019_URDF, robots.XIA2019_DRIVES)
    smooth = cutpoint.trajectories.from_csv("move.csv", arm.joints)
    expected = drives.elastic_inverse_dynamics(*smooth.derivatives(log.time, 4))
    np.testing.assert_allclose(log["motor_torque"], expected.motor_torque, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(log["theta"], expected.theta, rtol=1e-12, atol=1e-12)
    assert len(log.time) == 101 and Path("torques.png").stat().st_size > 10_000
    fine = drives.elastic_inverse_dynamics(*smooth.derivatives(np.linspace(0.0, 1.0, 1001), 4))
    assert f"{np.abs(fine.motor_torque).max(axis=0)[1]:.4g} N m" in told
    fastest = np.degrees(np.abs(smooth.derivatives(np.linspace(0.0, 1.0, 1001), 1)[1]).max())
    assert f"{fastest:.4g} deg/s" in told
    slower = printed("torque", "xia2019", "move.csv", "--duration", "2")  # twice as long as in the file
    assert f"{fastest / 2:.4g} deg/s" in slower
    with pytest.raises(
        InputError, match=r"--period 1e-09 s: a motion of 1 s then has 1e\+09 samples, at most 1e\+06 are allowed"
    ):
        CliRunner().invoke(app, ["torque", "xia2019", "move.csv", "--period", "1e-9"], catch_exceptions=False)


def test_a_joint_s_torque_is_what_its_gear_bears_against_the_link_s_friction_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a log of `simulate`: a rigid drive without friction of its motor exerts all of the motor's torque."""
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    parts = "ratio: 100, friction: {link: {coulomb: 5}}, ratings: {momentary_peak_torque: 3}"
    Path("arm.yaml").write_text(f"version: 1\ndrives: {{swing: {{{parts}}}}}\n", encoding="utf-8")
    there = ("torque", "arm.urdf", "--drives", "arm.yaml", "--q", "0", "--v", "1")
    (swing,) = saved(tmp_path, *there)["joints"].values()
    assert swing["joint_torque"] == pytest.approx(swing["motor_torque"], rel=1e-14)
    assert swing["motor_torque"] == pytest.approx(swing["gravity"] + 5.0, rel=1e-12)
    assert "note: swing transmits up to 4.019 N m, above its gear's momentary peak of 3" in printed(*there)
    times = np.linspace(0.0, 1.0, 101)
    q = cutpoint.trajectories.cycloid([0.5], 1.0)(times).q
    np.savetxt("move.csv", np.c_[times, q], delimiter=",", header="t,swing [rad]", comments="")
    printed("torque", "arm.urdf", "move.csv", "--drives", "arm.yaml", "--output", "torques.csv")
    log = Log.load("torques.csv")
    np.testing.assert_allclose(log["joint_torque"], log["motor_torque"], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give a CSV file TRAJECTORY, or one position as --q"),
        (
            ["move.csv", "--q", "0,0,0,0,0,0"],
            "trajectory 'move.csv' is already a motion: leave out --q, --v, --a and --degrees",
        ),
        (
            ["--q", "0,0,0,0,0,0", "--output", "torques.csv"],
            "--output, --plot, --smoothing and --duration apply only to a CSV file",
        ),
        (["--q", ""], "torque: give a CSV file TRAJECTORY, or one position as --q"),
        (["--q", "0,0,0,0,0,0", "--duration", "5"], "--smoothing and --duration apply only to a CSV file"),
        (
            ["--q", "0,0,0,0,0,0", "--smoothing", "5"],
            "--output, --plot, --smoothing and --duration apply only to a CSV file",
        ),
    ],
)
def test_torques_are_of_one_place_or_of_a_motion(arguments: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        CliRunner().invoke(app, ["torque", "xia2019", *arguments], catch_exceptions=False)


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_a_motion_in_a_file_is_refused_where_a_joint_has_no_motor(kind: str, tmp_path: Path) -> None:
    arm, motion = tmp_path / "arm.urdf", tmp_path / "move.csv"
    arm.write_text(TWO_JOINTS.format(kind=kind), encoding="utf-8")
    motion.write_text("t,swing\n" + "".join(f"{t / 10},0.5\n" for t in range(11)), encoding="utf-8")
    joint = r"torque: a (floating base|planar joint) has no motor \('glide'\)"
    with pytest.raises(InputError, match=rf"{joint}: a file .*; fix it in the robot file, or use Python"):
        CliRunner().invoke(app, ["torque", str(arm), str(motion)], catch_exceptions=False)


def test_what_is_to_be_done_about_coarse_samples_names_the_option(tmp_path: Path) -> None:
    path = tmp_path / "coarse.csv"
    rows = "".join(f"{t},{(-1) ** t}{',0' * 5}\n" for t in range(5))
    path.write_text(f"t,{','.join(f'joint{k}' for k in range(1, 7))}\n{rows}", encoding="utf-8")
    with pytest.raises(InputError, match=r"give samples closer in time, or a bandwidth \(--smoothing\); in Python, at"):
        CliRunner().invoke(app, ["torque", "xia2019", str(path)], catch_exceptions=False)
    with pytest.raises(InputError, match=r"bandwidth 50.0 Hz \(--smoothing\) must lie between"):
        CliRunner().invoke(app, ["torque", "xia2019", str(path), "--smoothing", "50"], catch_exceptions=False)


def test_what_the_robot_carries_is_a_point_mass_in_the_frame_that_a_note_names(tmp_path: Path) -> None:
    at = ["xia2019", "--q", "0,30,60,0,45,0", "--degrees", "--carry", "2", "0.05", "0", "0.1"]
    found = saved(tmp_path, "torque", *at)
    heavy = robots.xia2019().with_payload(2.0, [0.05, 0.0, 0.1], np.zeros((3, 3)), "tool")
    expected = heavy.gravity_forces(np.radians([0, 30, 60, 0, 45, 0]))
    np.testing.assert_allclose([joint["gravity"] for joint in found["joints"].values()], expected, rtol=1e-12, atol=0)
    assert "note: carries 2 kg, at 0.05, 0, 0.1 m in the frame 'tool'" in printed("torque", *at)


def test_the_frame_of_what_the_robot_carries_may_be_named(tmp_path: Path) -> None:
    at = ["xia2019", "--q", "0,30,60,0,45,0", "--degrees"]
    found = saved(tmp_path, "torque", *at, "--carry", "2", "0.05", "0", "0.1", "--carry-frame", "link3")
    heavy = robots.xia2019().with_payload(2.0, [0.05, 0.0, 0.1], np.zeros((3, 3)), "link3")
    expected = heavy.gravity_forces(np.radians([0, 30, 60, 0, 45, 0]))
    np.testing.assert_allclose([joint["gravity"] for joint in found["joints"].values()], expected, rtol=1e-12, atol=0)
    with pytest.raises(InputError, match=r"no frame is named 'link9'; there are: 'joint1'"):
        CliRunner().invoke(
            app, ["torque", *at, "--carry", "2", "0", "0", "0", "--carry-frame", "link9"], catch_exceptions=False
        )
    with pytest.raises(InputError, match=r"--carry-frame 'link3' needs a payload: add --carry KG X Y Z"):
        CliRunner().invoke(app, ["torque", *at, "--carry-frame", "link3"], catch_exceptions=False)


@pytest.mark.parametrize("given", [["2"], ["2", "0", "0", "--degrees"]])
def test_values_that_an_option_lacks_are_named(given: list[str]) -> None:
    refused = CliRunner().invoke(app, ["torque", "xia2019", "--q", "0,0,0,0,0,0", "--carry", *given])
    assert refused.exit_code == 2
    assert "'--carry'" in refused.output and re.search(r"give KG\s+X\s+Y[\s│]+Z", refused.output)


@pytest.mark.parametrize("mass", ["-1", "nan"])
def test_a_payload_without_a_mass_is_refused(mass: str) -> None:
    refused = CliRunner().invoke(app, ["torque", "xia2019", "--q", "0,0,0,0,0,0", "--carry", mass, "0", "0", "0"])
    assert isinstance(refused.exception, ModelError)
    assert re.match("link 'payload': mass.* must", str(refused.exception))


def test_torques_above_limits_are_noted_at_a_place_and_along_a_motion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"))
    Path("move.csv").write_text("t,swing\n" + "".join(f"{0.01 * k},0\n" for k in range(101)))
    # (20 + 1) kg at 0.1 m
    told = "note: swing needs 20.6 N m of its motor, above its limit of 10"
    for which in (["--q", "0"], ["move.csv"]):
        assert told in printed("torque", "arm.urdf", *which, "--carry", "20", "0.1", "0", "0")
        assert "above its limit" not in printed("torque", "arm.urdf", *which)

"""Common behaviour of commands: names, and places for their files."""

import errno
import itertools
import json
import os
import re
import shlex
import subprocess
import sys
from io import StringIO
from pathlib import Path
from typing import Any, get_args
from unittest.mock import Mock

import numpy as np
import pytest
import typer
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Column, Table
from typer.testing import CliRunner

import cutpoint
from cutpoint import InputError, Log, ModelError, control, robots
from cutpoint.commands import app, laws, shared
from cutpoint.control.laws.feedforward import RUNGS
from cutpoint.control.tuning import recipes
from cutpoint.export import export_controller, export_function
from cutpoint.reporting.fitting import print_table
from cutpoint.reporting.folder import write
from cutpoint.reporting.html import Heading
from cutpoint.simulation import runner
from cutpoint.simulation.log import plot as log_plot
from robot_library import urdf

ONE_JOINT = """<robot name="[/]arm:eyes:"><link name="base"/><link name="a[red]"><inertial><origin xyz="0.1 0 0"/>
<mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="{joint}" type="revolute"><parent link="base"/><child link="a[red]"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="3"/></joint></robot>"""

ELASTIC = """version: 1
drives: {swing: {ratio: 100, rotor: {inertia: 1.0e-5}, compliance: {linear: {stiffness: 1.0e4}}}}
"""

MOTOR = "ratio: 100, motor: {torque_constant: 0.02, current_limit: 2}"

BAD_PLACES = {
    "a folder that is not there": ("none/run.npz", r"'none/run.npz': folder 'none' does not exist; create it"),
    "a folder": ("folder.npz", r"'folder.npz' is a folder; name a file in it"),
    "a file as a folder": ("file/run.npz", r"'file/run.npz': folder 'file' does not exist"),
}


def printed(*arguments: str) -> str:
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    return result.output


OF_COMMANDS = typer.main.get_command(app).commands


def taken_by(command: str) -> set[str]:
    """The names of a command's arguments and options."""
    return {x.name for x in OF_COMMANDS[command].params}


def refuse(*_: object, **__: object) -> None:
    raise AssertionError("work was done first")


@pytest.mark.parametrize("joint", ["finger[left]", "j[/x]", "[bold]j[/bold]", ":eyes:"])
def test_names_are_printed_as_they_are_whatever_brackets_and_colons_they_hold(
    joint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint=joint), encoding="utf-8")
    described = printed("inspect", "arm.urdf")
    assert described.count(f"│ {joint} ") == 2 and "[/]arm:eyes:" in described and "a[red]" in described
    assert f"\nframes: {joint!r}, " in described
    assert f"│ {joint} " in printed("torque", "arm.urdf", "--q", "0.1")
    options = ("--to", "0.01", "--duration", "0.02", "--feedforward", "rigid", "--output", "l[b]og.npz")
    told = printed("simulate", "arm.urdf", *options)
    assert f"│ {joint} " in told and "l[b]og.npz" in told
    assert Log.load("l[b]og.npz").joints == (joint,)


def test_the_path_of_a_file_stands_in_one_line_however_long_it_is(tmp_path: Path) -> None:
    folder = tmp_path / ("a_rather_long_name_of_a_folder" * 5)
    folder.mkdir()
    for word, command in (
        ("log", ("simulate", "xia2019", "--to", "0,0,0,0,0,0", "--duration", "0.01", "--output", "x.npz")),
        ("picture", ("modes", "xia2019", "--plot", "x.png")),
        ("numbers", ("check", "xia2019", "--to", "0,0,0,0,0,0.1", "--duration", "1", "--json", "x.json")),
        ("picture", ("drive", "CSG-20-100", "--plot", "x.png")),
    ):
        path = str(folder / command[-1])
        assert f"{word} saved: {path}\n" in printed(*command[:-1], path)


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


def saved(folder: Path, *arguments: str) -> Any:
    """What a command writes as JSON."""
    file = folder / "found.json"
    assert f"numbers saved: {file}\n" in printed(*arguments, "--json", str(file))
    return json.loads(file.read_text(encoding="utf-8"))


def test_torques_at_a_place_are_saved_as_they_are_computed(tmp_path: Path) -> None:
    given = {"--q": "0,30,60,0,45,0", "--v": "1,2,3,4,5,6", "--a": "6,5,4,3,2,1"}
    found = saved(tmp_path, "torque", "xia2019", *itertools.chain(*given.items()), "--degrees")
    arm = robots.xia2019()
    motion = [np.radians([float(x) for x in text.split(",")]) for text in given.values()]
    u = arm.elastic_inverse_dynamics(*motion, np.zeros(6), np.zeros(6), quasi_rigid=True)
    lead = u.theta - motion[0]
    expected = [*motion, arm.gravity_forces(motion[0]), u.joint_torque, u.motor_torque, lead]
    names = ["position", "speed", "acceleration", "gravity", "joint_torque", "motor_torque", "motor_lead"]
    assert (found["robot"], [*found["joints"]]) == (arm.name, [*arm.joints])
    for name, values in zip(names, expected, strict=True):
        assert [joint[name] for joint in found["joints"].values()] == values.tolist()
    with pytest.raises(InputError, match=r"torque: --json applies only to --q; save a motion's torques by --output"):
        CliRunner().invoke(app, ["torque", "xia2019", "move.csv", "--json", "x.json"], catch_exceptions=False)


def test_modes_are_saved_by_frequency(tmp_path: Path) -> None:
    found = saved(tmp_path, "modes", "xia2019", "--q", "0,30,60,0,45,0", "--degrees")
    modes = robots.xia2019().modes(np.radians([0, 30, 60, 0, 45, 0]))
    assert [mode["frequency"] for mode in found["modes"]] == modes.frequencies.tolist()
    assert [mode["damping_ratio"] for mode in found["modes"]] == modes.damping.tolist()
    assert [mode["drives"] for mode in found["modes"]] == [modes.joints_of(k) for k in range(len(modes.frequencies))]
    assert (found["robot"], found["friction"], found["remark"]) == (robots.xia2019().name, False, None)


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


@pytest.mark.parametrize("name", OF_COMMANDS)
def test_the_example_of_a_command_has_options_that_it_takes(name: str) -> None:
    command = OF_COMMANDS[name]
    _, program, own, *arguments = shlex.split(command.epilog)
    assert (program, own) == ("cutpoint", name)
    command.make_context(name, arguments)


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
    with pytest.raises(
        InputError, match=r"--period 1e-09 s: this gives 1e\+09 samples, at most 1e\+06 are allowed: lengthen it"
    ):
        CliRunner().invoke(app, ["torque", "xia2019", "move.csv", "--period", "1e-9"], catch_exceptions=False)


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
            "--output, --plot and --smoothing apply only to a CSV file",
        ),
        (["--q", "0,0,0,0,0,0", "--smoothing", "5"], "--output, --plot and --smoothing apply only to a CSV file"),
    ],
)
def test_torques_are_of_one_place_or_of_a_motion(arguments: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        CliRunner().invoke(app, ["torque", "xia2019", *arguments], catch_exceptions=False)


def test_every_law_that_can_be_tuned_has_its_name_at_the_command_line() -> None:
    assert get_args(laws.Name) == tuple(law.__name__ for law in recipes.RECIPES)


def test_every_rung_of_the_feedforward_can_be_named_at_the_command_line() -> None:
    assert get_args(shared.RungOption) == ("none", *RUNGS)


@pytest.mark.parametrize("name", ["VDC", "vdc"])
def test_a_law_is_simulated_by_its_name_along_the_motion_of_a_file(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    arm = robots.xia2019()
    times = np.linspace(0, 0.5, 101)
    q = cutpoint.trajectories.cycloid(end=np.full(6, 0.5), duration=0.5).derivatives(times, 0)[0]
    head = ",".join(["t", *(f"{joint} [rad]" for joint in arm.joints)])
    np.savetxt("move.csv", np.c_[times, q], delimiter=",", header=head, comments="")
    printed("simulate", "xia2019", "move.csv", "--law", name, "--bandwidth", "4", "--output", "run.npz")
    motion = cutpoint.trajectories.from_csv("move.csv", arm.joints)
    expected = cutpoint.simulate(arm, control.tune(arm, 4.0, control.VDC), motion)
    np.testing.assert_array_equal(Log.load("run.npz")["q"], expected["q"])


def test_saved_logs_are_drawn_beside_each_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    robot = cutpoint.robots.xia2019()
    run = cutpoint.simulate(robot, None, None, 0.01)
    for folder in ("a", "b"):
        Path(folder).mkdir()
        run.save(f"{folder}/run.npz")
    drawn = Mock(side_effect=log_plot.picture)
    monkeypatch.setattr(log_plot, "picture", drawn)
    printed("plot", "a/run.npz", "--channel", "q", "--output", "one.png")
    printed("plot", "a/run.npz", "b/run.npz", "--output", "both.png")
    assert all(Path(name).stat().st_size > 10_000 for name in ("one.png", "both.png"))
    (one, both), (of_one, of_both) = zip(*(call.args for call in drawn.call_args_list), strict=True)
    assert ([*one], of_one) == ([""], ["q"])
    assert ([*both], of_both) == (["a/run.npz", "b/run.npz"], ["q", "position_error", "motor_torque"])
    Log([0.0], {"x": [0.0]}, {"x": ""}, ()).save("other.npz")
    with pytest.raises(InputError, match=r"none of q, position_error, motor_torque is in every log.*there are: x"):
        CliRunner().invoke(app, ["plot", "other.npz"], catch_exceptions=False)


@pytest.mark.parametrize(("options", "guarded"), [(["--law", "PD"], False), (["--law", "VDC", "--guard"], True)])
def test_a_law_leaves_as_c_by_its_name(options: list[str], guarded: bool, tmp_path: Path) -> None:
    arm, period = robots.xia2019(), 5e-4
    printed("export", "xia2019", str(tmp_path / "found"), *options, "--bandwidth", "4", "--period", str(period))
    if guarded:
        law: Any = control.Guard(arm, control.tune(arm, 4.0, control.VDC, control_period=period))
    else:
        law = control.tune(arm, 4.0, control_period=period) + control.Feedforward(arm, "elastic")
    export_controller(arm, law, tmp_path / "expected", control_period=period)
    for path in (tmp_path / "expected").iterdir():
        assert (tmp_path / "found" / path.name).read_bytes() == path.read_bytes()


def test_an_exported_guard_says_which_joints_it_does_not_limit(tmp_path: Path) -> None:
    limit = "  joint1:\n    limits: {torque: 100}\n"
    drives = tmp_path / "some.yaml"
    drives.write_text(robots.XIA2019_DRIVES.read_text("utf-8").replace("  joint1:\n", limit, 1), "utf-8")
    arm = [str(robots.XIA2019_URDF), "--drives", str(drives), str(tmp_path / "law"), "--law", "PD", "--bandwidth", "4"]
    said = " ".join(printed("export", *arm, "--guard").split())
    others = ", ".join(f"'joint{k}'" for k in range(2, 7))
    assert f"note: the guard has no torque limit for {others}: state it in the robot file" in said
    assert f"note: the guard has no speed limit for 'joint1', {others}: state it in" in said
    assert "note:" not in printed("export", *arm)


def test_a_function_leaves_as_c_with_its_options(tmp_path: Path) -> None:
    function, arm = "elastic_inverse_dynamics", robots.xia2019()
    printed("export", "xia2019", str(tmp_path / "found"), "--function", function, "--quasi-rigid", "--friction-rates")
    export_function(arm, function, tmp_path / "expected", quasi_rigid=True, friction_rates=True)
    for path in (tmp_path / "expected").iterdir():
        assert (tmp_path / "found" / path.name).read_bytes() == path.read_bytes()


def test_a_simulated_law_may_have_a_guard(tmp_path: Path) -> None:
    """Joints turn at 2 rad/s at most: a move that takes 5 is a fault."""
    drives, log = tmp_path / "slow.yaml", tmp_path / "run.npz"
    whole = robots.XIA2019_DRIVES.read_text("utf-8")
    drives.write_text(whole.replace("  ratio: 100\n", "  ratio: 100\n  limits: {velocity: 2.0}\n", 1), "utf-8")
    move = ["--to", "2,0,0,0,0,0", "--duration", "0.8", "--law", "PD", "--guard"]
    printed("simulate", str(robots.XIA2019_URDF), "--drives", str(drives), *move, "--output", str(log))
    assert control.Fault.SPEED in Log.load(log)["fault"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["simulate", "xia2019"], "a motion is needed: give a CSV file TRAJECTORY, or --to with --duration"),
        (
            ["simulate", "xia2019", "--to", "1,1,1,1,1,1", "--duration", "1", "--law", "VDC", "--feedforward", "rigid"],
            "--feedforward rigid: VDC already contains the robot's model; leave this out, or use --law PD or PID",
        ),
        (["export", "xia2019", "out"], "export: say what to export, by --function or --law"),
        (
            ["export", "xia2019", "out", "--law", "PD", "--function", "jacobian"],
            "export: leave out one of --function or --law",
        ),
        (
            ["export", "xia2019", "out", "--law", "PD", "--frame", "link6"],
            "--frame applies only to --function: leave it out",
        ),
        (
            ["export", "xia2019", "out", "--law", "PD", "--quasi-rigid"],
            "--quasi-rigid applies only to --function: leave it out",
        ),
        (
            ["export", "xia2019", "out", "--law", "PD", "--to", "cuda"],
            "--to cuda applies only to --function: leave it out",
        ),
        (["export", "xia2019", "out", "--law", "PD", "--bandwidth", "0"], "export: --bandwidth 0.0 must be positive"),
        (["export", "xia2019", "out", "--law", "PD", "--period", "0"], "export: --period 0.0 must be positive"),
        (
            ["export", "xia2019", "out", "--function", "jacobian", "--guard"],
            "--guard applies only to --law: leave it out",
        ),
        (
            ["export", "xia2019", "out", "--function", "jacobian", "--period", "1"],
            "--period applies only to --law: leave",
        ),
        (["plot", "run.npz", "run.npz"], "'run.npz' is named twice; name each log once"),
        (["export", "xia2019", "out", "--law", "slotineli", "--to", "cuda"], "--to cuda applies only to --function"),
    ],
)
def test_options_of_laws_that_contradict_each_other_are_refused(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=re.escape(message)):
        CliRunner().invoke(app, arguments, catch_exceptions=False)


def test_a_law_that_does_not_exist_is_told_those_that_do() -> None:
    words = CliRunner().invoke(app, ["simulate", "xia2019", "--law", "VCD"], env={"COLUMNS": "300"}).output
    assert "no law is named 'VCD'; there are: 'PD', 'PID', 'ComputedTorque'" in words
    assert "did you mean 'VDC'?" in words


def test_limits_that_a_motion_meets_are_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    beyond = "note: swing goes to 68.75 deg, beyond its limits, -57.3 to 57.3 deg"
    assert beyond in printed("torque", "arm.urdf", "--q", "1.2")
    assert "note:" not in printed("torque", "arm.urdf", "--q", "0.9", "--v", "-3")
    fast = "note: swing moves at up to 177.6 deg/s, above its limit of 171.9 deg/s"
    assert fast in printed("torque", "arm.urdf", "--q", "0.9", "--v", "-3.1")
    calm = printed("simulate", "arm.urdf", "--to", "0.5", "--duration", "1.0")
    wild = printed("simulate", "arm.urdf", "--to", "1.2", "--duration", "0.25")
    assert "note:" not in calm
    assert re.search(r"note: swing goes to [\d.]+ deg, beyond its limits", wild)
    assert re.search(r"note: swing moves at up to [\d.]+ deg/s, above its limit of 171.9 deg/s", wild)
    assert re.search(r"note: swing is asked for more than its limit of 10 N m in \d+\.\d% of the samples", wild)


def test_ctrl_c_saves_what_was_simulated_and_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = ("simulate", "xia2019", "--to", "1,1,1,1,1,1", "--duration", "0.5", "--output")
    samples, heard = runner.run_samples, [0, 0]

    def run_samples(program: Any, memory: Any, first: int, ticks: int, substeps: int) -> int:
        heard[0] += 1
        if heard[0] > 1:
            raise KeyboardInterrupt
        heard[1] = first + ticks
        return samples(program, memory, first, ticks, substeps)

    monkeypatch.setattr(runner, "run_samples", run_samples)
    result = CliRunner().invoke(app, [*arguments, "run.npz"])
    assert result.exit_code == 130
    assert re.search(r"log saved: run.npz\s+interrupted at t = [0-9.]+ s; the log holds", result.output)
    assert len(Log.load("run.npz").time) == heard[1] > 0
    monkeypatch.setattr(cutpoint, "simulate", Mock(side_effect=KeyboardInterrupt))
    result = CliRunner().invoke(app, [*arguments, "none.npz"])
    assert (result.exit_code, result.output) == (130, "interrupted; there is no log to save yet\n")
    assert not Path("none.npz").exists()


def test_a_pipe_that_is_closed_loses_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shared.console, "print", Mock(side_effect=BrokenPipeError))
    ends = ("--to", "1,1,1,1,1,1", "--duration", "0.05")
    result = CliRunner().invoke(app, ["simulate", "xia2019", *ends, "--output", "run.npz", "--plot", "run.png"])
    assert isinstance(result.exception, BrokenPipeError)
    assert Path("run.npz").stat().st_size and Path("run.png").stat().st_size


@pytest.mark.parametrize("ending", ["npz", "csv"])
def test_a_run_whose_log_no_file_would_hold_is_refused_before_it_runs(tmp_path: Path, ending: str) -> None:
    output = tmp_path / f"run.{ending}"
    arguments = ("simulate", "xia2019", "--to", "1,1,1,1,1,1", "--duration", "5000", "--output", str(output))
    result = CliRunner().invoke(app, [*arguments])
    assert isinstance(result.exception, InputError)
    assert re.search(r"a log of 5,000,000 samples may take .* bytes, .*; shorten --duration", str(result.exception))
    assert not output.exists()


@pytest.mark.parametrize(
    ("command", "place", "told"),
    [
        ("paper", "paper.study._page", "no report was written"),
        ("cost", "cost.study.measured", "no report was written"),
        ("compare", "compare.bench_of", "no report was written"),
        ("compare", "compare.study.matched", "results so far go to {}/report/index.html"),
    ],
)
def test_an_interrupted_study_ends_with_130_and_says_whether_there_is_a_report(
    command: str, place: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"cutpoint.studies.{place}", Mock(side_effect=KeyboardInterrupt))
    result = CliRunner().invoke(app, [command, "--output", str(tmp_path / "report")])
    assert (result.exit_code, result.stderr.strip()) == (130, f"interrupted; {told.format(tmp_path)}")
    assert (tmp_path / "report" / "index.html").exists() == ("go to" in told)


@pytest.mark.parametrize("cause", ["KeyboardInterrupt", "ImportError('half made') from KeyboardInterrupt()"])
def test_ctrl_c_while_commands_are_imported_is_told_in_a_line(cause: str) -> None:
    source = """
import sys
from cutpoint.cli import main
class Interrupts:
    def find_spec(self, name, *_):
        if name == "typer":
            raise {cause}
sys.meta_path.insert(0, Interrupts())
main()
"""
    command = [sys.executable, "-c", source.format(cause=cause), "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


TORQUE = ("-m", "cutpoint", "torque", "xia2019", "--q", "0,0,0,0,0,0")


def test_output_on_a_full_disk_is_told() -> None:
    with open("/dev/full", "wb") as full:
        done = subprocess.run([sys.executable, *TORQUE], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "error: the output cannot be written: No space left on device\n"


def test_names_that_a_terminal_cannot_show_are_shown_by_their_code(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(ONE_JOINT.format(joint="Gelenk-\N{GREEK SMALL LETTER ALPHA}"), encoding="utf-8")
    command = [sys.executable, "-m", "cutpoint", "inspect", str(file)]
    environment = os.environ | {"PYTHONIOENCODING": "latin-1"}
    done = subprocess.run(command, capture_output=True, text=True, encoding="latin-1", env=environment, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Gelenk-\\u03b1" in done.stdout


@pytest.mark.parametrize("closed", ["stdout", "stderr"])
def test_commands_run_where_output_is_closed(closed: str) -> None:
    redirection = {"stdout": ">&-", "stderr": "2>&-"}[closed]
    command = ["sh", "-c", f'exec "$@" {redirection}', "sh", sys.executable, *TORQUE]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    "arguments",
    [
        ("modes", "arm.urdf", "--drives", "arm.yaml", "--plot", "run.png"),
        ("check", "arm.urdf", "--to", "0.01", "--duration", "0.02", "--plot", "run.png"),
        ("simulate", "arm.urdf", "--to", "0.01", "--duration", "0.02", "--feedforward", "rigid", "--plot", "run.png"),
        ("drive", "CSG-20-100", "--plot", "run.png"),
    ],
)
def test_a_full_disk_leaves_the_old_picture(
    arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(figure: Any, file: Any, **_: Any) -> None:
        if isinstance(file, str | Path):
            Path(file).write_bytes(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    Path("arm.yaml").write_text(ELASTIC, encoding="utf-8")
    Path("run.png").write_bytes(b"before")
    monkeypatch.setattr(Figure, "savefig", full)
    with pytest.raises(OSError, match=r"No space left on device: 'run.png'"):
        CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert Path("run.png").read_bytes() == b"before"


@pytest.mark.parametrize("module", ["cutpoint", "cutpoint.cli"])
def test_the_commands_run_as_a_module_and_refuse_unknown_ones(module: str) -> None:
    command = [sys.executable, "-m", module, "nonsense"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "No such command 'nonsense'" in done.stderr


def test_limits_of_the_drive_are_shown_beside_those_of_the_robot_file(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    drives = tmp_path / "arm.drives.yaml"
    for torque, counts in ((6.5, "6.5 N m"), (60, "10 N m")):
        limits = f"{{torque: {torque}, velocity: 2.5, position: [-0.5, .inf]}}"
        drives.write_text(f"version: 1\ndrives: {{swing: {{limits: {limits}}}}}\n", encoding="utf-8")
        told = " ".join(printed("inspect", str(tmp_path / "arm.urdf"), "--drives", str(drives)).split())
        assert f"-57.3 to 57.3 deg │ 143.2 deg/s │ {counts} │" in told and f"limit {torque} N m" in told
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


PANDA = str(urdf("panda.urdf"))


@pytest.mark.parametrize(
    "arguments",
    [
        ("inspect", "xia2019"),
        ("inspect", PANDA, "--mimic", "coupled"),
        ("torque", "xia2019", "--q", "1,1,1,1,1,1"),
        ("torque", PANDA, "--mimic", "coupled", "--q", "0.1,0.2,0.3,-1,0.5,1,0.7,0.01"),
        ("modes", "xia2019"),
        ("simulate", "xia2019", "--to", "0.01,0,0,0,0,0", "--duration", "0.5"),
        ("drive",),
    ],
    ids=lambda arguments: " ".join(Path(x).name for x in arguments),
)
def test_no_word_is_broken_on_a_terminal_of_80_columns(
    arguments: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shared.console, "width", 400)
    words = set(re.split(r"[\s│┃,]+", printed(*arguments)))
    monkeypatch.setattr(shared.console, "width", 80)
    narrow = printed(*arguments)
    frames = re.compile("[┏┡└━┳╇┴─┓┩┘]+")
    assert {word for word in re.split(r"[\s│┃,]+", narrow) if not frames.fullmatch(word)} <= words
    assert max(map(len, narrow.splitlines())) <= 80


@pytest.mark.parametrize("width", [200, 60, 40, 33, 32, 20, 12])
def test_a_table_is_no_wider_than_its_place_and_loses_nothing(width: int) -> None:
    """Words are whole as long as there is room for the longest of each column."""
    rows = [("left_shoulder", "0.25 to 0.75 rad", "stribeck, with load"), ("elbow", "-1.5 to 1 rad", "coulomb")]
    columns = (Column(header, overflow="fold") for header in ("joint", "range between limits", "friction"))
    table, written = Table(*columns), StringIO()
    for row in rows:
        table.add_row(*row)
    print_table(table, Console(width=width, file=written))
    shown, text = written.getvalue(), " ".join(itertools.chain(*rows))
    assert max(map(len, shown.splitlines())) <= width
    assert (set(text.split()) <= set(shown.split())) == (width >= 33)
    assert all(shown.count(digit) == text.count(digit) for digit in "012457")


@pytest.mark.parametrize("case", BAD_PLACES)
def test_an_output_that_cannot_be_written_is_refused_before_the_work(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cutpoint.simulate", refuse)
    Path("folder.npz").mkdir()
    Path("file").write_text("mine")
    output, message = BAD_PLACES[case]
    arguments = ["simulate", "xia2019", "--to", "", "--duration", "1", "--output", output]
    with pytest.raises(InputError, match=f"--output {message}"):
        CliRunner().invoke(app, arguments, catch_exceptions=False)


MOTION = "t,swing\n" + "".join(f"{t},0.1\n" for t in range(9))
LOSSES = {
    "itself": ("torque", "motion.csv", "--output", "motion.csv"),
    "by another name": ("simulate", "motion.csv", "--output", "./folder/../motion.csv"),
    "by a link": ("simulate", "motion.csv", "--output", "link.csv"),
    "a picture of a link": ("torque", "motion.csv", "--plot", "link.png"),
    "numbers of a link": ("check", "motion.csv", "--json", "link.json"),
}


@pytest.mark.parametrize("case", LOSSES)
def test_no_command_writes_over_a_file_that_it_reads(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cutpoint.load", refuse)
    Path("folder").mkdir()
    Path("motion.csv").write_text(MOTION, encoding="utf-8")
    for ending in ("csv", "png", "json"):
        Path(f"link.{ending}").symlink_to("motion.csv")
    command, *rest = LOSSES[case]
    told = rf"{rest[1]} '{rest[2].removeprefix('./')}' is the same file as the input 'motion.csv', which would be lost"
    with pytest.raises(InputError, match=f"{told}: name another file"):
        CliRunner().invoke(app, [command, "xia2019", *rest], catch_exceptions=False)
    assert Path("motion.csv").read_text(encoding="utf-8") == MOTION


def test_models_that_are_identified_and_pictures_go_into_no_file_that_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cutpoint.load", refuse)
    Path("robot.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    with pytest.raises(InputError, match=r"--output 'robot.urdf' is the same file as the input 'robot.urdf'"):
        options = ("identify", "robot.urdf", "log.csv", "--output", ".", "--force")
        CliRunner().invoke(app, options, catch_exceptions=False)
    Log([0.0], {"x": [0.0]}, {"x": ""}, ()).save("run.npz")
    Path("link.png").symlink_to("run.npz")
    with pytest.raises(InputError, match=r"--output 'link.png' is the same file as the input 'run.npz'"):
        CliRunner().invoke(app, ["plot", "run.npz", "--output", "link.png"], catch_exceptions=False)


@pytest.mark.parametrize("study", ["paper", "cost", "compare"])
def test_a_report_goes_to_no_folder_that_holds_anothers(study: str, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("mine")
    with pytest.raises(InputError, match=r"holds index.html that this study did not write; name another folder"):
        CliRunner().invoke(app, [study, "--output", str(tmp_path)], catch_exceptions=False)
    assert (tmp_path / "index.html").read_text() == "mine"


def test_a_study_does_not_write_over_the_report_of_another(tmp_path: Path) -> None:
    write(tmp_path, Heading("the paper", "again", ()), [], {}, "results.json", "paper")
    with pytest.raises(InputError, match=r"holds index.html and results.json that this study did not write"):
        CliRunner().invoke(app, ["compare", "--output", str(tmp_path)], catch_exceptions=False)


@pytest.mark.parametrize("option", [("--drives", str(robots.XIA2019_DRIVES)), ("--lock", "panda_joint7=0")])
def test_what_is_said_of_a_file_is_not_forgotten_on_an_arm_that_comes_as_it_is(option: tuple[str, str]) -> None:
    with pytest.raises(InputError, match=rf"panda takes no such options; leave out {option[0]}"):
        CliRunner().invoke(app, ["compare", "panda", *option], catch_exceptions=False)


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


def test_drives_of_joints_that_slide_are_shown_in_newtons(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sliding = ONE_JOINT.format(joint="swing").replace("revolute", "prismatic")
    Path("arm.urdf").write_text(sliding, encoding="utf-8")
    parts = "damping: 5.0, hysteresis: {loss: 1.0e-5}, ratings: {rated_torque: 100.0}"
    Path("arm.yaml").write_text(ELASTIC.replace("}}}}", f"}}}}, {parts}}}}}"), encoding="utf-8")
    told = printed("inspect", "arm.urdf", "--drives", "arm.yaml")
    assert "damping 5 N s/m" in told and "rated 100 N " in told and "N m" not in told.split("drives, at")[1]


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


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("simulate", "--duration"),
        ("simulate", "--bandwidth"),
        ("simulate", "--period"),
        ("torque", "--smoothing"),
        ("torque", "--period"),
        ("check", "--life"),
        ("excite", "--seconds"),
        ("excite", "--speed"),
        ("identify", "--cutoff"),
        ("compare", "--bandwidth"),
    ],
)
def test_a_number_that_must_be_positive_is_refused_by_the_name_of_its_option(command: str, option: str) -> None:
    logs = ("log.csv",) if command == "identify" else ()
    result = CliRunner().invoke(app, [command, "xia2019", *logs, f"{option}=-2"], env={"COLUMNS": "200"})
    assert f"{command}: {option} -2.0 must be positive and finite" in str(result.exception)


def test_what_is_to_be_done_about_coarse_samples_names_the_option(tmp_path: Path) -> None:
    path = tmp_path / "coarse.csv"
    rows = "".join(f"{t},{(-1) ** t}{',0' * 5}\n" for t in range(5))
    path.write_text(f"t,{','.join(f'joint{k}' for k in range(1, 7))}\n{rows}", encoding="utf-8")
    with pytest.raises(InputError, match=r"give samples closer in time, or a bandwidth \(--smoothing\); in Python, at"):
        CliRunner().invoke(app, ["torque", "xia2019", str(path)], catch_exceptions=False)
    with pytest.raises(InputError, match=r"bandwidth 50.0 Hz \(--smoothing\) must lie between"):
        CliRunner().invoke(app, ["torque", "xia2019", str(path), "--smoothing", "50"], catch_exceptions=False)


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


@pytest.mark.parametrize("lock", ["joint2", "joint2=", "=0.1", "joint2=0.1rad"])
def test_a_lock_without_joint_or_place_is_refused(lock: str) -> None:
    with pytest.raises(InputError, match=r"must be JOINT=PLACE, such as finger_joint=0.02, in rad \(m\)"):
        CliRunner().invoke(app, ["inspect", "xia2019", "--lock", lock], catch_exceptions=False)


@pytest.mark.parametrize("command", [own.name or own.callback.__name__ for own in app.registered_commands])
def test_paragraphs_of_help_fill_their_lines(command: str):
    """Whatever the line breaks of the docstring."""
    words = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "80"}).output
    text = words.split("╭")[0].splitlines()
    for line, following in itertools.pairwise(text):
        if line.strip() and following.strip():
            first = following.split()[0]
            assert len(f"{line.rstrip()} {first}") >= 79, line

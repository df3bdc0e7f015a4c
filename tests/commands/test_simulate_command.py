"""`cutpoint simulate`, its laws by name, and `cutpoint plot` of its logs."""

import re
from pathlib import Path
from typing import Any, get_args
from unittest.mock import Mock

import numpy as np
import pytest
from command_runs import ONE_JOINT, one_joint, printed
from typer.testing import CliRunner

import cutpoint
from cutpoint import InputError, Log, control, robots
from cutpoint.commands import app, laws, shared
from cutpoint.control.laws.feedforward import RUNGS
from cutpoint.control.tuning import recipes
from cutpoint.simulation import runner
from cutpoint.simulation.log import plot as log_plot


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
    robot, _, drives = one_joint(tmp_path)
    run = cutpoint.simulate(cutpoint.load(robot, drives), None, None, 0.01)
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


def test_a_simulated_law_may_have_a_guard(tmp_path: Path) -> None:
    """Joints turn at 2 rad/s at most: a move that takes 5 is a fault."""
    drives, log = tmp_path / "slow.yaml", tmp_path / "run.npz"
    whole = robots.XIA2019_DRIVES.read_text("utf-8")
    drives.write_text(whole.replace("  ratio: 100\n", "  ratio: 100\n  limits: {velocity: 2.0}\n", 1), "utf-8")
    move = ["--to", "2,0,0,0,0,0", "--duration", "0.8", "--law", "PD", "--guard"]
    said = printed("simulate", str(robots.XIA2019_URDF), "--drives", str(drives), *move, "--output", str(log))
    run = Log.load(log)
    assert control.Fault.SPEED in run["fault"]
    assert f"note: the guard found a fault, speed of joint1, at {run.time[run['fault'] > 0][0]:.4g} s" in said
    far = tmp_path / "far.urdf"
    far.write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    said = printed("simulate", str(far), "--to", "1.2", "--duration", "2.0", "--law", "PD", "--guard")
    assert "note: the guard found a fault, position of swing, at " in said


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
    slightly = printed("torque", "arm.urdf", "--q", "1.0001", "--v", "3.00002")
    assert "note: swing goes to 57.302 deg, beyond its limits, -57.296 to 57.296 deg" in slightly
    assert "note: swing moves at up to 171.888 deg/s, above its limit of 171.887 deg/s" in slightly
    calm = printed("simulate", "arm.urdf", "--to", "0.5", "--duration", "1.0")
    wild = printed("simulate", "arm.urdf", "--to", "1.2", "--duration", "0.25")
    assert "note:" not in calm
    assert re.search(r"note: swing goes to [\d.]+ deg, beyond its limits", wild)
    assert re.search(r"note: swing moves at up to [\d.]+ deg/s, above its limit of 171.9 deg/s", wild)
    assert re.search(r"note: swing is asked for more than its limit of 10 N m in \d+\.\d% of the samples", wild)


def test_a_limit_of_voltage_is_said_beside_one_of_torque_that_was_never_met(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ONE_JOINT.format(joint="swing"), encoding="utf-8")
    motor = "{torque_constant: 0.1, resistance: 1.0, voltage_limit: 1.5}"
    drive = f"{{ratio: 10, rotor: {{inertia: 1.0e-4}}, motor: {motor}}}"
    Path("drives.yaml").write_text(f"version: 1\ndrives: {{swing: {drive}}}\n", encoding="utf-8")
    move = ["--to", "0.5", "--duration", "0.5", "--output", "run.npz"]
    said = printed("simulate", "arm.urdf", "--drives", "drives.yaml", *move)
    assert Log.load("run.npz").max("command_torque") < 10.0
    words = r"note: swing is asked for more than its limit of 10 N m or its voltage allows in \d+\.\d% of the samples"
    assert re.search(words, said)


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

"""`cutpoint export`: functions and laws leave as C, with options that fit them."""

import re
from pathlib import Path
from typing import Any

import pytest
from command_runs import printed
from typer.testing import CliRunner

from cutpoint import InputError, control, robots
from cutpoint.commands import app
from cutpoint.export import export_controller, export_function


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


@pytest.mark.parametrize(("to", "ending", "language"), [("c", "c", "C"), ("cuda", "cu", "CUDA C")])
def test_the_size_of_the_code_is_told(to: str, ending: str, language: str, tmp_path: Path) -> None:
    said = printed("export", "xia2019", str(tmp_path), "--function", "gravity_forces", "--to", to)
    size = (tmp_path / f"gravity_forces.{ending}").stat().st_size
    assert said.endswith(f"size: {size // 1000 + 1} kB of {language}\n")


def test_a_function_leaves_as_c_with_its_options(tmp_path: Path) -> None:
    function, arm = "elastic_inverse_dynamics", robots.xia2019()
    printed("export", "xia2019", str(tmp_path / "found"), "--function", function, "--quasi-rigid", "--friction-rates")
    export_function(arm, function, tmp_path / "expected", quasi_rigid=True, friction_rates=True)
    for path in (tmp_path / "expected").iterdir():
        assert (tmp_path / "found" / path.name).read_bytes() == path.read_bytes()


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

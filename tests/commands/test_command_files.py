"""Files that commands write: where they may go, and what is left when one cannot be written."""

import errno
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_runs import ELASTIC, ONE_JOINT, one_joint, printed, refuse, saved
from matplotlib.figure import Figure
from typer.testing import CliRunner

from cutpoint import InputError, Log, robots
from cutpoint.commands import app

BAD_PLACES = {
    "a folder that is not there": ("none/run.npz", r"'none/run.npz': folder 'none' does not exist; create it"),
    "a folder": ("folder.npz", r"'folder.npz' is a folder; name a file in it"),
    "a file as a folder": ("file/run.npz", r"'file/run.npz': folder 'file' does not exist"),
}


def test_the_path_of_a_file_stands_in_one_line_however_long_it_is(tmp_path: Path) -> None:
    folder = tmp_path / ("a_rather_long_name_of_a_folder" * 5)
    folder.mkdir()
    arm = one_joint(tmp_path)
    for word, command in (
        ("log", ("simulate", *arm, "--to", "0", "--duration", "0.01", "--output", "x.npz")),
        ("picture", ("modes", *arm, "--plot", "x.png")),
        ("numbers", ("check", *arm, "--to", "0.1", "--duration", "1", "--json", "x.json")),
        ("picture", ("drive", "CSG-20-100", "--plot", "x.png")),
    ):
        path = str(folder / command[-1])
        assert f"{word} saved: {path}\n" in printed(*command[:-1], path)


def test_modes_are_saved_by_frequency(tmp_path: Path) -> None:
    found = saved(tmp_path, "modes", "xia2019", "--q", "0,30,60,0,45,0", "--degrees")
    modes = robots.xia2019().modes(np.radians([0, 30, 60, 0, 45, 0]))
    assert [mode["frequency"] for mode in found["modes"]] == modes.frequencies.tolist()
    assert [mode["damping_ratio"] for mode in found["modes"]] == modes.damping.tolist()
    assert [mode["drives"] for mode in found["modes"]] == [modes.joints_of(k) for k in range(len(modes.frequencies))]
    assert (found["robot"], found["friction"], found["remark"]) == (robots.xia2019().name, False, None)


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

"""`cutpoint modes`: its table and its picture."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from typer.testing import CliRunner

from cutpoint import robots
from cutpoint.commands import app
from robot_library import urdf

POSE = ["--q", "0,30,60,0,45,0", "--degrees"]


def printed(*arguments: str) -> str:
    result = CliRunner().invoke(app, ["modes", *arguments])
    assert result.exit_code == 0, result.output
    return result.output


@pytest.mark.parametrize("options", [[], ["--friction"]])
def test_the_table_has_every_mode_and_the_picture_is_saved(tmp_path: Path, options: list[str]):
    target = tmp_path / "modes.png"
    text = printed("xia2019", *POSE, *options, "--plot", str(target))
    found = robots.xia2019().modes(np.radians([0, 30, 60, 0, 45, 0]), friction=bool(options))
    for f, zeta in zip(found.frequencies, found.damping, strict=True):
        assert f"{f:.2f}" in text and f"{zeta:z.4f}" in text
    assert ("without friction" in text) != bool(options)
    image = imread(target)
    assert image.shape[0] > 400 and image.shape[1] > 800
    assert image[..., :3].std() > 0.05  # something is drawn


def test_a_robot_file_needs_no_more_than_its_drives():
    text = printed(str(robots.XIA2019_URDF), "--drives", str(robots.XIA2019_DRIVES), *POSE)
    assert text == printed("xia2019", *POSE)


def test_a_rigid_robot_is_told_to_have_no_drive_modes():
    assert "no drive bends" in " ".join(printed(str(urdf("ur10_robot.urdf"))).split())

"""`cutpoint drive`: the catalogue, a drive's sheet beside its laws, its entry to paste, its picture."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from scipy.integrate import trapezoid
from typer.testing import CliRunner

from cutpoint.commands import app
from cutpoint.errors import CutpointError
from cutpoint.formats import catalogue_drive, catalogue_gear, catalogue_names, parse_drives
from cutpoint.studies.drive.loop import cycle
from cutpoint.studies.drive.measured import Specimen
from robot_library import robot

KINDS = ("CSG-20-100", "CSF-14-30", "CSF-32-160", "SHG-17-80", "CSD-20-50", "CSD-20-100", "RT1-H-CS-20-100")
ACTUATORS = ("FHA-17C-100", "TREE-Orange-100")


def printed(*arguments: str) -> str:
    result = CliRunner().invoke(app, ["drive", *arguments])
    assert result.exit_code == 0, result.output
    return result.output


def cells(text: str) -> set[tuple[str, ...]]:
    return {tuple(cell.strip() for cell in line.split("│")[1:-1]) for line in text.splitlines()}


def test_without_a_name_every_series_is_listed() -> None:
    listed = {row[0] for row in cells(printed()) if row}
    assert listed == {catalogue_gear(name).series for name in catalogue_names()}


def test_a_sheet_has_its_numbers_with_unit_source_and_worth() -> None:
    found = cells(printed("CSG-20-100"))
    assert ("stiffness", "torque T1", "7", "N m", "cha", "verified") in found
    assert ("inertia", "inertia of the wave generator", "1.93e-05", "kg m2", "selector", "not verified") in found
    assert ("friction", "friction as of", "RT1-H-CS-20-100", "", "like_rt1", "estimate") in found
    assert ("hysteresis loss", "1", "1", "arcmin", "to 52 N m") in found
    assert ("efficiency, 2000 rpm, 52 N m", "0.770", "", "", "estimate") in found


@pytest.mark.parametrize("name", [*KINDS, *ACTUATORS])
def test_every_kind_of_drive_prints_and_names_its_sources(name: str) -> None:
    text = printed(name)
    for group in catalogue_gear(name).groups.values():
        assert f"{group.source.key}: " in text
    estimated = bool(Specimen(name).friction.estimated)
    assert ("friction is an estimate" in text) == estimated
    assert ("friction is an estimate" in printed(name, "--yaml")) == estimated


@pytest.mark.parametrize("name", [*KINDS, *ACTUATORS])
def test_a_pasted_entry_is_the_catalogues_drive(name: str) -> None:
    text = "version: 1\ndrives:\n" + printed(name, "--yaml").replace("JOINT:", "joint1:")
    assert parse_drives(text, robot("xia2019").mechanism) == {"joint1": catalogue_drive(name)}


@pytest.mark.parametrize("name", [*KINDS, *ACTUATORS])
def test_a_picture_is_saved_with_ink_in_it(name: str, tmp_path: Path) -> None:
    path = tmp_path / "drive.png"
    assert "picture saved" in printed(name, "--plot", str(path))
    assert np.ptp(imread(path)[..., :3]) > 0.5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["CSG-20-101", "--plot", "drive.png"], r"no 'CSG-20-101'; did you mean .*'CSG-20-100'"),
        (["gearbox"], r"no 'gearbox'; there are: .*\(\d+ in all\)"),
        (["CSG-20-100", "--plot", "drive.bmp"], r"must end in \.png"),
        (["--plot", "drive.png"], r"need the NAME of a drive"),
        (["--yaml"], r"need the NAME of a drive"),
    ],
)
def test_what_cannot_be_shown_is_said_and_leaves_no_file(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CutpointError, match=message):
        CliRunner().invoke(app, ["drive", *arguments], catch_exceptions=False)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["CSG-20-100", "CSF-14-30", "TREE-Orange-100"])
def test_a_loop_closes_loses_energy_and_is_the_same_turned_over(name: str) -> None:
    drive = catalogue_drive(name)
    for peak in (1e-6, 0.5, 40.0):
        (x_up, up), (x_down, down) = cycle(drive, peak, points=2001)[:2]
        np.testing.assert_allclose([up[0], up[-1], down[0], down[-1]], [-peak, peak, peak, -peak], rtol=1e-6)
        np.testing.assert_allclose(x_down, -x_up, rtol=0, atol=1e-9 * x_up[-1])
        np.testing.assert_allclose(down, -up, rtol=0, atol=1e-6 * peak)
        lost = trapezoid(up, x_up) + trapezoid(down, x_down)
        assert lost >= -1e-9 * peak * x_up[-1]
        if peak > 1.0:
            assert lost > 0.01 * peak * x_up[-1]


def test_without_hysteresis_a_loop_is_its_spring() -> None:
    drive = catalogue_drive("CSD-20-100")
    assert drive.compliance is not None
    (x_up, up), _, width, span = cycle(drive, 28.0)
    assert width < 1e-12
    assert span == pytest.approx(2 * float(drive.compliance.deflection(28.0)), rel=1e-9)
    np.testing.assert_allclose(up, drive.compliance.torque(x_up), rtol=1e-12)

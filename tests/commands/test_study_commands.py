"""Commands of studies, and their reports' folders."""

from pathlib import Path
from unittest.mock import Mock

import pytest
from typer.testing import CliRunner

from cutpoint import InputError, robots
from cutpoint.commands import app
from cutpoint.reporting.folder import write
from cutpoint.reporting.html import Heading


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
    assert (result.exit_code, result.stderr) == (130, f"interrupted; {told.format(tmp_path)}\n")
    assert (tmp_path / "report" / "index.html").exists() == ("go to" in told)


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

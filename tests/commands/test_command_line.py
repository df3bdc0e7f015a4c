"""The command line on all kinds of terminals: names, words, help, Ctrl-C."""

import itertools
import os
import re
import shlex
import subprocess
import sys
from io import StringIO
from pathlib import Path

import pytest
from command_runs import OF_COMMANDS, ONE_JOINT, one_joint, printed
from rich.console import Console
from rich.table import Column, Table
from typer.testing import CliRunner

from cutpoint import Log
from cutpoint.commands import app, shared
from cutpoint.reporting.fitting import print_table
from robot_library import urdf


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


@pytest.mark.parametrize("name", OF_COMMANDS)
def test_the_example_of_a_command_has_options_that_it_takes(name: str) -> None:
    command = OF_COMMANDS[name]
    _, program, own, *arguments = shlex.split(command.epilog)
    assert (program, own) == ("cutpoint", name)
    command.make_context(name, arguments)


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


@pytest.mark.parametrize("arguments", [TORQUE, ("-m", "cutpoint", "--help"), ("-m", "cutpoint", "inspect", "none")])
def test_a_reader_that_has_gone_ends_a_command_without_a_word(arguments: tuple[str, ...]) -> None:
    unread, output = os.pipe()
    os.close(unread)
    stderr = output if "none" in arguments else subprocess.PIPE
    done = subprocess.run([sys.executable, *arguments], stdout=output, stderr=stderr, check=False)
    os.close(output)
    # as a shell tells of a program that SIGPIPE has ended
    assert (done.returncode, done.stderr or b"") == (141, b"")


def test_a_long_error_in_a_file_is_one_line(tmp_path: Path) -> None:
    file = str(tmp_path / f"{'a' * 100}.urdf")
    command = [sys.executable, "-m", "cutpoint", "inspect", file]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, f"error: file '{file}' does not exist\n")


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


def test_the_commands_run_as_a_module_and_refuse_unknown_ones() -> None:
    command = [sys.executable, "-m", "cutpoint", "nonsense"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "No such command 'nonsense'" in done.stderr


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
        ("check", "xia2019", "--to", "0.01,0,0,0,0,0", "--duration", "0.5"),
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
    """Words are whole as long as there is room for them: where that is not in columns, rows become lists."""
    rows = [("left_shoulder", "0.25 to 0.75 rad", "stribeck, with load"), ("elbow", "-1.5 to 1 rad", "coulomb")]
    columns = (Column(header, overflow="fold") for header in ("joint", "range between limits", "friction"))
    table, written = Table(*columns, title="joints"), StringIO()
    for row in rows:
        table.add_row(*row)
    print_table(table, Console(width=width, file=written))
    shown, text = written.getvalue(), " ".join(itertools.chain(*rows))
    assert max(map(len, shown.splitlines())) <= width
    assert (set(text.split()) <= set(shown.split())) == (width > len("left_shoulder"))
    assert ("range between limits: 0.25" in shown) == (width == 32)
    assert all(shown.count(digit) == text.count(digit) for digit in "012457")


@pytest.mark.parametrize("width", [80, 40, 20])
def test_a_line_that_is_kept_whole_is_broken_and_not_cut_where_it_does_not_fit(width: int) -> None:
    table, written = Table(Column("drive", no_wrap=True), Column("peak"), Column("verdict", no_wrap=True)), StringIO()
    for column in table.columns:
        column.overflow = "fold"
    table.add_row("left_shoulder_pitch_and_roll_joint_01234567", "89 of 89", "holds")
    print_table(table, Console(width=width, file=written))
    assert [written.getvalue().count(digit) for digit in "0123456789"] == 8 * [1] + 2 * [2]


def test_a_picture_of_lines_has_no_date_and_is_the_same_each_time(tmp_path: Path) -> None:
    arm = one_joint(tmp_path)
    for kind in ("svg", "pdf"):
        first, second = (tmp_path / f"{name}.{kind}" for name in ("first", "second"))
        for path in (first, second):
            printed("simulate", *arm, "--to", "0.01", "--duration", "0.5", "--plot", str(path))
        assert first.read_bytes() == second.read_bytes()
        assert not re.search(rb"CreationDate|dc:date", first.read_bytes())


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


@pytest.mark.parametrize("command", [own.name or own.callback.__name__ for own in app.registered_commands])
def test_paragraphs_of_help_fill_their_lines(command: str):
    """Whatever the line breaks of the docstring."""
    words = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "80"}).output
    text = words.split("╭")[0].splitlines()
    for line, following in itertools.pairwise(text):
        if line.strip() and following.strip():
            first = following.split()[0]
            assert len(f"{line.rstrip()} {first}") >= 79, line

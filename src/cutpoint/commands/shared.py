"""Shared by commands: the application, common options, and file handling."""

import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import typer
from rich.console import Console
from typer.core import TyperGroup

import cutpoint
from cutpoint.door import positive
from cutpoint.errors import INTERRUPTED, InputError, counted
from cutpoint.files import check_target_file, save_figure
from cutpoint.joint_units import are_prismatic
from cutpoint.model.limits import looks_like_degrees

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cutpoint.simulation import Log


UsageError: Any = typer.BadParameter.__base__
"""Typer's own class or Click's, which one depends on Typer's version."""


class Commands(TyperGroup):
    """All commands; Ctrl-C ends one with a line that says so, and what its KeyboardInterrupt knows of files."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except UsageError as refused:
            self._name_values(refused)
            raise
        except KeyboardInterrupt as stopped:
            typer.echo("; ".join(["interrupted", *map(str, stopped.args)]), err=True)
            raise typer.Exit(INTERRUPTED) from stopped

    def _name_values(self, refused: Any) -> None:
        """Adds to an error on an option of several values which they are: Typer tells how many."""
        options = [x for command in self.commands.values() for x in command.params if x.nargs > 1]
        named = getattr(refused, "option_name", None)
        for option in options:
            if named in option.opts or getattr(refused, "param", None) is option:
                refused.message = f"{refused.message.rstrip('.')}: give {option.metavar}"
                return


app = typer.Typer(
    cls=Commands,
    help="Dynamics, simulation and control of robots with flexible joints.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)


def _say_version(asked: bool) -> None:
    if asked:
        typer.echo(f"cutpoint {cutpoint.__version__}")
        raise typer.Exit


@app.callback()
def _of_all_commands(
    version: Annotated[
        bool, typer.Option("--version", metavar="", callback=_say_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Options before a command's name."""


def above_zero(context: typer.Context, option: typer.CallbackParam, value: float | None) -> float | None:
    """The value of an option that must be positive.  Raises InputError, which names the option."""
    return None if value is None else positive(context.info_name or "cutpoint", option.opts[0], value)


# names of robots and files are printed verbatim: brackets and colons in them are not markup
_wide = sys.stdout is None or not sys.stdout.isatty()
console = Console(width=120 if _wide else None, markup=False, emoji=False)

# metavar: otherwise an option without a value would be shown with one
Degrees = Annotated[
    bool,
    typer.Option("--degrees", metavar="", help="Angles, also those of --lock, and their rates are given in degrees."),
]
Smoothing = Annotated[
    float | None,
    typer.Option(
        "--smoothing",
        callback=above_zero,
        help="Bandwidth to smooth a file's positions to, Hz; default 10, or what samples allow.",
    ),
]
Duration = Annotated[
    float | None,
    typer.Option("--duration", callback=above_zero, help="Duration, s: of the cycloid, or to run a file's motion in."),
]
Json = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Save the numbers by joint or mode, in SI units: .json.")
]
RungOption = Literal["none", "gravity", "rigid", "rotor", "friction", "elastic"]


OF_A_RUN = ("q", "position_error", "motor_torque")
"""The most informative channels of a run."""

PICTURE = (".png", ".pdf", ".svg")
"""Endings of pictures."""


def numbers_of(robot: cutpoint.Robot, option: str, text: str, degrees: bool) -> Any:
    """One number per joint, in SI units.  Raises InputError for a robot with joints of several coordinates."""
    for body in robot.mechanism.bodies:
        if body.joint.kind in ("floating", "spherical", "planar"):
            found = f"joint {body.joint.name!r} is {body.joint.kind}"
            rule = "this option takes one number per joint; use Python for this robot"
            raise InputError(f"--{option}: {found}, and {rule}", joint=body.joint.name)
    numbers = _listed(option, text, len(robot.joints))
    if not degrees:
        return numbers
    return np.where(are_prismatic(robot), numbers, np.radians(numbers))


def positions_of(robot: cutpoint.Robot, option: str, text: str, degrees: bool) -> Any:
    """The same for positions.  Raises InputError for angles that look like degrees, without --degrees."""
    numbers = numbers_of(robot, option, text, degrees)
    for name, x in zip(robot.joints, numbers.tolist(), strict=True):
        if not degrees and looks_like_degrees(robot.mechanism, name, x):
            told = f"joint {name!r}: position {x} looks like degrees; add --degrees (give many turns in degrees, too)"
            raise InputError(f"--{option}: {told}", joint=name)
    return numbers


def motion_of(
    robot: cutpoint.Robot,
    file: Path | None,
    smoothing: float | None,
    ends: tuple[str, str],
    duration: float | None,
    degrees: bool,
) -> "cutpoint.trajectories.Trajectory":
    """The motion of a file, or a cycloid between two ends; in the duration that is asked for."""
    start, end = ends
    if file is not None:
        if start or end or degrees:
            rule = "leave out --to, --from and --degrees; its first line names the units, and --lock is in rad"
            raise InputError(f"trajectory {str(file)!r} is already a motion: {rule}", path=file)
        sliding = robot.mechanism.sliding
        smoothed = cutpoint.trajectories.from_csv(file, robot.joints, bandwidth=smoothing, sliding=sliding)
        console.print(str(smoothed), soft_wrap=True, highlight=False)
        return smoothed if duration is None else cutpoint.trajectories.retimed(smoothed, duration)
    if smoothing is not None:
        raise InputError("--smoothing applies only to the positions of a CSV file TRAJECTORY: leave it out")
    if not end or duration is None:
        raise InputError("a motion is needed: give a CSV file TRAJECTORY, or --to with --duration")
    goal = positions_of(robot, "to", end, degrees)
    return cutpoint.trajectories.cycloid(goal, duration, start=positions_of(robot, "from", start, degrees))


def _listed(option: str, text: str, count: int) -> Any:
    """Numbers separated by commas; none at all are zeros."""
    if not text.strip():
        return np.zeros(count)
    try:
        if "_" in text:
            raise ValueError
        numbers = np.array([float(x) for x in text.split(",")])
    except ValueError:
        raise InputError(f"--{option} {text!r} must be numbers separated by commas, such as 0,0.5,-1.2") from None
    if len(numbers) != count:
        found = f"--{option} has {counted(len(numbers), 'number')}"
        raise InputError(f"{found}, but the robot has {counted(count, 'joint')}: give one for each")
    if not np.isfinite(numbers).all():
        k = int((~np.isfinite(numbers)).argmax())
        raise InputError(f"--{option}: number {k + 1} of {count} is {numbers[k]}; all must be finite")
    return numbers


def check_targets(*, output: Path | None = None, plot: Path | None = None, json: Path | None = None) -> None:
    """Checks before any computation that files can be written and have known types.  output: a log."""
    check_target("output", output, (".npz", ".csv"))
    check_target("plot", plot, PICTURE)
    check_target("json", json, (".json",))


def check_target(option: str, path: Path | None, kinds: tuple[str, ...]) -> None:
    if path is None:
        return
    if path.suffix.lower() not in kinds:
        raise InputError(f"--{option} {str(path)!r} must end in {', '.join(kinds)}", path=path)
    check_target_file(path, f"--{option}")


def check_apart(option: str, target: Path, given: Iterable[Any]) -> None:
    """Raises InputError for a file to write that is one of those to read.  given: arguments, paths among them."""
    for path in given:
        if isinstance(path, Path) and path.is_file() and target.exists() and target.samefile(path):
            told = f"{option} {str(target)!r} is the same file as the input {str(path)!r}"
            raise InputError(f"{told}, which would be lost: name another file", path=target)


def say_notes(notes: Iterable[str]) -> None:
    """Prints notes on a result, a line each."""
    for words in notes:
        console.print(f"note: {words}", highlight=False)


def say_path(word: str, path: Path, to: Console = console) -> None:
    """Prints a path on one line, however long it is: people and programs copy it."""
    to.print(f"{word}: {path}", soft_wrap=True, highlight=False)


def keep(log: "Log", output: Path | None, plot: Path | None) -> None:
    """Saves everything before printing, which may fail at a closed pipe."""
    if output:
        log.save(output)
    if plot:
        shown = {name: values for name, values in log.channels.items() if name in OF_A_RUN}
        save_figure(replace(log, channels=shown).plot(), plot)
    if output:
        say_path("log saved", output)
    if plot:
        say_path("picture saved", plot)


def keep_picture(figure: "Figure", plot: Path) -> None:
    save_figure(figure, plot)
    say_path("picture saved", plot)

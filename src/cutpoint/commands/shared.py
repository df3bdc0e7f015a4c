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
from cutpoint.errors import INTERRUPTED, InputError, counted
from cutpoint.files import check_target_file, save_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cutpoint.simulation import Log


class Commands(TyperGroup):
    """All commands; Ctrl-C ends one with a line that says so, and what its KeyboardInterrupt knows of files."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stopped:
            typer.echo("; ".join(["interrupted", *map(str, stopped.args)]), err=True)
            raise typer.Exit(INTERRUPTED) from stopped


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


# names of robots and files are printed verbatim: brackets and colons in them are not markup
_wide = sys.stdout is None or not sys.stdout.isatty()
console = Console(width=120 if _wide else None, markup=False, emoji=False)

RobotFile = Annotated[
    Path, typer.Argument(metavar="ROBOT", help="URDF, xacro or MJCF file, or xia2019, the paper's arm.")
]
Drives = Annotated[Path | None, typer.Option(metavar="FILE", help="Drive file (YAML): see docs/drive-file.md.")]
Mimics = Annotated[
    Literal["independent", "coupled"],
    typer.Option("--mimic", help="Mimic joints as independent coordinates, or tied to their leader."),
]
Locks = Annotated[
    list[str] | None,
    typer.Option(
        "--lock", metavar="JOINT=PLACE", help="Hold a joint fixed at a position, rad (m); repeat for more joints."
    ),
]
Gravity = Annotated[
    tuple[float, float, float] | None,
    typer.Option(metavar="X Y Z", help="Gravity in the world's frame, m/s2; default: 0 0 -9.81, or an MJCF file's."),
]
# metavar: otherwise an option without a value would be shown with one
Degrees = Annotated[bool, typer.Option("--degrees", metavar="", help="Angles and their rates are given in degrees.")]
FloatingBase = Annotated[
    bool, typer.Option("--floating-base", metavar="", help="Carry the root link of a URDF on a free joint.")
]
MendInertia = Annotated[
    bool,
    typer.Option(
        "--mend-inertia", metavar="", help="Enlarge physically impossible inertias of a URDF by what they lack."
    ),
]
Xacro = Annotated[
    list[str] | None,
    typer.Option("--xacro", metavar="NAME:=VALUE", help="Argument of a .xacro file; repeat for more arguments."),
]
Smoothing = Annotated[
    float | None,
    typer.Option(
        "--smoothing", help="Bandwidth to smooth a file's positions to, Hz; default 10, or what samples allow."
    ),
]
Rung = Literal["none", "gravity", "rigid", "rotor", "friction", "elastic"]


OF_A_RUN = ("q", "position_error", "motor_torque")
"""The most informative channels of a run."""


def robot_of(
    path: Path,
    drives: Path | None,
    mimic: Literal["independent", "coupled"] = "independent",
    lock: list[str] | None = None,
    gravity: tuple[float, float, float] | None = None,
    mend_inertia: bool = False,
    xacro: list[str] | None = None,
    *,
    floating_base: bool = False,
) -> cutpoint.Robot:
    """The robot of a file, or one that comes with the package."""
    if not path.suffix and str(path) != "xia2019" and not path.exists():
        told = f"there is no file {str(path)!r}, and the only arm that comes with cutpoint is xia2019"
        raise InputError(told, path=path)
    if str(path) == "xia2019":
        path, drives = cutpoint.robots.XIA2019_URDF, drives or cutpoint.robots.XIA2019_DRIVES
    options: dict[str, Any] = {
        "mimic": mimic,
        "lock": _places_of(lock or []),
        "gravity": gravity,
        "mend_inertia": mend_inertia,
        "xacro": arguments_of(xacro),
    }
    return cutpoint.load(path, drives, floating_base=floating_base, **options)


def _places_of(locks: list[str]) -> dict[str, float]:
    """Where joints are locked.  Raises InputError."""
    places: dict[str, float] = {}
    for lock in locks:
        joint, _, place = lock.rpartition("=")
        if joint in places:
            raise InputError(f"--lock {lock!r}: {joint!r} is already locked at {places[joint]:g}; give one position")
        try:
            places[joint] = float(place)
        except ValueError:
            joint = ""
        if not joint:
            raise InputError(f"--lock {lock!r} must be JOINT=PLACE, such as finger_joint=0.02, in rad (m)", lock=lock)
    return places


def arguments_of(given: list[str] | None) -> dict[str, str]:
    """Arguments of a .xacro file.  Raises InputError."""
    arguments: dict[str, str] = {}
    for argument in given or []:
        name, colon, value = argument.partition(":=")
        if not name or not colon:
            raise InputError(f"--xacro {argument!r} must be NAME:=VALUE, such as ur_type:=ur10e", argument=argument)
        arguments[name] = value
    return arguments


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
    sliding = robot.mechanism.sliding
    return np.where([name in sliding for name in robot.joints], numbers, np.radians(numbers))


def motion_of(
    robot: cutpoint.Robot,
    file: Path | None,
    smoothing: float | None,
    ends: tuple[str, str],
    duration: float | None,
    degrees: bool,
) -> "cutpoint.trajectories.Trajectory":
    """The motion of a file, or a cycloid between two ends."""
    start, end = ends
    if file is not None:
        if start or end or duration is not None or degrees:
            rule = "leave out --to, --from, --duration and --degrees; its first line names the units"
            raise InputError(f"trajectory {str(file)!r} is already a motion: {rule}", path=file)
        sliding = robot.mechanism.sliding
        smoothed = cutpoint.trajectories.from_csv(file, robot.joints, bandwidth=smoothing, sliding=sliding)
        console.print(str(smoothed), soft_wrap=True, highlight=False)
        return smoothed
    if smoothing is not None:
        raise InputError("--smoothing applies only to the positions of a CSV file TRAJECTORY: leave it out")
    if not end or duration is None:
        raise InputError("a motion is needed: give a CSV file TRAJECTORY, or --to with --duration")
    places = {"start": numbers_of(robot, "from", start, degrees), "end": numbers_of(robot, "to", end, degrees)}
    return cutpoint.trajectories.cycloid(duration=duration, **places)


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


def check_targets(output: Path | None, plot: Path | None) -> None:
    """Checks before any computation that output files can be written and have known types."""
    check_target("output", output, (".npz", ".csv"))
    check_target("plot", plot, (".png", ".pdf", ".svg"))


def check_target(option: str, path: Path | None, kinds: tuple[str, ...]) -> None:
    if path is None:
        return
    if path.suffix.lower() not in kinds:
        raise InputError(f"--{option} {str(path)!r} must end in {', '.join(kinds)}", path=path)
    check_target_file(path, f"--{option}")


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

"""Commands on drives: sizing checks, and data of a catalogue drive."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cutpoint.commands.robot_file import RobotFile, takes_robot
from cutpoint.commands.shared import (
    Degrees,
    Duration,
    Smoothing,
    above_zero,
    app,
    check_targets,
    console,
    keep_picture,
    motion_of,
    say_path,
)
from cutpoint.errors import InputError
from cutpoint.reporting.fitting import print_table


@app.command(epilog="Example: cutpoint check arm.urdf cycle.csv --drives arm.drives.yaml --dwell 0.5 --plot check.png")
@takes_robot()
def check(
    robot: RobotFile,
    trajectory: Annotated[
        Path | None, typer.Argument(metavar="TRAJECTORY", help="CSV file of one cycle: time and joint positions.")
    ] = None,
    to: Annotated[str, typer.Option(help="Without a file: final positions of a cycloid, as in simulate.")] = "",
    duration: Duration = None,
    start: Annotated[str, typer.Option("--from", help="Initial positions of the cycloid; default zero.")] = "",
    degrees: Degrees = False,
    smoothing: Smoothing = None,
    dwell: Annotated[float, typer.Option(min=0.0, help="Pause at the last position after the motion, s.")] = 0.0,
    period: Annotated[float, typer.Option(callback=above_zero, help="Longest time between samples, s.")] = 1e-3,
    life: Annotated[float | None, typer.Option(callback=above_zero, help="Required life of the gears, hours.")] = None,
    shortest: Annotated[
        bool, typer.Option("--fastest", metavar="", help="In the shortest time in which every stated limit holds.")
    ] = False,
    json: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Save all numbers: .json.")] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save the torque-speed planes: .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Check whether the drives are large enough for a repeated motion, by what margin, and how long the gears last.

    Exit status: 0 if every stated limit holds, 3 if any margin is below 1, 1 on invalid input.
    """
    from cutpoint.studies.sizing import fastest, sizing
    from cutpoint.studies.sizing.table import sentences, table_of

    check_targets(plot=plot, json=json)
    loaded = robot.load(degrees=degrees)
    if shortest and trajectory is None:
        duration = duration or 1.0
    cycle = motion_of(loaded, trajectory, smoothing, (start, to), duration, degrees)
    found = (fastest if shortest else sizing)(loaded, cycle, dwell=dwell, period=period, life=life)
    if json:
        found.save(json)
        say_path("numbers saved", json)
    if plot:
        keep_picture(found.plot(), plot)
    print_table(table_of(found), console)
    for sentence in sentences(found):
        console.print(sentence, highlight=False)
    if shortest:
        console.print(f"{found.duration:.4g} s is the shortest time: in less a limit would be broken.", highlight=False)
    if not found.holds:
        raise typer.Exit(3)


@app.command(epilog="Example: cutpoint drive CSG-20-100 --plot drive.png")
def drive(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Name in the catalogue; without it, all drives are listed.")
    ] = None,
    as_yaml: Annotated[
        bool, typer.Option("--yaml", metavar="", help="Print only its drive-file entry, for pasting.")
    ] = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Save its curves: .png, .pdf or .svg.")] = None,
) -> None:
    """Show a drive of the catalogue: its data sheet, with sources, and what the laws reproduce."""
    from cutpoint.studies.drive import catalogue_table, entry_text, print_drive, save_picture

    if name is None:
        if as_yaml or plot:
            raise InputError("--yaml and --plot need the NAME of a drive; cutpoint drive lists them")
        return print_table(catalogue_table(), console)
    check_targets(plot=plot)
    if as_yaml:
        console.print(entry_text(name), soft_wrap=True, highlight=False, end="")
    else:
        print_drive(name, console)
    if plot:
        save_picture(name, plot)
        say_path("picture saved", plot, Console(stderr=True, markup=False, emoji=False) if as_yaml else console)

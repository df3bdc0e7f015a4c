"""Commands on a robot: structure, drives, simulation, modes."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import cutpoint
from cutpoint.commands.laws import BANDWIDTH, PERIOD, Bandwidth, Feed, Guarded, Law, Period, law_of
from cutpoint.commands.limits import limits_met
from cutpoint.commands.robot_file import FloatingBase, RobotFile, takes_robot
from cutpoint.commands.shared import (
    Degrees,
    Duration,
    Json,
    Smoothing,
    app,
    check_targets,
    console,
    keep,
    keep_picture,
    motion_of,
    positions_of,
    say_notes,
)
from cutpoint.commands.sheets import modes_sheet, robot_sheet, save_sheet
from cutpoint.commands.tables import drive_table, error_table, modes_table, robot_table
from cutpoint.errors import INTERRUPTED, InputError, SimulationError
from cutpoint.reporting.fitting import print_table

MANY_SAMPLES = 100_000
"""Of a log; how large a longer one would be is looked at before it is run."""

CHARACTERS = 25
"""Most bytes of a number in a .csv, with its comma."""


@app.command(epilog="Example: cutpoint inspect xia2019")
@takes_robot()
def inspect(
    robot: RobotFile,
    floating_base: FloatingBase = False,
    json: Json = None,
) -> None:
    """Show a robot's joints, bodies, limits and drives, and where virtual decomposition cuts it."""
    check_targets(json=json)
    loaded = robot.load(floating_base=floating_base)
    if json:
        save_sheet(robot_sheet(loaded), json)
    if not loaded.mechanism.bodies:
        console.print(f"{loaded.name} has no moving joint.", highlight=False)
    else:
        print_table(robot_table(loaded, console), console)
    if loaded.drives:
        print_table(drive_table(loaded), console)
    console.print(f"gravity: {', '.join(f'{x:g}' for x in loaded.gravity)} m/s2 in the world's frame", highlight=False)
    console.print(f"frames: {', '.join(map(repr, loaded.frames))}", highlight=False)


@app.command(
    epilog="Example: cutpoint simulate xia2019 --to 90,60,60,90,60,90 --degrees --duration 2 --law VDC --output run.npz"
)
@takes_robot()
def simulate(
    robot: RobotFile,
    trajectory: Annotated[
        Path | None, typer.Argument(metavar="TRAJECTORY", help="CSV file of a motion: time and joint positions.")
    ] = None,
    to: Annotated[
        str, typer.Option(help="Without a file: final positions of a cycloid, rad (m), in the order of inspect.")
    ] = "",
    duration: Duration = None,
    start: Annotated[str, typer.Option("--from", help="Initial positions of the cycloid; default zero.")] = "",
    degrees: Degrees = False,
    law: Law = "PD",
    bandwidth: Bandwidth = BANDWIDTH,
    feedforward: Feed = None,
    guard: Guarded = False,
    period: Period = PERIOD,
    smoothing: Smoothing = None,
    output: Annotated[Path | None, typer.Option(metavar="FILE", help="Save the log: .npz or .csv.")] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save a picture of the run: .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Simulate a robot under a control law, along a file's motion or a rest-to-rest cycloid; report the errors."""
    check_targets(output=output, plot=plot)
    loaded = robot.load(degrees=degrees)
    motion = motion_of(loaded, trajectory, smoothing, (start, to), duration, degrees)
    controller = law_of(loaded, law, bandwidth, feedforward, period, guard=guard)
    try:
        _check_log_fits(output, loaded, controller, motion, period)
        log = cutpoint.simulate(loaded, controller, motion, control_period=period)
    except SimulationError as error:
        if error.log is not None:
            keep(error.log, output, plot)
        if error.evidence["diverged"]:
            raise
        typer.echo(str(error), err=True)
        raise typer.Exit(INTERRUPTED) from error
    except KeyboardInterrupt:
        raise KeyboardInterrupt("there is no log to save yet") from None
    keep(log, output, plot)
    print_table(error_table(loaded, log), console)
    say_notes(limits_met(loaded, log))


@app.command(epilog="Example: cutpoint modes xia2019 --q 0,30,60,0,45,0 --degrees --plot modes.png")
@takes_robot()
def modes(
    robot: RobotFile,
    q: Annotated[str, typer.Option(help="Positions, rad (m), separated by commas; default zero.")] = "",
    degrees: Degrees = False,
    friction: Annotated[
        bool,
        typer.Option(
            "--friction", metavar="", help="Include friction's slope at rest, which damps or locks the modes."
        ),
    ] = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save the frequency responses: .png, .pdf or .svg.")
    ] = None,
    json: Json = None,
) -> None:
    """Resonance frequencies of the drives at rest, and frequency responses of motor and link to a motor's torque."""
    check_targets(plot=plot, json=json)
    loaded = robot.load(degrees=degrees)
    position = positions_of(loaded, "q", q, degrees)
    found = loaded.modes(position, friction=friction)
    if plot:
        keep_picture(found.plot(), plot)
    if json:
        save_sheet(modes_sheet(loaded, found), json)
    print_table(modes_table(loaded, found), console)


def _check_log_fits(
    output: Path | None, robot: cutpoint.Robot, controller: Any, trajectory: Any, period: float
) -> None:
    """Raises InputError for a run whose log would be larger than a file may be, before it is run."""
    from cutpoint.simulation.log.files import LARGEST_FILE

    samples = trajectory.duration / period
    if output is None or not MANY_SAMPLES < samples < np.inf:
        return
    few = cutpoint.simulate(robot, controller, trajectory, duration=period, control_period=period)
    numbers = samples * sum(x.size for x in few.channels.values()) / len(few.time)
    size = numbers * (8 if output.suffix.lower() == ".npz" else CHARACTERS)
    if size > LARGEST_FILE:
        remedy = "shorten --duration or lengthen --period, or simulate in Python with only the channels= you need"
        told = f"a log of {samples:,.0f} samples may take {size:.2g} bytes, but a file may hold only {LARGEST_FILE:.2g}"
        raise InputError(f"--output {str(output)!r}: {told}; {remedy}", path=output)

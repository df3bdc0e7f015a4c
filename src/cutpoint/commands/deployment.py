"""Code for other machines."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from cutpoint.commands.shared import (
    Drives,
    FloatingBase,
    Gravity,
    Locks,
    MendInertia,
    Mimics,
    RobotFile,
    app,
    robot_of,
    say_path,
)
from cutpoint.functions.exported import RESULTS
from cutpoint.mechanics.kinematics import ExpressedIn

HELP = f"""Write a robot's function as code for machines without Python: C99, with a check of its bits, or CUDA C.

Functions: {", ".join(RESULTS)}."""


@app.command(help=HELP, epilog="Example: cutpoint export xia2019 --function elastic_inverse_dynamics --to c deployed")
def export(
    robot: RobotFile,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder for the files; made if it is not there.")],
    function: Annotated[str, typer.Option(help="Which of those above: a method of Robot, or its derivatives.")],
    to: Annotated[
        Literal["c", "cuda"],
        typer.Option(help="What to write: c, a package of C99 with a header for C++17, or cuda, CUDA C."),
    ] = "c",
    precision: Annotated[
        Literal["float64", "float32"], typer.Option(help="Of every number: float32 for controllers that have no other.")
    ] = "float64",
    drives: Drives = None,
    mimic: Mimics = "independent",
    lock: Locks = None,
    gravity: Gravity = None,
    mend_inertia: MendInertia = False,
    floating_base: FloatingBase = False,
    frame: Annotated[str | None, typer.Option(help="For jacobian and frame_pose: of which frame.")] = None,
    expressed_in: Annotated[ExpressedIn | None, typer.Option(help="For jacobian: along which axes.")] = None,
    name: Annotated[str | None, typer.Option(help="Of the C function, the same if not given.")] = None,
    force: Annotated[
        bool, typer.Option("--force", metavar="", help="Overwrite files that cutpoint has not written.")
    ] = False,
) -> None:
    from cutpoint.export import export_function

    given = {"frame": frame, "expressed_in": expressed_in}
    options = {key: value for key, value in given.items() if value is not None}
    loaded = robot_of(robot, drives, mimic, lock, gravity, mend_inertia, floating_base=floating_base)
    for path in export_function(
        loaded, function, folder, to=to, precision=precision, name=name, force=force, **options
    ):
        say_path(to, path)

"""Code for other machines."""

from math import ceil
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from cutpoint.commands.laws import BANDWIDTH, NAMES, PERIOD, Feed, Guarded, Name, by_name, law_of
from cutpoint.commands.robot_file import FloatingBase, RobotFile, takes_robot
from cutpoint.commands.shared import above_zero, app, console, say_path
from cutpoint.errors import InputError
from cutpoint.functions.facts import FACTS
from cutpoint.mechanics.kinematics import ExpressedIn

HELP = f"""Write a robot's function, or a control law's step, as code for machines without Python.

C99 comes with a bit-exact self-test; functions can also be exported as CUDA C.  Functions: {", ".join(FACTS)}."""


@app.command(help=HELP, epilog="Example: cutpoint export xia2019 --function elastic_inverse_dynamics --to c deployed")
@takes_robot()
def export(
    robot: RobotFile,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder for the files; created if missing.")],
    function: Annotated[
        str | None, typer.Option(help="One of the functions above: a method of Robot, or its derivatives.")
    ] = None,
    law: Annotated[
        Name | None,
        typer.Option(
            "--law",
            parser=by_name,
            metavar=NAMES,
            help="Export a law of cutpoint.control instead, with gains as in simulate.",
        ),
    ] = None,
    bandwidth: Annotated[
        float | None, typer.Option(callback=above_zero, help="Bandwidth of the law, Hz; default 5.")
    ] = None,
    feedforward: Feed = None,
    period: Annotated[
        float | None,
        typer.Option(
            "--period", "--control-period", callback=above_zero, help="Control period of the law, s; default 0.001."
        ),
    ] = None,
    guard: Guarded = False,
    to: Annotated[
        Literal["c", "cuda"],
        typer.Option(help="What to write: c, a C99 package with a C++17 header, or cuda, CUDA C."),
    ] = "c",
    precision: Annotated[
        Literal["float64", "float32"],
        typer.Option(help="Precision of numbers; float32 for controllers without double precision."),
    ] = "float64",
    floating_base: FloatingBase = False,
    frame: Annotated[
        str | None, typer.Option(help="Frame, for functions of one: jacobian, frame_pose, frame_acceleration.")
    ] = None,
    expressed_in: Annotated[
        ExpressedIn | None, typer.Option(help="Axes that a frame's velocity is expressed along.")
    ] = None,
    quasi_rigid: Annotated[
        bool,
        typer.Option(
            "--quasi-rigid", metavar="", help="Of elastic_inverse_dynamics: four derivatives do, for any rotors."
        ),
    ] = False,
    friction_rates: Annotated[
        bool,
        typer.Option("--friction-rates", metavar="", help="Of the same: the spring's motion includes friction's."),
    ] = False,
    name: Annotated[
        str | None, typer.Option(help="Name of the C function; default: that of --function, or control_step.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", metavar="", help="Overwrite files not written by cutpoint.")
    ] = False,
) -> None:
    from cutpoint.export import export_controller, export_function

    given = {"frame": frame, "expressed_in": expressed_in, "quasi_rigid": quasi_rigid, "friction_rates": friction_rates}
    options: dict[str, Any] = {key: value for key, value in given.items() if value not in (None, False)}
    _check_choice(
        function,
        law,
        {"--feedforward": feedforward, "--guard": guard or None, "--bandwidth": bandwidth, "--period": period},
        {**{f"--{key.replace('_', '-')}": x for key, x in options.items()}, "--to cuda": to if to == "cuda" else None},
    )
    loaded = robot.load(floating_base=floating_base)
    if law is not None:
        bandwidth = BANDWIDTH if bandwidth is None else bandwidth
        period = PERIOD if period is None else period
        step = law_of(loaded, law, bandwidth, feedforward, period, guard=guard)
        paths = export_controller(
            loaded, step, folder, control_period=period, precision=precision, name=name or "control_step", force=force
        )
    else:
        paths = export_function(
            loaded, function or "", folder, to=to, precision=precision, name=name, force=force, **options
        )
    for path in paths:
        say_path(to, path)
    console.print(f"size: {_size_told(paths[0])} of {'C' if to == 'c' else 'CUDA C'}", highlight=False)


def _size_told(path: Path) -> str:
    """How large a file is, which decides how long a compiler takes."""
    size = path.stat().st_size
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{ceil(size / 1e3)} kB"


def _check_choice(function: str | None, law: str | None, of_laws: dict[str, Any], of_functions: dict[str, Any]) -> None:
    """Raises InputError unless either a function or a law is named, with no option of the other."""
    if (function is None) == (law is None):
        told = "say what to export, by" if law is None else "leave out one of"
        raise InputError(f"export: {told} --function or --law")
    strange, kind = (of_laws, "law") if law is None else (of_functions, "function")
    for option in [key for key, value in strange.items() if value is not None]:
        raise InputError(f"export: {option} applies only to --{kind}: leave it out")

"""From logs of machines to models."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

import cutpoint
from cutpoint.commands.shared import (
    Drives,
    Gravity,
    Locks,
    MendInertia,
    Mimics,
    RobotFile,
    app,
    console,
    robot_of,
    say_notes,
    say_path,
)
from cutpoint.errors import InputError
from cutpoint.files import check_target_folder
from cutpoint.model.hand import hand_of

Corners = tuple[float, float, float, float, float, float]


@app.command(epilog="Example: cutpoint excite xia2019 --speed 2 --travel 0.9 --seconds 60 --output excited")
def excite(
    robot: RobotFile,
    drives: Drives = None,
    mimic: Mimics = "independent",
    lock: Locks = None,
    gravity: Gravity = None,
    mend_inertia: MendInertia = False,
    duration: Annotated[float, typer.Option(help="Of the motion, s: a whole number of its periods.")] = 10.0,
    harmonics: Annotated[int, typer.Option(help="Waves in each joint, multiples of the base frequency; least 3.")] = 5,
    base_frequency: Annotated[
        float | None, typer.Option(help="Hz; one period in the whole duration if not given.")
    ] = None,
    criterion: Annotated[
        Literal["determinant", "condition"], typer.Option(help="Largest det(W^T W) or smallest condition number of W.")
    ] = "determinant",
    travel: Annotated[
        float, typer.Option(help="Share of what position limits leave that is used: 0.9 keeps clear of stops.")
    ] = 1.0,
    speed: Annotated[
        float | None, typer.Option(help="Largest speed of every joint, rad/s (m/s): below what robot and drives state.")
    ] = None,
    acceleration: Annotated[float | None, typer.Option(help="Largest acceleration, rad/s2 (m/s2).")] = None,
    torque: Annotated[float | None, typer.Option(help="Largest torque of every motor at its joint, N m (N).")] = None,
    box: Annotated[
        Corners | None,
        typer.Option(metavar="X0 Y0 Z0 X1 Y1 Z1", help="Low and high corner, m, in the world; the tool stays between."),
    ] = None,
    frame: Annotated[
        str | None, typer.Option(help="What stays in the box; the tool's if not given, as in compare.")
    ] = None,
    seconds: Annotated[float, typer.Option(help="To search; Ctrl-C ends it earlier, with the best until then.")] = 30.0,
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for excitation.csv, .json (to go on from) and .png.")
    ] = Path("excitation"),
) -> None:
    """Find the motion along which torques tell most of a robot's inertias and friction, within its limits.

    Run it again with the same --output to search on from what was found.  Watch the motion in simulation before a
    machine follows it: bodies may touch, since nothing here knows their shapes.
    """
    from cutpoint.identification import excitation
    from cutpoint.identification.excitation.table import FILES, save, table_of

    loaded = robot_of(robot, drives, mimic, lock, gravity, mend_inertia)
    boxes = _boxes(loaded, box, frame)
    check_target_folder(output, "--output")
    found = excitation(
        loaded, duration, harmonics, base_frequency, criterion=criterion, travel=travel, speed=speed,
        acceleration=acceleration, torque=torque, boxes=boxes, seconds=seconds, resume=output / FILES[1],
    )  # fmt: skip
    saved = save(found, output)
    console.print(table_of(found))
    for path in saved:
        say_path("saved", path)


def _boxes(robot: cutpoint.Robot, box: Corners | None, frame: str | None) -> dict[str, Any]:
    """Of the frame that was named, or the tool's."""
    if box is None:
        if frame is not None:
            raise InputError(f"--frame {frame!r} says what stays in a box: give that too, --box X0 Y0 Z0 X1 Y1 Z1")
        return {}
    return {frame or hand_of(robot.mechanism): (box[:3], box[3:])}


@app.command(epilog="Example: cutpoint identify arm.urdf log.csv --drives arm.drives.yaml --mapping map.yaml")
def identify(
    robot: RobotFile,
    logs: Annotated[
        list[Path],
        typer.Argument(metavar="LOG", help="CSV, NPZ, MAT, Parquet, a ROS 2 bag, or a log of ours; one or several."),
    ],
    mapping: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Which channels of the logs are what (YAML); found by their names if not given."
        ),
    ] = None,
    drives: Drives = None,
    mimic: Mimics = "independent",
    lock: Locks = None,
    gravity: Gravity = None,
    mend_inertia: MendInertia = False,
    output: Annotated[
        Path,
        typer.Option(metavar="DIR", help="Folder for robot.urdf, robot.drives.yaml, parameters.json, report.html."),
    ] = Path("identified"),
    hold_out: Annotated[
        float, typer.Option(help="Share of the logs, at their end, that judges the model and is not fitted.")
    ] = 0.3,
    method: Annotated[
        Literal["ordinary", "weighted", "huber", "instrumental"],
        typer.Option(help="Least squares; huber bears outliers, instrumental noisy positions."),
    ] = "huber",
    solver: Annotated[
        Literal["lmi", "lmi_trace", "log_cholesky"],
        typer.Option(help="For bodies that can exist: lmi needs the extra 'identify', log_cholesky does not."),
    ] = "lmi",
    springs: Annotated[
        bool | None,
        typer.Option(
            "--springs/--no-springs", help="The drives' springs; if both encoders are in the log, by default."
        ),
    ] = None,
    rotors: Annotated[
        bool,
        typer.Option("--rotors/--no-rotors", help="The rotors' inertias; none where torques are the gears' output."),
    ] = True,
    friction: Annotated[
        Literal["choose", "stated"],
        typer.Option(help="Each joint's law of friction: that which predicts best, or the drive file's."),
    ] = "choose",
    cutoff: Annotated[
        float | None, typer.Option(help="Hz, of the positions; where they sink into their noise, by default.")
    ] = None,
    bandwidth: Annotated[
        float | None, typer.Option(help="Hz, of the torques that are explained; at most 10 Hz, by default.")
    ] = None,
    delay: Annotated[
        float,
        typer.Option("--delay", "--torque-delay", help="s by which torques act late: half a period for commands."),
    ] = 0.0,
    align: Annotated[
        bool, typer.Option("--align", metavar="", help="Bring the links' encoders to the motors' clock first.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", metavar="", help="Overwrite the files of an earlier run.")] = False,
) -> None:
    """Identify masses, inertias, friction and drives from logs, with intervals, and what the logs cannot tell.

    First let the machine follow a motion of cutpoint excite, and record positions, of motor and link if there are
    encoders on both, and torques or currents.  What the log has in degrees, counts or percent, or at the motor's shaft,
    a mapping file says: see docs/identification.md.
    """
    from cutpoint.identification.output import identify as identified
    from cutpoint.identification.output.saving import check_folder, file_notes
    from cutpoint.identification.output.terminal import sentences, table_of

    check_folder(output, force)
    loaded = robot_of(robot, drives, mimic, lock, gravity, mend_inertia)
    file = cutpoint.robots.XIA2019_URDF if str(robot) == "xia2019" else robot
    found = identified(
        loaded, logs, mapping, hold_out=hold_out, springs=springs, rotors=rotors, friction=friction, method=method,
        solver=solver, cutoff=cutoff, bandwidth=bandwidth, torque_delay=delay, align=align, source=file, progress=True,
    )  # fmt: skip
    saved = found.save(output, force=force)
    console.print(table_of(found))
    for sentence in sentences(found):
        console.print(sentence, highlight=False)
    say_notes(file_notes(found))
    for path in saved:
        say_path("saved", path)

"""From logs of machines to models."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

import cutpoint
from cutpoint.commands.robot_file import RobotFile, takes_robot
from cutpoint.commands.shared import above_zero, app, check_apart, console, say_notes, say_path
from cutpoint.errors import InputError
from cutpoint.files import check_target_folder
from cutpoint.model.tool import tool_frame_of
from cutpoint.reporting.fitting import print_table

Corners = tuple[float, float, float, float, float, float]


@app.command(epilog="Example: cutpoint excite xia2019 --speed 2 --travel 0.9 --seconds 60 --output excited")
@takes_robot()
def excite(
    robot: RobotFile,
    duration: Annotated[
        float, typer.Option(callback=above_zero, help="Duration of the motion, s: a whole number of its periods.")
    ] = 10.0,
    harmonics: Annotated[
        int, typer.Option(min=3, help="Harmonics of the base frequency in each joint; at least 3.")
    ] = 5,
    base_frequency: Annotated[
        float | None,
        typer.Option(callback=above_zero, help="Base frequency, Hz; default: one period in the whole duration."),
    ] = None,
    criterion: Annotated[
        Literal["determinant", "condition"],
        typer.Option(help="Maximise det(W^T W) or minimise the condition number of W."),
    ] = "determinant",
    travel: Annotated[
        float,
        typer.Option(
            callback=above_zero, help="Share of the range between position limits to use: 0.9 keeps clear of stops."
        ),
    ] = 1.0,
    speed: Annotated[
        float | None,
        typer.Option(
            callback=above_zero, help="Largest speed of every joint, rad/s (m/s), if below what robot and drives state."
        ),
    ] = None,
    acceleration: Annotated[
        float | None, typer.Option(callback=above_zero, help="Largest acceleration, rad/s2 (m/s2).")
    ] = None,
    torque: Annotated[
        float | None,
        typer.Option(callback=above_zero, help="Largest torque of every motor, at the joint's side, N m (N)."),
    ] = None,
    box: Annotated[
        Corners | None,
        typer.Option(
            metavar="X0 Y0 Z0 X1 Y1 Z1", help="Low and high corners, m, in the world, of a box that the tool stays in."
        ),
    ] = None,
    frame: Annotated[
        str | None, typer.Option(help="Frame that stays in the box; default: the tool's, as in compare.")
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(callback=above_zero, help="Duration of the search; Ctrl-C ends it early with the best so far."),
    ] = 30.0,
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for excitation.csv, .json (to resume from) and .png.")
    ] = Path("excitation"),
) -> None:
    """Find the motion, within a robot's limits, whose torques reveal most about its inertias and friction.

    Run it again with the same --output to continue the search from the last result.  Watch the motion in simulation
    before running it on a machine: bodies may collide, since their shapes are not known here.
    """
    from cutpoint.identification import excitation
    from cutpoint.identification.excitation.table import FILES, save, table_of

    loaded = robot.load()
    boxes = _boxes(loaded, box, frame)
    check_target_folder(output, "--output")
    found = excitation(
        loaded, duration, harmonics, base_frequency, criterion=criterion, travel=travel, speed=speed,
        acceleration=acceleration, torque=torque, boxes=boxes, seconds=seconds, resume=output / FILES[1],
    )  # fmt: skip
    saved = save(found, output)
    print_table(table_of(found), console)
    for path in saved:
        say_path("saved", path)


def _boxes(robot: cutpoint.Robot, box: Corners | None, frame: str | None) -> dict[str, Any]:
    """Of the frame that was named, or the tool's."""
    if box is None:
        if frame is not None:
            raise InputError(f"--frame {frame!r} needs a box to stay in: add --box X0 Y0 Z0 X1 Y1 Z1")
        return {}
    return {frame or tool_frame_of(robot.mechanism): (box[:3], box[3:])}


@app.command(epilog="Example: cutpoint identify arm.urdf log.csv --drives arm.drives.yaml --mapping map.yaml")
@takes_robot()
def identify(
    robot: RobotFile,
    logs: Annotated[
        list[Path],
        typer.Argument(metavar="LOG", help="CSV, NPZ, MAT, Parquet, a ROS 2 bag, or a cutpoint log; one or several."),
    ],
    mapping: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="What each channel of the logs is (YAML); without it, channels are found by name."
        ),
    ] = None,
    output: Annotated[
        Path,
        typer.Option(metavar="DIR", help="Folder for robot.urdf, robot.drives.yaml, parameters.json, report.html."),
    ] = Path("identified"),
    hold_out: Annotated[
        float, typer.Option(help="Share of the logs, at their end, kept out of the fit to validate the model.")
    ] = 0.3,
    method: Annotated[
        Literal["ordinary", "weighted", "huber", "instrumental"],
        typer.Option(help="Kind of least squares; huber tolerates outliers, instrumental noisy positions."),
    ] = "huber",
    solver: Annotated[
        Literal["lmi", "lmi_trace", "log_cholesky"],
        typer.Option(help="For physically consistent bodies: lmi needs the extra 'identify', log_cholesky does not."),
    ] = "lmi",
    springs: Annotated[
        bool | None,
        typer.Option(
            "--springs/--no-springs",
            help="Identify the drives' springs; default: if the log has both encoders, and a drive a spring.",
        ),
    ] = None,
    rotors: Annotated[
        bool,
        typer.Option(
            "--rotors/--no-rotors", help="Identify the rotors' inertias; not from torques at the gears' output."
        ),
    ] = True,
    friction: Annotated[
        Literal["choose", "stated"],
        typer.Option(help="Friction law of each joint: the one that predicts best, or the drive file's."),
    ] = "choose",
    cutoff: Annotated[
        float | None,
        typer.Option(
            callback=above_zero, help="Cutoff for the positions, Hz; default: where they sink into their noise."
        ),
    ] = None,
    bandwidth: Annotated[
        float | None,
        typer.Option(callback=above_zero, help="Bandwidth of the fitted torques, Hz; default: at most 10 Hz."),
    ] = None,
    delay: Annotated[
        float,
        typer.Option("--delay", "--torque-delay", help="Delay with which torques act, s: half a period for commands."),
    ] = 0.0,
    align: Annotated[
        bool, typer.Option("--align", metavar="", help="First align the links' encoders with the motors' clock.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", metavar="", help="Overwrite the files of an earlier run.")] = False,
) -> None:
    """Identify masses, inertias, friction and drives from logs, with intervals, and report what they cannot tell.

    First run a motion from cutpoint excite on the machine and record positions, of motor and link if both have
    encoders, and torques or currents.  If the log is in degrees, counts or percent, or at the motor's shaft, say so in
    a mapping file: see docs/log-mapping.md.
    """
    from cutpoint.identification.output import identify as identified
    from cutpoint.identification.output.saving import FILES, check_folder, file_notes
    from cutpoint.identification.output.terminal import sentences, table_of

    check_folder(output, force)
    for name in FILES:
        check_apart("--output", output / name, [robot.path, robot.drives, mapping, *logs])
    loaded = robot.load()
    file = cutpoint.robots.XIA2019_URDF if str(robot.path) == "xia2019" else robot.path
    found = identified(
        loaded, logs, mapping, hold_out=hold_out, springs=springs, rotors=rotors, friction=friction, method=method,
        solver=solver, cutoff=cutoff, bandwidth=bandwidth, torque_delay=delay, align=align, source=file,
        xacro=robot.arguments, progress=True,
    )  # fmt: skip
    saved = found.save(output, force=force)
    print_table(table_of(found), console)
    for sentence in sentences(found):
        console.print(sentence, highlight=False)
    say_notes(file_notes(found))
    for path in saved:
        say_path("saved", path)

"""The command line: one thin command per job."""

import atexit
import gc
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape

import cutpoint
from cutpoint.cli_tables import drive_table, error_table, listed_numbers, modes_table, robot_table, torque_table
from cutpoint.door import check_configuration, driven_joints
from cutpoint.errors import CutpointError, InputError, SimulationError

if TYPE_CHECKING:
    from cutpoint.simulation import Log

app = typer.Typer(
    help="Dynamics, simulation and control of robots whose joints bend.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
console = Console(width=None if sys.stdout.isatty() else 120)

RobotFile = Annotated[
    Path, typer.Argument(metavar="ROBOT", help="URDF, xacro or MJCF file, or xia2019, the paper's arm.")
]
Drives = Annotated[Path | None, typer.Option(metavar="FILE", help="Drive file (YAML): see docs/drive-file.md.")]
Mimics = Annotated[
    Literal["independent", "coupled"],
    typer.Option("--mimic", help="Mimic joints as coordinates of their own, or tied to their leader."),
]
Degrees = Annotated[bool, typer.Option("--degrees", help="Angles, and their rates, are given in degrees.")]
Rung = Literal["none", "gravity", "rigid", "rotor", "friction", "elastic"]


@app.command(epilog="Example: cutpoint inspect arm.urdf --drives arm.drives.yaml")
def inspect(robot: RobotFile, drives: Drives = None, mimic: Mimics = "independent") -> None:
    """Show what a robot is: joints, bodies, limits, drives, and where virtual decomposition cuts it."""
    loaded = _robot(robot, drives, mimic)
    console.print(robot_table(loaded))
    console.print(drive_table(loaded))


@app.command(epilog="Example: cutpoint torque xia2019 --q 0,30,60,0,45,0 --degrees")
def torque(
    robot: RobotFile,
    q: Annotated[str, typer.Option(help="Positions, rad (m), separated by commas, in the order of inspect.")],
    v: Annotated[str, typer.Option(help="Speeds, rad/s; zero if not given.")] = "",
    a: Annotated[str, typer.Option(help="Accelerations, rad/s2; zero if not given.")] = "",
    drives: Drives = None,
    degrees: Degrees = False,
    mimic: Mimics = "independent",
) -> None:
    """Torques that hold or move a robot; with elastic drives, where their motors must stand."""
    loaded = _robot(robot, drives, mimic)
    position, speed, acceleration = (_numbers(loaded, *given, degrees) for given in (("q", q), ("v", v), ("a", a)))
    check_configuration(loaded.mechanism, position.tolist())
    still = np.zeros(len(loaded.joints))
    torques = loaded.elastic_inverse_dynamics(position, speed, acceleration, still, still, quasi_rigid=True)
    console.print(torque_table(loaded, position, speed, acceleration, torques))


@app.command(
    epilog="Example: cutpoint simulate xia2019 --to 90,60,60,90,60,90 --degrees --duration 10 --output run.npz"
)
def simulate(
    robot: RobotFile,
    to: Annotated[str, typer.Option(help="Final positions, rad (m), separated by commas, in the order of inspect.")],
    duration: Annotated[float, typer.Option(help="Duration of the motion, s.")],
    start: Annotated[str, typer.Option("--from", help="Initial positions; zero if not given.")] = "",
    drives: Drives = None,
    degrees: Degrees = False,
    mimic: Mimics = "independent",
    bandwidth: Annotated[float, typer.Option(help="Bandwidth of the PD on the motors, Hz.")] = 5.0,
    feedforward: Annotated[Rung, typer.Option(help="How much of the model is fed forward.")] = "elastic",
    period: Annotated[float, typer.Option(help="Control period, s.")] = 1e-3,
    output: Annotated[Path | None, typer.Option(metavar="FILE", help="Save the log: .npz or .csv.")] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save a picture of the run: .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Move a robot along a cycloid, (57), under PD on its motors and feedforward, and report the errors."""
    from cutpoint.control import Feedforward, tune

    _check_targets(output, plot)
    loaded = _robot(robot, drives, mimic)
    ends = {"start": _numbers(loaded, "from", start, degrees), "end": _numbers(loaded, "to", to, degrees)}
    trajectory = cutpoint.trajectories.cycloid(duration=duration, **ends)
    controller: Any = tune(loaded, bandwidth)
    if feedforward != "none":
        controller = controller + Feedforward(loaded, feedforward)
    try:
        log = cutpoint.simulate(loaded, controller, trajectory, control_period=period)
    except SimulationError as error:
        if error.log is not None:
            _keep(error.log, output, plot)
        raise
    console.print(error_table(loaded, log))
    _keep(log, output, plot)


@app.command(epilog="Example: cutpoint modes xia2019 --q 0,30,60,0,45,0 --degrees --plot modes.png")
def modes(
    robot: RobotFile,
    q: Annotated[str, typer.Option(help="Positions, rad (m), separated by commas; zero if not given.")] = "",
    drives: Drives = None,
    degrees: Degrees = False,
    friction: Annotated[
        bool, typer.Option("--friction", help="With friction's slope at rest; it damps, or locks, what swings.")
    ] = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save the frequency responses: .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Frequencies at which the drives ring, at rest, and how a motor's torque moves motor and link over frequency."""
    _check_targets(None, plot)
    loaded = _robot(robot, drives)
    position = _numbers(loaded, "q", q, degrees)
    check_configuration(loaded.mechanism, position.tolist())
    found = loaded.modes(position, friction=friction)
    console.print(modes_table(loaded, found))
    if plot:
        found.plot().savefig(plot)
        console.print(f"picture saved to {plot}")


@app.command(epilog="Example: cutpoint check arm.urdf cycle.csv --drives arm.drives.yaml --dwell 0.5 --plot check.png")
def check(
    robot: RobotFile,
    trajectory: Annotated[
        Path | None, typer.Argument(metavar="TRAJECTORY", help="CSV file of one cycle: time, and positions by joint.")
    ] = None,
    drives: Drives = None,
    to: Annotated[str, typer.Option(help="Without a file: final positions of a cycloid, as in simulate.")] = "",
    duration: Annotated[float | None, typer.Option(help="Of the cycloid, s.")] = None,
    start: Annotated[str, typer.Option("--from", help="Of the cycloid: initial positions; zero if not given.")] = "",
    degrees: Degrees = False,
    mimic: Mimics = "independent",
    dwell: Annotated[float, typer.Option(help="Pause after the motion, s, in its last position.")] = 0.0,
    period: Annotated[float, typer.Option(help="Longest time between samples, s.")] = 1e-3,
    life: Annotated[float | None, typer.Option(help="Hours asked of the gears.")] = None,
    json: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Save all numbers: .json.")] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save the torque-speed planes: .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Whether the drives are large enough for a motion that is repeated, by which margin, and how long gears last.

    Exit status: 0 if every limit that is stated holds, 3 if some margin is below 1, 1 on wrong input.
    """
    from cutpoint.studies.sizing import sizing
    from cutpoint.studies.sizing.table import sentences, table_of

    _check_targets(None, plot)
    _check_target("json", json, (".json",))
    loaded = _robot(robot, drives, mimic)
    cycle = _cycle(loaded, trajectory, (start, to), duration, degrees)
    found = sizing(loaded, cycle, dwell=dwell, period=period, life=life)
    console.print(table_of(found))
    for sentence in sentences(found):
        console.print(sentence, highlight=False, markup=False)
    if json:
        found.save(json)
        console.print(f"numbers saved to {json}")
    if plot:
        found.plot().savefig(plot)
        console.print(f"picture saved to {plot}")
    if not found.holds:
        raise typer.Exit(3)


@app.command(epilog="Example: cutpoint excite arm.urdf --drives arm.drives.yaml --seconds 60 --output excited")
def excite(
    robot: RobotFile,
    drives: Drives = None,
    duration: Annotated[float, typer.Option(help="Of the motion, s: a whole number of its periods.")] = 10.0,
    harmonics: Annotated[int, typer.Option(help="Waves in each joint, multiples of the base frequency.")] = 5,
    base_frequency: Annotated[
        float | None, typer.Option(help="Hz; one period in the whole duration if not given.")
    ] = None,
    criterion: Annotated[
        Literal["determinant", "condition"], typer.Option(help="Largest det(W^T W) or smallest condition number of W.")
    ] = "determinant",
    speed: Annotated[
        float | None, typer.Option(help="Largest speed of every joint, rad/s (m/s): below what robot and drives state.")
    ] = None,
    acceleration: Annotated[float | None, typer.Option(help="Largest acceleration, rad/s2 (m/s2).")] = None,
    torque: Annotated[float | None, typer.Option(help="Largest torque of every motor at its joint, N m (N).")] = None,
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

    loaded = _robot(robot, drives)
    output.mkdir(parents=True, exist_ok=True)
    found = excitation(
        loaded, duration, harmonics, base_frequency, criterion=criterion, speed=speed, acceleration=acceleration,
        torque=torque, seconds=seconds, resume=output / FILES[1],
    )  # fmt: skip
    console.print(table_of(found))
    for path in save(found, output):
        console.print(f"saved: {path}", soft_wrap=True, highlight=False, markup=False)


@app.command(epilog="Example: cutpoint identify arm.urdf log.csv --drives arm.drives.yaml --mapping map.yaml")
def identify(
    robot: RobotFile,
    log: Annotated[Path, typer.Argument(metavar="LOG", help="CSV, NPZ, MAT, Parquet, a ROS 2 bag, or a log of ours.")],
    mapping: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Which channels of the log are what (YAML); found by their names if not given."
        ),
    ] = None,
    drives: Drives = None,
    output: Annotated[
        Path,
        typer.Option(metavar="DIR", help="Folder for robot.urdf, robot.drives.yaml, parameters.json, report.html."),
    ] = Path("identified"),
    hold_out: Annotated[
        float, typer.Option(help="Share of the log, at its end, that judges the model and is not fitted.")
    ] = 0.3,
    method: Annotated[
        Literal["ordinary", "weighted", "huber", "instrumental"],
        typer.Option(help="Least squares; huber bears outliers, instrumental noisy positions."),
    ] = "weighted",
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
    delay: Annotated[
        float, typer.Option(help="s by which torques act later than stamped: half a control period for commands.")
    ] = 0.0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the files of an earlier run.")] = False,
) -> None:
    """Identify masses, inertias, friction and drives from a log, with intervals, and what the log cannot tell.

    First let the machine follow a motion of cutpoint excite, and record positions, of motor and link if there are
    encoders on both, and torques or currents.  What the log has in degrees, counts or percent, or at the motor's shaft,
    a mapping file says: see docs/identification.md.
    """
    from cutpoint.identification.output import identify as identified
    from cutpoint.identification.output.saving import check_folder
    from cutpoint.identification.output.terminal import sentences, table_of

    check_folder(output, force)
    if str(robot) == "xia2019":
        robot, drives = cutpoint.robots.XIA2019_URDF, drives or cutpoint.robots.XIA2019_DRIVES
    how: Any = {"hold_out": hold_out, "method": method, "solver": solver, "springs": springs, "torque_delay": delay}
    found = identified(robot, log, mapping, drives, progress=True, **how)
    console.print(table_of(found))
    for sentence in sentences(found):
        console.print(sentence, highlight=False, markup=False)
    for path in found.save(output, force=force):
        console.print(f"saved: {path}", soft_wrap=True, highlight=False, markup=False)


@app.command(epilog="Example: cutpoint drive CSG-20-100 --plot drive.png")
def drive(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Of the catalogue; all are listed without.")
    ] = None,
    as_yaml: Annotated[bool, typer.Option("--yaml", help="Only its drive-file entry, to paste.")] = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Save its curves: .png, .pdf or .svg.")] = None,
) -> None:
    """Show a drive of the catalogue: its data sheet, with sources, and what the laws give back."""
    from cutpoint.studies.drive import catalogue_table, entry_text, print_drive, save_picture

    if name is None:
        if as_yaml or plot:
            raise InputError("--yaml and --plot need the NAME of a drive; cutpoint drive lists them")
        return console.print(catalogue_table())
    _check_targets(None, plot)
    if as_yaml:
        console.print(entry_text(name), soft_wrap=True, highlight=False, markup=False, end="")
    else:
        print_drive(name, console)
    if plot:
        save_picture(name, plot)
        (Console(stderr=True) if as_yaml else console).print(f"picture saved to {plot}")


@app.command(epilog="Example: cutpoint paper --output paper")
def paper(
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for the report, its figures and results.json.")
    ] = Path("paper"),
) -> None:
    """Carry out section IV of Xia et al. (2019), its numbers beside ours, as a report to open in a browser."""
    from cutpoint.studies.paper import run

    run(output)


@app.command(epilog="Example: cutpoint cost --output cost")
def cost(
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for the report, its figure and cost.json.")
    ] = Path("cost"),
    largest: Annotated[int, typer.Option(help="Number of joints to go to, 6 at least.", min=6)] = 64,
) -> None:
    """What inverse dynamics costs against the number of joints, by virtual decomposition and by its rivals."""
    from cutpoint.studies.cost import run

    run(output, largest=largest)


@app.command(epilog="Example: cutpoint compare arm.urdf --drives arm.drives.yaml --quick --output compare")
def compare(
    robot: Annotated[
        Path,
        typer.Argument(metavar="ROBOT", help="Robot file; xia2019, the paper's arm; or panda, of example-robot-data."),
    ] = Path("xia2019"),
    drives: Drives = None,
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for the report, its figures and results.json.")
    ] = Path("compare"),
    bandwidth: Annotated[float, typer.Option(help="Of the PD that all laws are matched to, Hz.")] = 4.0,
    period: Annotated[float, typer.Option(help="Control period, s.")] = 1e-3,
    payload: Annotated[
        float | None, typer.Option(help="Rated, kg; 2 for the paper's arm, 3 for others, if not given.")
    ] = None,
    frame: Annotated[str | None, typer.Option(help="Where the payload hangs; the tool's if not given.")] = None,
    seeds: Annotated[int, typer.Option(help="Runs of a scenario in which chance has a part.", min=1)] = 64,
    quick: Annotated[bool, typer.Option("--quick", help="4 seeds at most, and no slow move.")] = False,
) -> None:
    """Compare all control laws on one arm at equal stiffness, each departure from the model on its own."""
    from cutpoint.studies.compare import bench_of, panda, run

    loaded = panda() if str(robot) == "panda" else _robot(robot, drives)
    bench = bench_of(loaded, bandwidth=bandwidth, control_period=period, payload=payload, frame=frame)
    run(output, bench, seeds=seeds, quick=quick)


@app.command(epilog="Example: cutpoint export xia2019 --function elastic_inverse_dynamics --to c deployed")
def export(
    robot: RobotFile,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder for the files; made if it is not there.")],
    function: Annotated[str, typer.Option(help="What to export: a method of Robot, such as inverse_dynamics.")],
    to: Annotated[
        Literal["c", "cuda"],
        typer.Option(help="What to write: c, a package of C99 with a header for C++17, or cuda, CUDA C."),
    ] = "c",
    drives: Drives = None,
    frame: Annotated[str | None, typer.Option(help="For jacobian and frame_pose: of which frame.")] = None,
    name: Annotated[str | None, typer.Option(help="Of the C function, the same if not given.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that cutpoint has not written.")] = False,
) -> None:
    """Write a robot's function as code for machines without Python, equal to ours to the last bit, with its check."""
    from cutpoint.export import export_function

    options = {} if frame is None else {"frame": frame}
    for path in export_function(_robot(robot, drives), function, folder, to=to, name=name, force=force, **options):
        console.print(f"{to}: {path}", soft_wrap=True, highlight=False, markup=False)


def main() -> None:
    """Entry point: errors and warnings as one line, without a traceback."""
    # what a command makes stays until its end: looking for garbage more often, and once more at the end, finds none
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    stderr = Console(stderr=True)

    def show(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        stderr.print(f"[yellow]warning:[/] {escape(str(message))}", highlight=False)

    warnings.showwarning = show
    try:
        app()
    except CutpointError as error:
        stderr.print(f"[red]error:[/] {escape(str(error))}", highlight=False)
        sys.exit(1)
    except OSError as error:
        stderr.print(f"[red]error:[/] {escape(str(error.filename))}: {escape(str(error.strerror))}", highlight=False)
        sys.exit(1)


def _robot(path: Path, drives: Path | None, mimic: Literal["independent", "coupled"] = "independent") -> cutpoint.Robot:
    """The robot of a file, or one that comes with the package."""
    if str(path) != "xia2019":
        return cutpoint.load(path, drives, mimic=mimic)
    return cutpoint.load(cutpoint.robots.XIA2019_URDF, drives or cutpoint.robots.XIA2019_DRIVES)


def _numbers(robot: cutpoint.Robot, option: str, text: str, degrees: bool) -> Any:
    """One number a joint, in SI units."""
    numbers = listed_numbers(option, text, len(robot.joints))
    if not degrees:
        return numbers
    slides = [robot.mechanism.bodies[i].joint.kind == "prismatic" for i in driven_joints(robot.mechanism).values()]
    return np.where(slides, numbers, np.radians(numbers))


def _check_targets(output: Path | None, plot: Path | None) -> None:
    """Before anything is computed: files can be written where they are wanted, and their kinds are known."""
    _check_target("output", output, (".npz", ".csv"))
    _check_target("plot", plot, (".png", ".pdf", ".svg"))


def _check_target(option: str, path: Path | None, kinds: tuple[str, ...]) -> None:
    if path is None:
        return
    if path.suffix.lower() not in kinds:
        raise InputError(f"--{option} {str(path)!r} must end in {', '.join(kinds)}", path=path)
    if not path.parent.is_dir():
        raise InputError(f"--{option} {str(path)!r}: folder {str(path.parent)!r} does not exist", path=path)


def _cycle(
    robot: cutpoint.Robot, file: Path | None, ends: tuple[str, str], duration: float | None, degrees: bool
) -> "cutpoint.trajectories.Trajectory":
    """The motion of a file, or a cycloid between two ends."""
    start, end = ends
    if file is not None:
        if start or end or duration is not None or degrees:
            rule = "--to, --from, --duration and --degrees do not go with it; its first line names the units"
            raise InputError(f"trajectory {str(file)!r} is a motion already: {rule}", path=file)
        return cutpoint.trajectories.from_csv(file, robot.joints)
    if not end or duration is None:
        raise InputError("a motion is needed: a CSV file TRAJECTORY, or --to with --duration")
    places = {"start": _numbers(robot, "from", start, degrees), "end": _numbers(robot, "to", end, degrees)}
    return cutpoint.trajectories.cycloid(duration=duration, **places)


def _keep(log: "Log", output: Path | None, plot: Path | None) -> None:
    if output:
        log.save(output)
        console.print(f"log saved to {output}")
    if plot:
        log.plot("q", "reference_q").savefig(plot)
        console.print(f"picture saved to {plot}")

"""Studies: pages with figures."""

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from cutpoint.commands.laws import Period
from cutpoint.commands.robot_file import RobotFile, takes_robot
from cutpoint.commands.shared import above_zero, app
from cutpoint.errors import INTERRUPTED, InputError


@contextmanager
def _whole_report() -> Generator[None, None, None]:
    """Reports are written at the end: after Ctrl-C there is none."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt("no report was written") from None


@app.command(epilog="Example: cutpoint paper --output paper")
@_whole_report()
def paper(
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for the report, its figures and results.json.")
    ] = Path("paper"),
) -> None:
    """Reproduce section IV of Xia et al. (2019), its numbers beside ours, as a report to open in a browser."""
    from cutpoint.studies.paper import run

    run(output)


@app.command(epilog="Example: cutpoint cost --output cost")
@_whole_report()
def cost(
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for the report, its figure and cost.json.")
    ] = Path("cost"),
    largest: Annotated[int, typer.Option(help="Largest number of joints.", min=6, max=64)] = 64,
) -> None:
    """Cost of inverse dynamics over the number of joints, by virtual decomposition and by its rivals."""
    from cutpoint.studies.cost import run

    run(output, largest=largest)


@app.command(epilog="Example: cutpoint compare arm.urdf --drives arm.drives.yaml --quick --output compare")
@takes_robot("xia2019", file="Robot file; xia2019, the paper's arm; or panda, from example-robot-data.")
@_whole_report()
def compare(
    robot: RobotFile,
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for the report, its figures and results.json.")
    ] = Path("compare"),
    bandwidth: Annotated[
        float, typer.Option(callback=above_zero, help="Bandwidth of the PD that all laws are matched to, Hz.")
    ] = 4.0,
    period: Period = 1e-3,
    payload: Annotated[
        float | None, typer.Option(help="Rated payload, kg; default: 2 for the paper's arm, 3 for others.")
    ] = None,
    frame: Annotated[str | None, typer.Option(help="Frame that carries the payload; default: the tool's.")] = None,
    seeds: Annotated[int, typer.Option(help="Runs of each randomised scenario.", min=1)] = 64,
    quick: Annotated[bool, typer.Option("--quick", metavar="", help="At most 4 seeds, and no slow move.")] = False,
) -> None:
    """Compare all control laws on one arm at equal stiffness, with one departure from the model at a time."""
    from cutpoint.studies.compare import bench_of, panda, run

    is_panda = str(robot.path) == "panda"
    if is_panda and robot.given:
        named = ", ".join(robot.given)
        raise InputError(f"panda takes no such options; leave out {named}, or give the path of your own robot file")
    loaded = panda() if is_panda else robot.load()
    bench = bench_of(loaded, bandwidth=bandwidth, control_period=period, payload=payload, frame=frame)
    found = run(output, bench, seeds=seeds, quick=quick)
    if not found["settings"]["complete"]:
        raise typer.Exit(INTERRUPTED)

"""Logs that were saved, as pictures."""

from pathlib import Path
from typing import Annotated

import typer

import cutpoint
from cutpoint.commands.shared import OF_A_RUN, PICTURE, app, check_apart, check_target, keep_picture
from cutpoint.errors import InputError


@app.command(epilog="Example: cutpoint plot pd.npz vdc.npz --channel position_error --output both.png")
def plot(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG", help="Logs saved by simulate or torque.")],
    channel: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Channel to draw; repeat for more; default: the most informative ones."),
    ] = None,
    output: Annotated[Path, typer.Option(metavar="FILE", help="The picture: .png, .pdf or .svg.")] = Path("plot.png"),
) -> None:
    """Plot saved logs, joint by joint, one or several for comparison.  docs/log-channels.md lists every channel."""
    from cutpoint.simulation.log.plot import picture

    check_target("output", output, PICTURE)
    check_apart("--output", output, logs)
    if twice := next((path for path in logs if logs.count(path) > 1), None):
        raise InputError(f"{str(twice)!r} is named twice; name each log once", path=twice)
    # files of the same name are distinguished by their folders
    words = [path.stem for path in logs]
    names = words if len({*words}) == len(words) else [*map(str, logs)]
    found = {name: cutpoint.Log.load(path) for name, path in zip(names, logs, strict=True)}
    channels = channel or [name for name in OF_A_RUN if all(name in log for log in found.values())]
    if not channels:
        known = ", ".join(dict.fromkeys(name for log in found.values() for name in log.channels))
        raise InputError(f"none of {', '.join(OF_A_RUN)} is in every log: name a --channel; there are: {known}")
    keep_picture(picture(found if len(found) > 1 else {"": found[names[0]]}, channels), output)

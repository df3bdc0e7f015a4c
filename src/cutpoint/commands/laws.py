"""Control laws by name, with gains by bandwidth."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, get_args

import numpy as np
import typer

import cutpoint
from cutpoint.commands.shared import RungOption, above_zero, say_notes
from cutpoint.errors import InputError, listed, unknown_name

Name = Literal[
    "PD",
    "PID",
    "ComputedTorque",
    "ElasticComputedTorque",
    "FullStateFeedback",
    "VDC",
    "AdaptiveVDC",
    "SlotineLi",
    "Robust",
    "SuperTwisting",
]


def by_name(text: str) -> str:
    """The law's name, whose case does not matter."""
    names = get_args(Name)
    found = [name for name in names if name.casefold() == text.casefold()]
    if not found:
        raise typer.BadParameter(str(unknown_name("law", text, names)))
    return found[0]


NAMES = f"<{'|'.join(get_args(Name))}>"
Law = Annotated[
    Name,
    typer.Option(
        "--law", parser=by_name, metavar=NAMES, help="Law of cutpoint.control: see which-controller.md in docs."
    ),
]
Bandwidth = Annotated[
    float, typer.Option("--bandwidth", callback=above_zero, help="Bandwidth of the law, Hz, which sets its gains.")
]
Feed = Annotated[
    RungOption | None,
    typer.Option("--feedforward", help="How much of the model to feed forward with PD or PID; default elastic."),
]
Guarded = Annotated[
    bool, typer.Option("--guard", metavar="", help="Wrap the law in a Guard: limits of robot and drives, and faults.")
]
Period = Annotated[float, typer.Option("--period", "--control-period", callback=above_zero, help="Control period, s.")]

BANDWIDTH, PERIOD = 5.0, 1e-3
"""Hz, s: defaults."""

WITHOUT_MODEL = ("PD", "PID")
"""Laws without a model of the robot, only gains."""


def law_of(
    robot: cutpoint.Robot,
    law: Name,
    bandwidth: float,
    feedforward: RungOption | None,
    period: float,
    *,
    guard: bool = False,
) -> Any:
    """The law with its gains, with feedforward added if it has none, in a guard if asked.  Raises InputError.

    Says what a guard leaves without a limit.
    """
    from cutpoint import control

    has_model = law not in WITHOUT_MODEL
    if has_model and feedforward is not None:
        rule = f"{law} already contains the robot's model; leave this out, or use --law {' or '.join(WITHOUT_MODEL)}"
        raise InputError(f"--feedforward {feedforward}: {rule}", law=law)
    tuned = control.tune(robot, bandwidth, getattr(control, law), control_period=period)
    if not has_model and feedforward != "none":
        tuned = tuned + control.Feedforward(robot, feedforward or "elastic")
    if not guard:
        return tuned
    guarded = control.Guard(robot, tuned)
    say_notes(_unlimited(guarded))
    return guarded


def _unlimited(guard: Any) -> Iterator[str]:
    """Notes on joints whose torque or speed a guard does not limit, since neither robot nor drive file does."""
    for what, limits in (("torque", guard.torque_limit), ("speed", guard.speed_limit)):
        names = [name for name, limit in zip(guard.robot.drives, limits, strict=True) if np.isinf(limit)]
        if names:
            yield f"the guard has no {what} limit for {listed(names)}: state it in the robot file or the drive file"

"""A robot as a command names it: its file, and the options on how to read it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from inspect import Signature, signature
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

import cutpoint
from cutpoint.commands.shared import check_apart, say_notes
from cutpoint.errors import InputError
from cutpoint.model.holding import Degrees
from cutpoint.model.tool import tool_frame_of

FILE = "URDF, xacro or MJCF file, or xia2019, the paper's arm."
_PANEL = "Robot"

TARGETS = ("output", "plot", "json")
"""Options for files that a command writes."""

Command = Callable[..., None]


def _option(*names: str, **about: Any) -> Any:
    return typer.Option(*names, rich_help_panel=_PANEL, **about)


# metavar: otherwise an option without a value would be shown with one
FloatingBase = Annotated[
    bool, _option("--floating-base", metavar="", help="Carry the root link of a URDF on a free joint.")
]


@dataclass(frozen=True)
class RobotFile:
    """A robot's file, or "xia2019", and the options on how to read it: see `takes_robot`."""

    path: Path
    drives: Annotated[Path | None, _option(metavar="FILE", help="Drive file (YAML): see docs/drive-file.md.")] = None
    mimic: Annotated[
        Literal["independent", "coupled"],
        _option("--mimic", help="Mimic joints as independent coordinates, or tied to their leader."),
    ] = "independent"
    lock: Annotated[
        list[str] | None,
        _option(
            "--lock", metavar="JOINT=PLACE", help="Hold a joint fixed at a position, rad (m); repeat for more joints."
        ),
    ] = None
    gravity: Annotated[
        tuple[float, float, float] | None,
        _option(metavar="X Y Z", help="Gravity in the world's frame, m/s2; default: 0 0 -9.81, or an MJCF file's."),
    ] = None
    carry: Annotated[
        tuple[float, float, float, float] | None,
        _option(metavar="KG X Y Z", help="A payload: its mass, and where it is in the tool's frame, m, as a point."),
    ] = None
    carry_frame: Annotated[str | None, _option(metavar="FRAME", help="Frame of --carry instead of the tool's.")] = None
    mend_inertia: Annotated[
        bool,
        _option(
            "--mend-inertia", metavar="", help="Enlarge physically impossible inertias of a URDF by what they lack."
        ),
    ] = False
    xacro: Annotated[
        list[str] | None,
        _option("--xacro", metavar="NAME:=VALUE", help="Argument of a .xacro file; repeat for more arguments."),
    ] = None

    def load(self, *, floating_base: bool = False, degrees: bool = False) -> cutpoint.Robot:
        """The robot.  degrees: of --lock.  Raises InputError and ModelError."""
        path, drives = self.path, self.drives
        if not path.suffix and str(path) != "xia2019" and not path.exists():
            told = f"there is no file {str(path)!r}, and the only arm that comes with cutpoint is xia2019"
            raise InputError(told, path=path)
        if str(path) == "xia2019":
            path, drives = cutpoint.robots.XIA2019_URDF, drives or cutpoint.robots.XIA2019_DRIVES
        return self._carrying(cutpoint.load(
            path, drives, mimic=self.mimic, lock=self._places(degrees), gravity=self.gravity,
            mend_inertia=self.mend_inertia, xacro=self.arguments, floating_base=floating_base,
        ))  # fmt: skip

    @property
    def given(self) -> list[str]:
        """The options that were given; lists that were not may be empty or None, as the version of Typer has it."""
        values = {x: getattr(self, name) for name, x in signature(RobotFile).parameters.items() if name != "path"}
        told = [x.name for x, value in values.items() if value and value != x.default]
        return [f"--{name.replace('_', '-')}" for name in told]

    @property
    def arguments(self) -> dict[str, str]:
        """Arguments of a .xacro file.  Raises InputError."""
        arguments: dict[str, str] = {}
        for argument in self.xacro or []:
            name, colon, value = argument.partition(":=")
            if not name or not colon:
                raise InputError(f"--xacro {argument!r} must be NAME:=VALUE, such as ur_type:=ur10e", argument=argument)
            arguments[name] = value
        return arguments

    def _carrying(self, robot: cutpoint.Robot) -> cutpoint.Robot:
        """The robot with its payload, and a note on the frame that holds it.  Raises InputError and ModelError."""
        if self.carry is None:
            if self.carry_frame is not None:
                raise InputError(f"--carry-frame {self.carry_frame!r} needs a payload: add --carry KG X Y Z")
            return robot
        mass, *point = self.carry
        frame = tool_frame_of(robot.mechanism) if self.carry_frame is None else self.carry_frame
        held = robot.with_payload(mass, point, np.zeros((3, 3)), frame)
        say_notes([f"carries {mass:g} kg, at {', '.join(f'{x:g}' for x in point)} m in the frame {frame!r}"])
        return held

    def _places(self, degrees: bool) -> dict[str, float]:
        """Where joints are locked.  Raises InputError."""
        places, unit = dict[str, float](), "degrees" if degrees else "rad"
        for lock in self.lock or []:
            joint, _, place = lock.rpartition("=")
            if joint in places:
                raise InputError(
                    f"--lock {lock!r}: {joint!r} is already locked at {places[joint]:g}; give one position"
                )
            try:
                places[joint] = Degrees(place) if degrees else float(place)
            except ValueError:
                joint = ""
            if not joint:
                raise InputError(
                    f"--lock {lock!r} must be JOINT=PLACE, such as finger_joint=0.02, in {unit} (m)", lock=lock
                )
        return places


def takes_robot(default: str | None = None, *, file: str = FILE) -> Callable[[Command], Command]:
    """A command whose first parameter is a RobotFile as one that takes its fields, since Typer knows no records.

    default: where ROBOT may be left out.  file: what it may be.
    """

    def of(command: Command) -> Command:
        (robot, *own), (path, *options) = (signature(x).parameters.values() for x in (command, RobotFile))
        argument = path.replace(
            annotation=Annotated[Path, typer.Argument(metavar="ROBOT", help=file)],
            default=Signature.empty if default is None else Path(default),
        )

        @wraps(command)
        def run(**given: Any) -> None:
            for name in TARGETS:
                if given.get(name) is not None:
                    check_apart(f"--{name}", given[name], [x for key, x in given.items() if key not in TARGETS])
            fields = {x.name: given.pop(x.name) for x in (path, *options)}
            command(**{robot.name: RobotFile(**fields)}, **given)

        keywords = [x.replace(kind=x.KEYWORD_ONLY) for x in (argument, *own, *options)]
        run.__signature__ = Signature(keywords)  # type: ignore[attr-defined]
        return run

    return of

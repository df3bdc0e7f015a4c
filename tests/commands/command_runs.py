"""Commands that tests run, and a robot of one joint to run them on."""

import json
from pathlib import Path
from typing import Any

import typer
from typer.testing import CliRunner

from cutpoint.commands import app

ONE_JOINT = """<robot name="[/]arm:eyes:"><link name="base"/><link name="a[red]"><inertial><origin xyz="0.1 0 0"/>
<mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="{joint}" type="revolute"><parent link="base"/><child link="a[red]"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="3"/></joint></robot>"""

ELASTIC = """version: 1
drives: {swing: {ratio: 100, rotor: {inertia: 1.0e-5}, compliance: {linear: {stiffness: 1.0e4}}}}
"""


def one_joint(folder: Path) -> tuple[str, str, str]:
    """The robot of one joint and its drive in files, as a command takes it."""
    robot, drives = folder / "arm.urdf", folder / "arm.yaml"
    robot.write_text(ONE_JOINT.format(joint="swing"))
    drives.write_text(ELASTIC)
    return str(robot), "--drives", str(drives)


def printed(*arguments: str) -> str:
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    return result.output


OF_COMMANDS = typer.main.get_command(app).commands


def taken_by(command: str) -> set[str]:
    """The names of a command's arguments and options."""
    return {x.name for x in OF_COMMANDS[command].params}


def refuse(*_: object, **__: object) -> None:
    raise AssertionError("work was done first")


def saved(folder: Path, *arguments: str) -> Any:
    """What a command writes as JSON."""
    file = folder / "found.json"
    assert f"numbers saved: {file}\n" in printed(*arguments, "--json", str(file))
    return json.loads(file.read_text(encoding="utf-8"))

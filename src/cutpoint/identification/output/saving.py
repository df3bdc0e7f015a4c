"""Files of an identification: the robot, its drives, all numbers, the report."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.files import check_target_folder, replacing
from cutpoint.formats.drives.file_writing import remarked_drives
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_xml import MAXIMUM_BYTES
from cutpoint.formats.urdf.writing import updated_urdf
from cutpoint.formats.urdf.xacro_expansion import expand
from cutpoint.identification.output.identification import Identification
from cutpoint.identification.output.numbers import Number
from cutpoint.identification.output.report import report
from cutpoint.identification.rigid.uncertainty import COSTLY
from cutpoint.joint_units import at_joints
from cutpoint.reporting.numbers import json_bytes
from cutpoint.robot import Robot
from cutpoint.version import __version__

FILES = ("robot.urdf", "robot.inertias.json", "robot.drives.yaml", "parameters.json", "report.html")


def check_folder(folder: Path, force: bool) -> None:
    """Raises InputError for a path that is not a folder, is not writable, or has files that would be overwritten."""
    check_target_folder(folder)
    there = [name for name in FILES if (folder / name).exists()]
    if there and not force:
        names = ", ".join(there)
        raise InputError(
            f"output {str(folder)!r} already holds {names}; name another, or give --force (force=True)", output=folder
        )


def file_notes(found: Identification) -> list[str]:
    """Notes on the files, in addition to the identification's own; its report has these too."""
    return _model_files(found)[1]


def save(found: Identification, folder: Path, force: bool) -> list[Path]:
    """All files are made before the first is written, so that a folder has files of one run."""
    check_folder(folder, force)
    files, notes = _model_files(found)
    files |= {"parameters.json": json_bytes(_sheet(found, notes)), "report.html": report(found, notes).encode()}
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        with replacing(folder / name) as file:
            file.write(content)
    return [folder / name for name in files]


def _model_files(found: Identification) -> tuple[dict[str, bytes], list[str]]:
    """Robot and drives, and notes on these."""
    files, notes = _robot_file(found)
    remarks: dict[str, dict[tuple[str, ...], str]] = {joint: {} for joint in found.robot.drives}
    for number in found.numbers:
        if number.path:
            remarks[number.joint][number.path] = number.remark
    offsets = _offsets(found)
    notes += offsets
    heading = [f"Identified by cutpoint {__version__}; remarks are 95 % intervals, from the log alone."]
    heading += offsets
    try:
        files["robot.drives.yaml"] = remarked_drives(found.robot.drives, remarks, heading).encode()
    except InputError as error:
        notes.append(f"no drive file was written: {error}")
    return files, notes


def _offsets(found: Identification) -> list[str]:
    """Notes on torque offsets, which no file holds though a report's errors include them."""
    errors, notes = found.errors, list[str]()
    for number in found.numbers:
        if not number.name.startswith("offset."):
            continue
        j = found.robot.joints.index(number.joint)
        without = replace(errors, after=errors.after - number.used * np.eye(len(found.robot.joints))[j])
        is_missed = not number.told and without.rms("after")[j] > COSTLY * errors.rms("after")[j]
        if is_missed or (number.told and not number.low <= 0.0 <= number.high):
            torque = f"{number.used:.4g} {number.unit} of {number.joint}'s torque is an offset"
            rule = "no file holds it, so models made from these files are off by it"
            notes.append(f"{torque}, of a sensor or a current: {rule}")
    return notes


def _robot_file(found: Identification) -> tuple[dict[str, bytes], list[str]]:
    source = found.source
    kind = source.suffix.lower() if source else ""
    if source and kind in (".urdf", ".xacro"):
        content = expand(source, found.xacro).encode() if kind == ".xacro" else read_bytes(source, MAXIMUM_BYTES)
        text, moved = updated_urdf(content, found.before.mechanism, found.robot.mechanism, str(source))
        notes = [f"robot.urdf: {words}" for words in moved]
        if kind == ".xacro":
            notes.append("robot.urdf is the expanded xacro file")
        return {"robot.urdf": text}, notes
    what = "an MJCF file" if source else "a robot in memory"
    note = f"the robot is {what}, which is not rewritten: copy the numbers of robot.inertias.json into it by hand"
    return {"robot.inertias.json": json_bytes(bodies_of(found.robot))}, [note]


def bodies_of(robot: Robot) -> dict[str, Any]:
    """Mass (kg), centre of mass (m) and inertia about it (kg m2) of each body, along its link's axes."""
    return {
        body.name: {"mass": float(body.mass), "com": body.com.tolist(), "inertia": body.inertia.tolist()}
        for body in robot.mechanism.bodies
    }


def _sheet(found: Identification, notes: list[str]) -> Mapping[str, Any]:
    errors = found.errors
    rms = {
        "measured": errors.size(),
        "before": errors.rms("before"),
        "fitted": errors.rms("after"),
        "held_out": errors.rms("after", True),
        "before_held_out": errors.rms("before", True),
        "plain_held_out": errors.rms("plain", True),
    }
    return {
        "cutpoint": __version__,
        "robot": found.robot.name,
        "joints": found.robot.joints,
        "torque_units": [*at_joints(found.robot, "N m").values()],
        "torque_RMS": rms,
        "held_out_over_plain": [ratio._asdict() for ratio in errors.to_plain()],
        "numbers": [_number(number) for number in found.numbers],
        "bodies": bodies_of(found.robot),
        "untold": found.untold,
        "doubts": found.doubts,
        "notes": [*found.notes, *notes],
    }


def _number(number: Number) -> dict[str, Any]:
    return {name: value for name, value in vars(number).items() if name not in ("path", "scale")}

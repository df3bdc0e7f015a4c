"""From a log file to a recording: read, mapped, sorted, and checked for plausibility."""

from collections.abc import Mapping
from pathlib import Path
from types import NoneType
from typing import Any

import numpy as np

from cutpoint.door import check_kind
from cutpoint.errors import ModelError, counted, listed, those_that_exist
from cutpoint.identification.logs.common_times import at_common_times
from cutpoint.identification.logs.mapping import ChannelMap, completed, load_mapping, obvious_mapping, parse_mapping
from cutpoint.identification.logs.mapping_sheet import TimeSheet
from cutpoint.identification.logs.quantity import Columns, check_kinds, columns_of, in_si, picked, stated_ratio
from cutpoint.identification.logs.reading import read_table
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.suspicions import refuse_other_units, suspicions
from cutpoint.identification.logs.table import Table, placed
from cutpoint.robot import Robot


def read_recording(
    path: str | Path, mapping: str | Path | Mapping[str, Any] | None = None, robot: Robot | None = None
) -> Recording:
    """A log of a machine as a recording; its `notes` say what was repaired and what looks wrong.

    Args:
        path: what `read_table` reads.
        mapping: a mapping file, or a dict of its fields; None if the channels have obvious names, and SI units.
        robot: the robot whose joints were logged; gives ratios, and limits that reveal degrees.

    Raises:
        ModelError: an error in the mapping, or a mismatch with the log, with file and line.
        InputError: an error in the log: see `read_table` and `ordered`; or positions in degrees.
    """
    table = read_table(path)
    chart = obvious_mapping(table, tuple(robot.drives) if robot else ()) if mapping is None else _mapping(mapping)
    return recording_of(table, chart, robot)


def recording_of(table: Table, mapping: ChannelMap, robot: Robot | None = None) -> Recording:
    """The recording that a mapping makes of a table.

    Args:
        table: of `read_table`.
        mapping: of `load_mapping` or `parse_mapping`.
        robot: as in `read_recording`.

    Raises:
        ModelError: a mismatch of the mapping with the table or the robot; with file and line if it is from a file.
        InputError: no table or mapping, times that cannot be ordered, or positions in degrees.
    """
    check_kind("recording_of", "table", table, Table, "a Table (read_table reads files)")
    check_kind("recording_of", "mapping", mapping, ChannelMap, "a ChannelMap (load_mapping reads files)")
    check_kind("recording_of", "robot", robot, (Robot, NoneType), "a Robot (cutpoint.load reads files), or None")
    mapping = completed(mapping, table, tuple(robot.drives) if robot else ())
    quantities = mapping.quantities
    columns = {name: columns_of(quantity, table) for name, quantity in quantities.items()}
    joints = _joints(next(iter(columns.values())), mapping, robot)
    ratios = {name: drive.ratio for name, drive in robot.drives.items()} if robot else {}
    ratio = stated_ratio(joints, ratios, mapping)
    sliding = {*robot.mechanism.sliding} if robot else set[str]()
    chosen = {name: picked(quantities[name], each, joints) for name, each in columns.items()}
    if robot:
        for name, each in chosen.items():
            check_kinds(quantities[name], each, joints, sliding)
    slides = np.array([joint in sliding for joint in joints])
    stated = [name for name, each in chosen.items() if quantities[name].sheet.unit or any(each.units)]
    shifted = [name for name, quantity in quantities.items() if any(quantity.sheet.offset)]
    measured = {name: in_si(quantities[name], each, ratio, slides) for name, each in chosen.items()}
    with placed(table.file):
        time, channels, notes = at_common_times(table, mapping, joints, measured)
        recording = Recording(time, joints, **channels, notes=(*table.notes, *notes))
        if robot:
            refuse_other_units(recording, robot, stated, shifted)
        recording = _cut(recording, mapping.sheet.time)
    return recording.with_notes(suspicions(recording))


def _cut(recording: Recording, stated: TimeSheet) -> Recording:
    """What the mapping leaves of a recording, with a note if it leaves something out."""
    last = float(recording.time[-1])
    start, end = stated.start or 0.0, last if stated.end is None else stated.end
    if start == 0.0 and end >= last:
        return recording
    return recording.between(start, end).with_notes([f"used from {start:g} s to {min(end, last):g} s of {last:.4g} s"])


def _mapping(given: str | Path | Mapping[str, Any]) -> ChannelMap:
    return parse_mapping(given) if isinstance(given, Mapping) else load_mapping(given)


def _joints(first: Columns, mapping: ChannelMap, robot: Robot | None) -> tuple[str, ...]:
    """Names of the joints: from the mapping, the robot, the log, or else by position."""
    driven, wide = tuple(robot.drives) if robot else (), first.values.shape[1]
    named = tuple(mapping.sheet.joints or first.labels)
    if driven and not mapping.sheet.joints and (set(driven) <= set(named) or (not named and len(driven) == wide)):
        return driven
    if driven and not named:
        raise _too_many_or_few(wide, mapping, driven)
    named = named or tuple(f"joint_{k}" for k in range(wide))
    unknown = [joint for joint in named if robot and joint not in driven]
    if unknown:
        rule = f"the robot has no driven joint {unknown[0]!r}; {those_that_exist(unknown[0], driven)}"
        raise mapping.section.error(("joints",), f"{rule}; state 'joints' in the mapping")
    return named


def _too_many_or_few(wide: int, mapping: ChannelMap, driven: tuple[str, ...]) -> ModelError:
    """Error for columns without joint names, in another number than the robot's joints."""
    quantity = next(iter(mapping.quantities.values()))
    joints = f"{counted(len(driven), 'driven joint')}, {listed(driven)}"
    rule = f"{quantity.name} has {counted(wide, 'column')}, but the robot has {joints}"
    if wide < len(driven):
        remedy = "state whose they are as 'joints' in the mapping, or lock the joints that were not recorded (--lock)"
        return mapping.section.error(("joints",), f"{rule}; {remedy}")
    named = quantity.sheet.channels
    extra = named[len(driven) :] if len(named) == wide else ()
    what = f"nothing says whose {listed(extra)} are" if extra else "nothing says which belong to them"
    remedy = f"name the joints' columns in a mapping, '{quantity.name}: [...]'"
    return quantity.error("channels", f"{rule}: {what}; {remedy}")

"""From a log file to a recording: read, mapped, put in order, and looked at with suspicion."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutpoint.errors import InputError
from cutpoint.identification.logs.default_mapping import time_channel
from cutpoint.identification.logs.mapping import ChannelMap, load_mapping, obvious_mapping, parse_mapping
from cutpoint.identification.logs.quantity import Columns, columns_of, in_si, picked, stated_ratio
from cutpoint.identification.logs.reading import read_table
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.resampling import on_grid
from cutpoint.identification.logs.suspicions import refuse_degrees, suspicions
from cutpoint.identification.logs.table import Table
from cutpoint.identification.logs.time_stamps import Ordered, ordered
from cutpoint.identification.logs.units import TIMES
from cutpoint.model.places import those_that_exist
from cutpoint.robot import Robot

Array = NDArray[np.float64]


def read_recording(
    path: str | Path, mapping: str | Path | Mapping[str, Any] | None = None, robot: Robot | None = None
) -> Recording:
    """A log of a machine as a recording; its `notes` say what was repaired and what looks wrong.

    Args:
        path: what `read_table` reads.
        mapping: a mapping file, or a dict of its fields; None where the channels are named obviously, and in SI.
        robot: of whose joints it is; gives ratios, and limits that show degrees.

    Raises:
        ModelError: what is wrong in the mapping, or does not fit the log, with file and line.
        InputError: what is wrong in the log: see `read_table` and `ordered`; or positions that are degrees.
    """
    table = read_table(path)
    chart = obvious_mapping(table, tuple(robot.drives) if robot else ()) if mapping is None else _mapping(mapping)
    return recording_of(table, chart, robot)


def recording_of(table: Table, mapping: ChannelMap, robot: Robot | None = None) -> Recording:
    """The recording that a mapping makes of a table.  Errors as in `read_recording`."""
    columns = {name: columns_of(name, mapping, table) for name in mapping.quantities}
    joints = _joints(next(iter(columns.values())), mapping, robot)
    ratios = {name: drive.ratio for name, drive in robot.drives.items()} if robot else {}
    ratio = stated_ratio(joints, ratios, mapping)
    values = {
        name: in_si(name, picked(name, each, joints, mapping), each.unit, ratio, mapping)
        for name, each in columns.items()
    }
    time, channels, notes = _in_order(table, mapping, {name: each.stamps for name, each in columns.items()}, values)
    recording = Recording(time, joints, **channels, notes=tuple(notes))
    if robot:
        refuse_degrees(recording, robot, table.file)
    return recording.with_notes(suspicions(recording))


def _mapping(given: str | Path | Mapping[str, Any]) -> ChannelMap:
    return parse_mapping(given) if isinstance(given, Mapping) else load_mapping(given)


def _joints(first: Columns, mapping: ChannelMap, robot: Robot | None) -> tuple[str, ...]:
    """Names of the joints: as the mapping says, or the robot, or the log, or by their place."""
    driven, wide = tuple(robot.drives) if robot else (), first.values.shape[1]
    named = tuple(mapping.sheet.joints or first.labels)
    if driven and not mapping.sheet.joints and (set(driven) <= set(named) or (not named and len(driven) == wide)):
        return driven
    named = named or tuple(f"joint_{k}" for k in range(wide))
    unknown = [joint for joint in named if robot and joint not in driven]
    if unknown:
        rule = f"the robot has no driven joint {unknown[0]!r}; {those_that_exist(unknown[0], driven)}"
        raise mapping.section.error(("joints",), f"{rule}; state 'joints' in the mapping")
    return named


def _in_order(
    table: Table, mapping: ChannelMap, stamps: Mapping[str, Array | None], values: Mapping[str, Array]
) -> tuple[Array, dict[str, Array], list[str]]:
    """All quantities at the times of the first, which count from 0; and notes."""
    common: Ordered | None = None
    channels: dict[str, Array] = {}
    notes: list[str] = []
    groups = {id(each): each for each in stamps.values()}
    for each in groups.values():
        names = [name for name in values if stamps[name] is each]
        times = _times(table, mapping, len(values[names[0]])) if each is None else each
        found = _ordered_together(times, {name: values[name] for name in names}, table)
        notes += found.notes
        common = common or found
        for name in names:
            kept = np.where(np.isfinite(values[name]), values[name], np.nan)[found.rows]
            channels[name] = kept if found is common else _brought(name, kept, found, common, notes)
    assert common is not None
    return common.times, channels, notes


def _ordered_together(times: Array, values: Mapping[str, Array], table: Table) -> Ordered:
    for name, each in values.items():
        if len(each) != len(times):
            rule = f"it must have as many as the time has, {len(times)}"
            raise InputError(f"{name} has {len(each)} samples: {rule}; is it another log's?", place=table.file)
    return ordered(times, np.column_stack([*values.values()]), "/".join(values))


def _brought(name: str, values: Array, own: Ordered, common: Ordered, notes: list[str]) -> Array:
    """Values from their own times to the common ones."""
    later = own.start - common.start
    if later > common.times[-1] or later + own.times[-1] < 0.0:
        raise InputError(f"{name} was recorded {later:g} s after the first channel: they never ran together")
    notes.append(f"{name}: brought to the times of the first channel, from a log of its own")
    return on_grid(own.times + later, values, common.times)


def _times(table: Table, mapping: ChannelMap, count: int) -> Array:
    """Time of each sample, s.  Raises ModelError where the log has none, and the mapping does not help."""
    sheet, section = mapping.sheet.time, mapping.section
    if sheet.period is not None:
        return sheet.period * np.arange(count, dtype=np.float64)
    name = sheet.channel or time_channel(table.channels)
    if name is None:
        raise section.error(("time",), "no channel is named like a time; state 'time: {channel: ...}', or its 'period'")
    channel = table.find(name)
    if channel is None or channel.width > 1:
        raise section.error(("time", "channel"), f"time: {table.missing(name)}")
    unit = channel.unit if sheet.channel is None and channel.unit in TIMES else sheet.unit
    return TIMES[unit] * channel.values

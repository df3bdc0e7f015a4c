"""Quantities with time stamps of their own, put in order, unwrapped, and resampled at the times of the first."""

from collections.abc import Mapping, Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError, listed
from cutpoint.identification.logs.channel_names import time_channel, unit_of_time
from cutpoint.identification.logs.mapping import ChannelMap
from cutpoint.identification.logs.quantity import Measured
from cutpoint.identification.logs.resampling import on_grid
from cutpoint.identification.logs.table import Table
from cutpoint.identification.logs.time_stamps import Ordered, ordered, without_long_gaps
from cutpoint.identification.logs.wrapping import unwrapped
from cutpoint.model.stated_units import TIMES

SINCE_1970 = 1e17
"""Stamps above this are a clock's, in ns: 1e18 was in 2001, and 3 years of uptime are less."""


def at_common_times(
    table: Table, mapping: ChannelMap, joints: Sequence[str], measured: Mapping[str, Measured]
) -> tuple[Array, dict[str, Array], list[str]]:
    """All quantities at the times of the first, which start at 0; and notes.

    Raises InputError: see `ordered`; quantities that do not overlap in time.  ModelError if the log has no times.
    """
    common: Ordered | None = None
    channels: dict[str, Array] = {}
    notes: list[str] = []
    for stamps in {id(each.stamps): each.stamps for each in measured.values()}.values():
        group = {name: each for name, each in measured.items() if each.stamps is stamps}
        times = _times(table, mapping, len(next(iter(group.values())).values), notes) if stamps is None else stamps
        found = _ordered_together(times, {name: each.values for name, each in group.items()}, table)
        notes += found.notes
        common = common or found
        for name, each in group.items():
            kept = np.where(np.isfinite(each.values), each.values, np.nan)[found.rows]
            whole = unwrapped(name, found.times, kept, each.spans, each.slides, joints, notes)
            channels[name] = whole if found is common else _brought(name, whole, found, common, notes)
    assert common is not None
    return without_long_gaps(common.times, notes), channels, notes


def _ordered_together(times: Array, values: Mapping[str, Array], table: Table) -> Ordered:
    for name, each in values.items():
        if len(each) != len(times):
            rule = f"it must have as many as time, {len(times)}"
            raise InputError(f"{name} has {len(each)} samples: {rule}; is it from another log?", place=table.file)
    return ordered(times, np.column_stack([*values.values()]), "/".join(values))


def _brought(name: str, values: Array, own: Ordered, common: Ordered, notes: list[str]) -> Array:
    """Values resampled from their own times to the common ones."""
    later = own.start - common.start
    if later > common.times[-1] or later + own.times[-1] < 0.0:
        raise InputError(f"{name} was recorded {later:g} s after the first channel: the two do not overlap")
    notes.append(f"{name}: brought from its own times to those of the first channel")
    return on_grid(own.times + later, values, common.times)


def _times(table: Table, mapping: ChannelMap, count: int, notes: list[str]) -> Array:
    """Time of each sample, s, with a note if its unit was guessed.

    Raises ModelError if neither the log nor the mapping gives it.
    """
    sheet, section = mapping.sheet.time, mapping.section
    if sheet.period is not None:
        return sheet.period * np.arange(count, dtype=np.float64)
    name = sheet.channel or time_channel(table.channels)
    if name is None:
        remedy = "state 'time: {channel: ...}', or its 'period'"
        if text := time_channel(table.left_out):
            rule = f"{table.missing(text)} in s, or date-times such as 2024-05-01 12:00:00.25"
            raise section.error(("time",), f"time: {rule}; write one of these, or state 'time: {{period: ...}}'")
        raise section.error(("time",), f"no channel has a name that means time; {remedy}")
    channel = table.find(name)
    if channel is None or channel.width > 1:
        raise section.error(("time", "channel"), f"time: {table.missing(name)}")
    unit = sheet.unit or channel.unit or unit_of_time(name)
    if not unit and np.count_nonzero(channel.values > SINCE_1970) > 0.5 * channel.values.size:
        notes.append(f"time: {name} is taken as ns since 1970; if it is not, state time.unit in a mapping")
        unit = "ns"
    unit = unit or "s"
    if unit not in TIMES:
        known = listed(TIMES)
        rule = f"time: channel {name!r} is in {unit!r}, not a known unit of time; state time.unit, one of {known}"
        raise section.error(("time",), rule)
    return TIMES[unit] * channel.values

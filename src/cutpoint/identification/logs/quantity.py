"""One quantity of a recording out of a log's channels: found, and brought to SI at the joint's side."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.logs.mapping import ChannelMap, check_unit
from cutpoint.identification.logs.mapping_sheet import ChannelSheet
from cutpoint.identification.logs.table import Channel, Table
from cutpoint.identification.logs.units import COUNTS, UNITS

Array = NDArray[np.float64]


class Columns(NamedTuple):
    """Channels side by side: values (N, n), labels of their columns, and a unit and stamps where the log has them."""

    values: Array
    labels: tuple[str, ...]
    unit: str
    stamps: Array | None


def columns_of(name: str, mapping: ChannelMap, table: Table) -> Columns:
    """A quantity's channels.  Raises ModelError for one that the log lacks, or that is as long as no other."""
    channels = [_channel(name, wanted, mapping, table) for wanted in mapping.quantities[name].channels]
    first = channels[0]
    for wanted, channel in zip(mapping.quantities[name].channels, channels, strict=True):
        if len(channel.values) != len(first.values) or channel.stamps is not first.stamps:
            complaint = f"{name}: channel {wanted!r} was sampled at other times than those beside it"
            raise mapping.section.error((name, "channels"), complaint)
    labels = tuple(label for channel in channels for label in channel.labels)
    values = np.column_stack([channel.values for channel in channels])
    return Columns(values, labels if len(labels) == values.shape[1] else (), first.unit, first.stamps)


def picked(name: str, columns: Columns, joints: Sequence[str], mapping: ChannelMap) -> Array:
    """The columns of these joints, (N, n): by their labels, or all where there are as many.  Raises ModelError."""
    if set(joints) <= set(columns.labels):
        return columns.values[:, [columns.labels.index(joint) for joint in joints]]
    if columns.values.shape[1] != len(joints):
        shown = f", labelled {', '.join(columns.labels)}" if columns.labels else ""
        complaint = (
            f"{name} has {columns.values.shape[1]} columns{shown}: it must have one for each of {', '.join(joints)}"
        )
        raise mapping.section.error((name, "channels"), complaint)
    return columns.values


def in_si(name: str, values: Array, unit: str, ratio: Array | None, mapping: ChannelMap) -> Array:
    """Values (N, n) in the log's unit as SI at the joint's side.

    unit: as the log states it.  ratio: (n,), or None where nobody stated it.
    Raises ModelError: a unit or a side that needs a number, lists of another length than there are joints.
    """
    sheet, joints = mapping.quantities[name], values.shape[1]
    lists = {key: sized(name, key, getattr(sheet, key), joints, mapping) for key in ("sign", "offset")}
    factor = lists["sign"] * _unit_factor(name, sheet, unit, joints, mapping)
    if sheet.side == "motor" and name != "current":
        if ratio is None:
            raise mapping.section.error(
                (name, "side"), f"{name}.side 'motor' needs 'ratio': motor turns per joint turn"
            )
        factor = factor * ratio if name == "torque" else factor / ratio
    return values * factor + lists["offset"]


def sized(name: str, key: str, given: Sequence[float], joints: int, mapping: ChannelMap) -> Array:
    """One number for each joint, (n,).  Raises ModelError for another number of them."""
    if len(given) not in (1, joints):
        path = (name, key) if name else (key,)
        raise mapping.section.error(path, f"{'.'.join(path)} has {len(given)} numbers: it must have 1 or {joints}")
    return np.broadcast_to(np.array(given, dtype=np.float64), joints)


def _channel(name: str, wanted: str, mapping: ChannelMap, table: Table) -> Channel:
    channel = table.find(wanted)
    if channel is None:
        raise mapping.section.error((name, "channels"), f"{name}: {table.missing(wanted)}")
    return channel


def _unit_factor(name: str, sheet: ChannelSheet, stated: str, joints: int, mapping: ChannelMap) -> Array:
    """What the log's numbers are multiplied with, (n,)."""
    unit = sheet.unit or stated or next(iter(UNITS[name]))
    check_unit(name, sheet, unit, mapping.section)
    gain = sized(name, "gain", sheet.gain or [1.0], joints, mapping)
    if unit == COUNTS.get(name) and sheet.counts_per_turn:
        return gain * 2.0 * math.pi / sized(name, "counts_per_turn", sheet.counts_per_turn, joints, mapping)
    return gain * UNITS[name].get(unit, 1.0)


def stated_ratio(joints: Sequence[str], ratios: Mapping[str, float], mapping: ChannelMap) -> Array | None:
    """Motor turns per joint turn, (n,): the mapping's, or the robot's where it has all of the joints, or None."""
    if mapping.sheet.ratio:
        return sized("", "ratio", mapping.sheet.ratio, len(joints), mapping)
    return np.array([ratios[joint] for joint in joints]) if set(joints) <= set(ratios) else None

"""One quantity of a recording: found in a log's channels, and converted to SI at the joint's side."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import counted, listed
from cutpoint.identification.logs.mapping import ChannelMap, check_unit
from cutpoint.identification.logs.table import Channel, Table
from cutpoint.identification.logs.wrapping import spans
from cutpoint.model.stated_units import COUNTS, SLIDING, TURNING, UNITS


class Columns(NamedTuple):
    """Channels side by side: values (N, n), labels and units of their columns, and stamps if the log has them."""

    values: Array
    labels: tuple[str, ...]
    units: tuple[str, ...]
    stamps: Array | None


class Measured(NamedTuple):
    """A quantity in SI at the joint's side, values (N, n), and stamps (N,) if the log has separate ones for it.

    spans: (k, n), after which its sensor may wrap around; see `wrapping.spans`.
    """

    values: Array
    stamps: Array | None
    spans: Array


def columns_of(name: str, mapping: ChannelMap, table: Table) -> Columns:
    """A quantity's channels.  Raises ModelError for one that is missing, differs in length, or is used twice."""
    channels = [_channel(name, wanted, mapping, table) for wanted in mapping.quantities[name].channels]
    first = channels[0]
    for wanted, channel in zip(mapping.quantities[name].channels, channels, strict=True):
        if len(channel.values) != len(first.values) or channel.stamps is not first.stamps:
            complaint = f"{name}: channel {wanted!r} was not sampled at the same times as the others"
            raise mapping.section.error((name, "channels"), complaint)
    known: dict[int, str] = {}
    for wanted, channel in zip(mapping.quantities[name].channels, channels, strict=True):
        for column in np.atleast_2d(channel.values.T):
            start = column.__array_interface__["data"][0]
            if start in known:
                rule = (
                    f"{name}: {known[start]!r} and {wanted!r} are the same column of the log; each joint needs its own"
                )
                raise mapping.section.error((name, "channels"), rule)
            known[start] = wanted
    labels = tuple(label for channel in channels for label in channel.labels)
    units = tuple(channel.unit for channel in channels for _ in range(channel.width))
    values = np.column_stack([channel.values for channel in channels])
    return Columns(values, labels if len(labels) == values.shape[1] else (), units, first.stamps)


def picked(name: str, columns: Columns, joints: Sequence[str], mapping: ChannelMap) -> Columns:
    """The columns of these joints: by their labels, or all if the labels name no joints.  Raises ModelError."""
    if set(joints) <= set(columns.labels):
        chosen = [columns.labels.index(joint) for joint in joints]
        units = tuple(columns.units[k] for k in chosen)
        return Columns(columns.values[:, chosen], tuple(joints), units, columns.stamps)
    if columns.values.shape[1] != len(joints) or set(joints) & set(columns.labels):
        shown = f", labelled {listed(columns.labels)}" if columns.labels else ""
        found = f"{name} has {counted(columns.values.shape[1], 'column')}{shown}"
        complaint = f"{found}: it must have one for each of {', '.join(joints)}"
        raise mapping.section.error((name, "channels"), complaint)
    return columns


def check_kinds(
    name: str, columns: Columns, joints: Sequence[str], sliding: Collection[str], mapping: ChannelMap
) -> None:
    """Raises ModelError for lengths of revolute joints, and for angles of prismatic ones (their motors may turn),
    unless a gain converts them."""
    sheet = mapping.quantities[name]
    if sheet.gain:
        return
    are_mixed = 0 < sum(joint in sliding for joint in joints) < len(joints)
    remedy = "; unit may be a list, one for each joint" if are_mixed else ""
    for joint, unit in zip(joints, _units(name, columns, mapping), strict=True):
        if unit in TURNING and joint in sliding and sheet.side == "link":
            fitting = listed(each for each in UNITS[name] if each in SLIDING)
            rule = f"{name}.unit {unit!r} is for joints that turn, but {joint!r} slides: it must be one of {fitting}"
            raise mapping.section.error((name, "unit"), rule + remedy)
        if unit in SLIDING and joint not in sliding:
            fitting = listed(each for each in UNITS[name] if each not in SLIDING)
            rule = f"{name}.unit {unit!r} is for joints that slide, but {joint!r} turns: it must be one of {fitting}"
            raise mapping.section.error((name, "unit"), rule + remedy)


def in_si(name: str, columns: Columns, ratio: Array | None, slides: NDArray[np.bool_], mapping: ChannelMap) -> Measured:
    """Columns in the log's units as SI at the joint's side.

    ratio: (n,), or None if not stated.  slides: (n,), which joints are known to be prismatic.
    Raises ModelError: a unit or a side that needs a number, lists of another length than there are joints.
    """
    sheet, joints = mapping.quantities[name], columns.values.shape[1]
    sign, offset, gain, per_turn = (
        sized(name, key, given, joints, mapping)
        for key, given in (
            ("sign", sheet.sign),
            ("offset", sheet.offset),
            ("gain", sheet.gain or [1.0]),
            ("counts_per_turn", sheet.counts_per_turn or [np.nan]),
        )
    )
    units = _units(name, columns, mapping)
    factor = sign * gain * _unit_factors(name, units, per_turn)
    if sheet.side == "motor" and name != "current":
        if ratio is None:
            rule = "needs 'ratio': motor turns per joint turn, or a robot whose drives state it"
            raise mapping.section.error((name, "side"), f"{name}.side 'motor' {rule}")
        factor = factor * ratio if name == "torque" else factor / ratio
    anew = np.where(slides & (sheet.side == "link"), np.nan, np.abs(factor) * spans(name, units, per_turn))
    return Measured(columns.values * factor + offset, columns.stamps, anew)


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


def _units(name: str, columns: Columns, mapping: ChannelMap) -> list[str]:
    """Units of each column: the mapping's, the log's, or SI.  Raises ModelError if the log states only some."""
    sheet, si = mapping.quantities[name], next(iter(UNITS[name]))
    given = sheet.unit or columns.units
    if len(given) not in (1, len(columns.units)):
        rule = f"{name}.unit has {len(given)} units: it must have 1 or {len(columns.units)}"
        raise mapping.section.error((name, "unit"), rule)
    units = [unit or si for unit in (given * len(columns.units) if len(given) == 1 else given)]
    for unit in dict.fromkeys(units):
        check_unit(name, sheet, unit, mapping.section)
    stated = next((unit for unit in units if UNITS[name].get(unit) != 1.0), None)
    if stated and not sheet.unit and "" in columns.units:
        rule = f"{name}: one column states the unit {stated!r}, another states none; state '{name}.unit' in a mapping"
        raise mapping.section.error((name, "unit"), rule)
    return units


def _unit_factors(name: str, units: Sequence[str], per_turn: Array) -> Array:
    """Factors of the log's numbers, (n,), without a gain."""
    factors = np.array([UNITS[name].get(unit, 1.0) for unit in units])
    counted = np.array([unit == COUNTS.get(name) for unit in units]) & np.isfinite(per_turn)
    return np.where(counted, 2.0 * math.pi / per_turn, factors)


def stated_ratio(joints: Sequence[str], ratios: Mapping[str, float], mapping: ChannelMap) -> Array | None:
    """Motor turns per joint turn, (n,): the mapping's, or the robot's where it has all of the joints, or None."""
    if mapping.sheet.ratio:
        return sized("", "ratio", mapping.sheet.ratio, len(joints), mapping)
    return np.array([ratios[joint] for joint in joints]) if set(joints) <= set(ratios) else None

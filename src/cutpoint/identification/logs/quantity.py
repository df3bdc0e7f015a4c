"""One quantity of a recording: found in a log's channels, and converted to SI at the joint's side."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import counted, listed
from cutpoint.formats.drives.section import Section
from cutpoint.identification.logs.mapping import ChannelMap, Mapped, check_unit
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
    slides: (n,), which joints are known to be prismatic.
    """

    values: Array
    stamps: Array | None
    spans: Array
    slides: NDArray[np.bool_]


def columns_of(quantity: Mapped, table: Table) -> Columns:
    """A quantity's channels.  Raises ModelError for one that is missing, differs in length, or is used twice."""
    name, names = quantity.name, quantity.sheet.channels
    channels = [_channel(quantity, wanted, table) for wanted in names]
    first, known = channels[0], dict[int, str]()
    for wanted, channel in zip(names, channels, strict=True):
        if len(channel.values) != len(first.values) or channel.stamps is not first.stamps:
            complaint = f"{name}: channel {wanted!r} was not sampled at the same times as the others"
            raise quantity.error("channels", complaint)
        for column in np.atleast_2d(channel.values.T):
            start = column.__array_interface__["data"][0]
            if start in known:
                both = f"{name}: {known[start]!r} and {wanted!r}"
                raise quantity.error("channels", f"{both} are the same column of the log; each joint needs its own")
            known[start] = wanted
    labels = tuple(label for channel in channels for label in channel.labels)
    units = tuple(channel.unit for channel in channels for _ in range(channel.width))
    values = np.column_stack([channel.values for channel in channels])
    return Columns(values, labels if len(labels) == values.shape[1] else (), units, first.stamps)


def picked(quantity: Mapped, columns: Columns, joints: Sequence[str]) -> Columns:
    """The columns of these joints: by their labels, or all if the labels name no joints.  Raises ModelError."""
    if set(joints) <= set(columns.labels):
        chosen = [columns.labels.index(joint) for joint in joints]
        units = tuple(columns.units[k] for k in chosen)
        return columns._replace(values=columns.values[:, chosen], labels=tuple(joints), units=units)
    if columns.values.shape[1] != len(joints) or set(joints) & set(columns.labels):
        shown = f", labelled {listed(columns.labels)}" if columns.labels else ""
        found = f"{quantity.name} has {counted(columns.values.shape[1], 'column')}{shown}"
        raise quantity.error("channels", f"{found}: it must have one for each of {', '.join(joints)}")
    return columns


def check_kinds(quantity: Mapped, columns: Columns, joints: Sequence[str], sliding: Collection[str]) -> None:
    """Raises ModelError for lengths of revolute joints, and for angles of prismatic ones (their motors may turn),
    unless a gain converts them."""
    name, sheet, _ = quantity
    if sheet.gain:
        return
    are_mixed = 0 < sum(joint in sliding for joint in joints) < len(joints)
    remedy = "; unit may be a list, one for each joint" if are_mixed else ""
    for joint, unit in zip(joints, _units(quantity, columns), strict=True):
        if unit in TURNING and joint in sliding and sheet.side == "link":
            fitting = listed(each for each in UNITS[name] if each in SLIDING)
            rule = f"{name}.unit {unit!r} is for joints that turn, but {joint!r} slides: it must be one of {fitting}"
            raise quantity.error("unit", rule + remedy)
        if unit in SLIDING and joint not in sliding:
            fitting = listed(each for each in UNITS[name] if each not in SLIDING)
            rule = f"{name}.unit {unit!r} is for joints that slide, but {joint!r} turns: it must be one of {fitting}"
            raise quantity.error("unit", rule + remedy)


def in_si(quantity: Mapped, columns: Columns, ratio: Array | None, slides: NDArray[np.bool_]) -> Measured:
    """Columns in the log's units as SI at the joint's side.

    ratio: (n,), or None if not stated.  slides: (n,), which joints are known to be prismatic.
    Raises ModelError: a unit or a side that needs a number, lists of another length than there are joints.
    """
    (name, sheet, section), joints = quantity, columns.values.shape[1]
    sign, offset, gain, per_turn = (
        sized((name, key), given, joints, section)
        for key, given in (
            ("sign", sheet.sign),
            ("offset", sheet.offset),
            ("gain", sheet.gain or [1.0]),
            ("counts_per_turn", sheet.counts_per_turn or [np.nan]),
        )
    )
    units = _units(quantity, columns)
    factor = sign * gain * _unit_factors(name, units, per_turn)
    if sheet.side == "motor" and name != "current":
        if ratio is None:
            rule = "needs 'ratio': motor turns per joint turn, or a robot whose drives state it"
            raise quantity.error("side", f"{name}.side 'motor' {rule}")
        factor = factor * ratio if name == "torque" else factor / ratio
    anew = np.where(slides & (sheet.side == "link"), np.nan, np.abs(factor) * spans(name, units, per_turn))
    return Measured(columns.values * factor + offset, columns.stamps, anew, slides)


def sized(path: tuple[str, ...], given: Sequence[float], joints: int, section: Section) -> Array:
    """One number for each joint, (n,).  Raises ModelError for another number of them.  path: of their field."""
    if len(given) not in (1, joints):
        raise section.error(path, f"{'.'.join(path)} has {len(given)} numbers: it must have {_one_or(joints)}")
    return np.broadcast_to(np.array(given, dtype=np.float64), joints)


def _one_or(joints: int) -> str:
    return "1" if joints == 1 else f"1 or {joints}"


def _channel(quantity: Mapped, wanted: str, table: Table) -> Channel:
    channel = table.find(wanted)
    if channel is None:
        raise quantity.error("channels", f"{quantity.name}: {table.missing(wanted)}")
    return channel


def _units(quantity: Mapped, columns: Columns) -> list[str]:
    """Units of each column: the mapping's, the log's, or SI.  Raises ModelError if the log states only some."""
    name, sheet, _ = quantity
    si, given = next(iter(UNITS[name])), sheet.unit or columns.units
    if len(given) not in (1, len(columns.units)):
        rule = f"it must have {_one_or(len(columns.units))}"
        raise quantity.error("unit", f"{name}.unit has {len(given)} units: {rule}")
    units = [unit or si for unit in (given * len(columns.units) if len(given) == 1 else given)]
    for unit in dict.fromkeys(units):
        check_unit(quantity, unit)
    if sheet.counts_per_turn and (counts := COUNTS.get(name)) not in units:
        rule = f"is for the unit {counts!r}" if counts else "is for encoders"
        told = f"{name}.counts_per_turn {rule}, but {name} is in {listed(dict.fromkeys(units))}"
        raise quantity.error("counts_per_turn", f"{told}; state '{name}.unit', or leave counts_per_turn out")
    stated = next((unit for unit in units if UNITS[name].get(unit) != 1.0), None)
    if stated and not sheet.unit and "" in columns.units:
        rule = f"{name}: one column states the unit {stated!r}, another states none; state '{name}.unit' in a mapping"
        raise quantity.error("unit", rule)
    return units


def _unit_factors(name: str, units: Sequence[str], per_turn: Array) -> Array:
    """Factors of the log's numbers, (n,), without a gain."""
    factors = np.array([UNITS[name].get(unit, 1.0) for unit in units])
    counted = np.array([unit == COUNTS.get(name) for unit in units]) & np.isfinite(per_turn)
    return np.where(counted, 2.0 * math.pi / per_turn, factors)


def stated_ratio(joints: Sequence[str], ratios: Mapping[str, float], mapping: ChannelMap) -> Array | None:
    """Motor turns per joint turn, (n,): the mapping's, or the robot's where it has all of the joints, or None."""
    if mapping.sheet.ratio:
        return sized(("ratio",), mapping.sheet.ratio, len(joints), mapping.section)
    return np.array([ratios[joint] for joint in joints]) if set(joints) <= set(ratios) else None

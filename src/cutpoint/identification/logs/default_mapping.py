"""Which channels are which where their names say so, as those of ROS, RTDE and our own logs do."""

import re
from collections.abc import Iterable

from cutpoint.errors import InputError
from cutpoint.identification.logs.mapping_sheet import ChannelSheet, MappingSheet
from cutpoint.identification.logs.table import Table
from cutpoint.model.places import listed

TIME = ("time", "t", "timestamp", "timestamps", "stamp", "stamps", "timesec", "times")
"""Names of times; here and below only letters count, and of a path only the end."""

NAMES = {
    "q": (
        "measuredq",
        "q",
        "actualq",
        "position",
        "positions",
        "pos",
        "jointposition",
        "jointpositions",
        "linkposition",
    ),
    "theta": ("measuredtheta", "theta", "motorposition", "motorpositions", "qmotor"),
    "v": ("measuredv", "v", "qd", "dq", "qdot", "actualqd", "velocity", "velocities", "vel", "jointvelocity"),
    "theta_dot": ("measuredthetadot", "thetadot", "motorvelocity", "motorvelocities", "dtheta", "qdmotor"),
    "torque": ("motortorque", "tau", "torque", "torques", "effort", "efforts", "actualtorque", "commandtorque"),
    "current": ("current", "currents", "motorcurrent", "motorcurrents", "actualcurrent"),
}
"""Of each quantity, the likeliest first."""


KNOWN = frozenset(name for names in NAMES.values() for name in names)


def default_mapping(table: Table) -> MappingSheet:
    """The mapping that names suggest: a matrix `q`, or columns `q1`, `q_2`, `q[3]`, `q.elbow`, all in SI.

    Raises InputError where no name suggests a position.
    """
    groups = _groups(table)
    found = {quantity: _likeliest(names, groups) for quantity, names in NAMES.items()}
    position = found["q"] or found["theta"]
    if position is None:
        there = listed(list(table.channels))
        raise InputError(f"no channel is named like a position; give a mapping.  There are: {there}", place=table.file)
    labels = [_named(name)[1] for name in position.channels]
    return MappingSheet.model_validate({"version": 1.0, "joints": labels if all(labels) else None, **found})


def time_channel(names: Iterable[str]) -> str | None:
    """The first channel that is named like a time."""
    by_letters = {_letters(name): name for name in reversed(list(names))}
    return next((by_letters[name] for name in TIME if name in by_letters), None)


def _likeliest(names: Iterable[str], groups: dict[str, list[str]]) -> ChannelSheet | None:
    name = next((name for name in names if name in groups), None)
    return ChannelSheet.model_validate({"channels": groups[name]}) if name else None


def _groups(table: Table) -> dict[str, list[str]]:
    """Channels by the known name that theirs begins or ends with: the first matrix, or all columns."""
    groups: dict[str, list[str]] = {}
    for name, channel in table.channels.items():
        if channel.width > 1 and _letters(name) in KNOWN:
            groups.setdefault(_letters(name), [name])
    matrices = frozenset(groups)
    for name, channel in table.channels.items():
        known, _ = _named(name)
        if channel.width == 1 and known in KNOWN - matrices:
            groups.setdefault(known, []).append(name)
    return groups


def _named(name: str) -> tuple[str, str]:
    """The letters of a column's name without its number or its joint, and the joint: `q1`, `q.elbow`."""
    known = _letters(re.sub(r"[\s_-]*[\[(]?\d+[\])]?$", "", name))
    stem, _, label = name.rpartition(".")
    return (known, "") if known in KNOWN else (_letters(stem), label)


def _letters(name: str) -> str:
    """Of the end of a path, in small letters."""
    return re.sub(r"[^a-z]", "", re.split(r"[./]", name)[-1].lower())

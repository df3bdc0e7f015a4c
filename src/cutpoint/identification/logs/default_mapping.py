"""Which channels are which where their names say so, as those of ROS, RTDE and our own logs do."""

import re
from collections.abc import Iterable, Mapping, Sequence

from cutpoint.errors import InputError
from cutpoint.identification.logs.mapping_sheet import MappingSheet
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

Groups = dict[str, dict[str, str]]
"""Channels by the known name that theirs has, and by what tells them apart: a joint, a number, or nothing."""


def default_mapping(table: Table, joints: Sequence[str] = ()) -> MappingSheet:
    """The mapping that names suggest, all in SI: a matrix `q`, or columns `q1`, `q_2`, `q[3]`, `q.elbow`, `elbow_pos`.

    joints: of the robot, if it is known; columns that are named after them are found by their names.
    Raises InputError where no name suggests a position, or columns of one quantity are not named as another's are.
    """
    groups = _groups(table, joints)
    likeliest = {quantity: next((name for name in names if name in groups), "") for quantity, names in NAMES.items()}
    first = likeliest["q"] or likeliest["theta"]
    if not first:
        there = listed(list(table.channels))
        raise InputError(f"no channel is named like a position; give a mapping.  There are: {there}", place=table.file)
    labels = _in_order(groups[first], joints)
    found = {
        quantity: {"channels": _channels(groups[first], groups[name], labels, table)}
        for quantity, name in likeliest.items()
        if name
    }
    named = None if _are_numbers(labels) else labels
    return MappingSheet.model_validate({"version": 1.0, "joints": named, **found})


def time_channel(names: Iterable[str]) -> str | None:
    """The first channel that is named like a time."""
    by_letters = {_letters(name): name for name in reversed(list(names))}
    return next((by_letters[name] for name in TIME if name in by_letters), None)


def _groups(table: Table, joints: Sequence[str]) -> Groups:
    """The first matrix of a known name, or all columns."""
    groups: Groups = {}
    for name, channel in table.channels.items():
        if channel.width > 1 and _letters(name) in KNOWN:
            groups.setdefault(_letters(name), {"": name})
    matrices = frozenset(groups)
    for name, channel in table.channels.items():
        known, label = _named(name, joints)
        if channel.width == 1 and known in KNOWN - matrices:
            groups.setdefault(known, {}).setdefault(label, name)
    return groups


def _in_order(group: Mapping[str, str], joints: Sequence[str]) -> list[str]:
    """The columns of a position: as the robot has its joints, by number, or as they stand in the file."""
    if joints and set(joints) <= set(group):
        return list(joints)
    return sorted(group, key=int) if all(label.isdigit() for label in group) else list(group)


def _channels(first: Mapping[str, str], group: Mapping[str, str], labels: Sequence[str], table: Table) -> list[str]:
    """A quantity's columns in the order of the position's.  Raises InputError."""
    if set(labels) <= set(group):
        return [group[label] for label in labels]
    if (_are_numbers(labels) and _are_numbers(group)) or "" in (*first, *group):
        return [group[label] for label in _in_order(group, ())]
    lacking = next(label for label in labels if label not in group)
    rule = f"none of them is named like {first[lacking]!r}; name them alike, or give a mapping"
    raise InputError(f"columns {listed(list(group.values()))}: {rule}", place=table.file)


def _are_numbers(labels: Iterable[str]) -> bool:
    """Whether columns are told apart by numbers, or need not be."""
    return all(label.isdigit() or not label for label in labels)


def _named(name: str, joints: Sequence[str]) -> tuple[str, str]:
    """The letters of a column's name without its joint or its number, and these: `q_elbow`, `q.elbow`, `q1`."""
    # longest first: `elbow_2` is not `elbow`
    for joint in sorted(joints, key=len, reverse=True):
        before, there, after = _parted(name, joint)
        rest = _letters(f"{before}{after}".strip("._-/ []()"))
        if there and rest in KNOWN:
            return rest, joint
    numbered = re.fullmatch(r"(.*?)[\s_-]*[\[(]?(\d+)[\])]?", name)
    if numbered and _letters(numbered[1]) in KNOWN:
        return _letters(numbered[1]), str(int(numbered[2]))
    if _letters(name) in KNOWN:
        return _letters(name), ""
    stem, _, label = name.rpartition(".")
    return _letters(stem), label


def _parted(name: str, joint: str) -> tuple[str, str, str]:
    """What stands before a joint's name, that name as a word of its own, and what stands after it."""
    found = re.search(rf"(?<![A-Za-z0-9]){re.escape(joint)}(?![A-Za-z0-9])", name)
    return (name[: found.start()], joint, name[found.end() :]) if found else (name, "", "")


def _letters(name: str) -> str:
    """Of the end of a path, in small letters."""
    return re.sub(r"[^a-z]", "", re.split(r"[./]", name)[-1].lower())

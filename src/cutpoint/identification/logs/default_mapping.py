"""Mapping of channels by names, as in logs of ROS, RTDE and this package."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from cutpoint.errors import InputError, listed
from cutpoint.identification.logs.channel_names import JOINT_NAMES, KNOWN, NAMES, is_wished, letters, name_and_label
from cutpoint.identification.logs.mapping_sheet import MappingSheet
from cutpoint.identification.logs.recording import EFFORTS
from cutpoint.identification.logs.table import Table


class Group(NamedTuple):
    """Channels of one known name, by their labels: a joint, a number, or none.

    twins: for channels with a similarly named one, that one.  wished: whether all are commanded, not measured.
    """

    channels: dict[str, str]
    twins: dict[str, str]
    wished: bool


def default_mapping(table: Table, joints: Sequence[str]) -> MappingSheet:
    """The mapping that names suggest, all in SI: a matrix `q`, or columns `q1`, `q_2`, `q[3]`, `q.elbow`, `elbow_pos`.

    joints: of the robot, () if it is not known; columns that are named after them are found by their names.
    Of columns with similar names, such as `desired/q1` and `actual/q1`, commanded ones are ignored.

    Raises InputError if no name suggests a position, if nothing says which of similarly named columns was measured, or
    if one quantity's columns are not named like another's.
    """
    groups = _groups(table, joints)
    likeliest = {quantity: _likeliest(names, groups) for quantity, names in NAMES.items()}
    first = likeliest["q"] or likeliest["theta"]
    if not first:
        there = f"There are: {listed(table.channels)}{table.besides}"
        there += f"; the robot's joints are {listed(joints)}" if joints else ""
        raise InputError(f"no channel has a name that means position; give a mapping.  {there}", place=table.file)
    positions = groups[first].channels
    labels = _in_order(positions, joints)
    found = {
        quantity: {"channels": _channels(quantity, positions, groups[name], labels, table)}
        for quantity, name in likeliest.items()
        if name
    }
    named = None if _are_numbers(labels) else labels
    return MappingSheet.model_validate({"version": 1.0, "joints": named, **found})


def _groups(table: Table, joints: Sequence[str]) -> dict[str, Group]:
    """The matrices, or all columns, of each known name."""
    named = _joint_names(table)
    found: dict[str, list[tuple[str, str]]] = {}
    for name, channel in table.channels.items():
        if channel.width > 1 and letters(name) in KNOWN:
            found.setdefault(letters(name), []).append(("", name))
    matrices = frozenset(found)
    for name, channel in table.channels.items():
        known, label = name_and_label(name, joints)
        if channel.width == 1 and known in KNOWN - matrices:
            found.setdefault(known, []).append((named.get(label, label), name))
    return {known: _group(columns, table, joints) for known, columns in found.items()}


def _joint_names(table: Table) -> dict[str, str]:
    """The joints that columns of text name, by number: of `name0` beside `position0`, as ROS writes its messages."""
    labels = {name: name_and_label(name, (), JOINT_NAMES) for name in table.texts}
    return {label: table.texts[name] for name, (known, label) in labels.items() if known in JOINT_NAMES}


def _group(columns: list[tuple[str, str]], table: Table, joints: Sequence[str]) -> Group:
    """One channel per label: of several, those of the robot's joints, and the measured ones."""
    rules = (lambda name: bool(set(joints) & set(table.channels[name].labels)), lambda name: not is_wished(name))
    for is_better in rules:
        better = [column for column in columns if is_better(column[1])]
        if better and len({label for label, _ in columns}) < len(columns):
            columns = better
    channels: dict[str, str] = {}
    twins = {channels[label]: name for label, name in columns if channels.setdefault(label, name) != name}
    return Group(channels, twins, all(is_wished(name) for name in channels.values()))


def _likeliest(names: Sequence[str], groups: Mapping[str, Group]) -> str:
    """The first name that occurs, measured quantities before commanded ones."""
    return min((name for name in names if name in groups), key=lambda name: groups[name].wished, default="")


def _in_order(group: Mapping[str, str], joints: Sequence[str]) -> list[str]:
    """The columns of a position: in the order of the robot's joints, of their numbers, or of the file."""
    if joints and set(joints) <= set(group):
        return list(joints)
    return sorted(group, key=int) if all(label.isdecimal() for label in group) else list(group)


def _channels(quantity: str, first: Mapping[str, str], group: Group, labels: Sequence[str], table: Table) -> list[str]:
    """A quantity's columns in the order of the position's.  Raises InputError."""
    own = group.channels
    if not set(labels) <= set(own):
        fewer = _are_numbers(labels) and set(own) <= set(labels)
        if not (fewer or "" in (*first, *own)):
            lacking = next(label for label in labels if label not in own)
            rule = f"none of them matches {first[lacking]!r}; use matching names, or give a mapping"
            if set(own) <= set(labels):
                tied = "every joint needs one: lock one that has none (--lock), or tie a mimic joint (--mimic coupled)"
                empty = "for a joint that lacks one, add a column without numbers"
                rule += f"; {tied if quantity in EFFORTS else empty}"
            raise InputError(f"columns {listed(own.values())}: {rule}{table.besides}", place=table.file)
        labels = _in_order(own, ())
    found = [own[label] for label in labels]
    twin = next((name for name in found if name in group.twins), None)
    if twin:
        rule = "nothing says which was measured on this robot; state it in a mapping"
        raise InputError(f"{twin!r} and {group.twins[twin]!r} have equivalent names: {rule}", place=table.file)
    return found


def _are_numbers(labels: Iterable[str]) -> bool:
    """Whether columns are labelled by numbers, or need no labels."""
    return all(label.isdecimal() or not label for label in labels)

"""Logs as ROS 2 bags: JointState and Float64MultiArray messages in a .db3, an .mcap, or a folder of them."""

import sqlite3
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.files import check_readable
from cutpoint.identification.logs.bag_storage import Message, stored_messages
from cutpoint.identification.logs.table import LARGEST_FILE, Channel, Table, optional, read_as

JOINT_STATE = "sensor_msgs/msg/JointState"
ARRAY = "std_msgs/msg/Float64MultiArray"

FIELDS = ("position", "velocity", "effort")

MOST_FILES = 1000


def read_bag(path: Path) -> Table:
    """`/joint_states.position`, `.velocity`, `.effort` with a column per joint, and `/topic.data` of plain arrays.

    A topic whose messages name different sets of joints has a channel for each set: `/joint_states#2.`.  Times are the
    headers', or without headers those of reception.  A folder's metadata.yaml is not read.

    Raises InputError: no bag, a bag without such messages; CutpointError if rosbags is missing.
    """
    files = _files(path)
    with read_as("ROS 2 bag", path, sqlite3.Error, MemoryError):
        messages = [each for file in files for each in stored_messages(file) if each.type in (JOINT_STATE, ARRAY)]
        channels = _channels(messages)
    if not channels:
        raise InputError(f"bag holds no {JOINT_STATE} and no {ARRAY}", place=path)
    return Table(str(path), channels)


def _files(path: Path) -> list[Path]:
    """The bag's message files, in order of their names."""
    found = [path]
    if path.is_dir():
        found = sorted(each for each in path.iterdir() if each.suffix.lower() in (".db3", ".mcap"))
    if not found:
        raise InputError("folder holds no .db3 and no .mcap; unpack the files if they end in .zstd", place=path)
    if len(found) > MOST_FILES:
        raise InputError(f"folder holds {len(found):,} bag files: at most {MOST_FILES:,} are read", place=path)
    left = LARGEST_FILE
    for file in found:
        check_readable(file, left)
        left -= file.stat().st_size
    return found


def _channels(messages: Sequence[Message]) -> dict[str, Channel]:
    series: dict[str, dict[Any, list[tuple[int, Any]]]] = {}
    for received, topic, content in _decoded(messages):
        # other joints, as from another publisher, or arrays of another length, are another series
        kind = tuple(sorted(content.name)) if hasattr(content, "name") else len(content.data)
        series.setdefault(topic, {}).setdefault(kind, []).append((received, content))
    stamped = {
        f"{topic}#{number}" if number > 1 else topic: [(_stamp(*each), each[1]) for each in found]
        for topic, kinds in series.items()
        for number, found in enumerate(kinds.values(), start=1)
    }
    start = min((stamp for found in stamped.values() for stamp, _ in found), default=0)
    channels: dict[str, Channel] = {}
    for topic, found in stamped.items():
        stamps = 1e-9 * np.array([stamp - start for stamp, _ in found], dtype=np.float64)
        channels |= _columns(topic, stamps, [content for _, content in found])
    return channels


def _decoded(messages: Sequence[Message]) -> Iterator[tuple[int, str, Any]]:
    """Time, topic and decoded message."""
    if not messages:
        return
    typesys = optional("rosbags.typesys", "a ROS 2 bag")
    # a bag's own definitions would be compiled; these two types are the same in every release
    decode = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE).deserialize_cdr
    for message in messages:
        try:
            content = decode(message.data, message.type)
        except Exception as error:  # what a decoder raises on invalid bytes is not specified
            raise ValueError(f"a message on {message.topic!r} does not match its type: {error!r}") from error
        yield message.received, message.topic, content


def _stamp(received: int, content: Any) -> int:
    """ns: the header's, if there is one and it was set."""
    stamp = content.header.stamp if hasattr(content, "header") else None
    return stamp.sec * 10**9 + stamp.nanosec if stamp and (stamp.sec or stamp.nanosec) else received


def _columns(topic: str, stamps: Array, contents: Sequence[Any]) -> dict[str, Channel]:
    """The channels of one series."""
    if not hasattr(contents[0], "name"):
        values = np.array([content.data for content in contents], dtype=np.float64)
        return {f"{topic}.data": Channel(values, stamps=stamps)} if values.size else {}
    labels = tuple(contents[0].name)
    channels: dict[str, Channel] = {}
    for field in FIELDS:
        values = np.array([_row(content, field, labels) for content in contents])
        if np.isfinite(values).any():
            channels[f"{topic}.{field}"] = Channel(values, labels, stamps=stamps)
    return channels


def _row(content: Any, field: str, labels: tuple[str, ...]) -> list[float]:
    """One message's numbers in the order of the labels, NaN if it leaves the field empty."""
    found = getattr(content, field)
    given = dict(zip(content.name, found, strict=True)) if len(found) == len(content.name) else {}
    return [float(given.get(label, np.nan)) for label in labels]

"""Contents of a log file before interpretation: named channels, with the file's own labels and units."""

import re
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import CutpointError, InputError, those_that_exist
from cutpoint.files import UNREADABLE
from cutpoint.model.stated_units import name_and_unit
from cutpoint.simulation.log.files import LARGEST_FILE

SHOWN = 4
"""Largest number of channels without numbers that a message names."""


@dataclass(frozen=True, eq=False)
class Channel:
    """One channel of a log.

    values: (N,) or (N, n), samples along the first axis, in the file's unit.
    labels: the names of its n columns, where the file has them.
    unit: as the file states it, or "".
    stamps: its own time stamps (N,), s, where the file has them; elsewhere time is a channel of its own.
    """

    values: Array
    labels: tuple[str, ...] = ()
    unit: str = ""
    stamps: Array | None = None

    def column(self, index: int) -> "Channel":
        """One column, (N,)."""
        return Channel(self.values.reshape(len(self.values), -1)[:, index], (), self.unit, self.stamps)

    @property
    def width(self) -> int:
        """Number of columns; 1 of values (N,)."""
        return 1 if self.values.ndim == 1 else self.values.shape[1]


@dataclass(frozen=True, eq=False)
class Table:
    """The channels of a log file, by name.

    left_out: other named contents, and what they hold instead of numbers: `text, such as 'idle'`.
    texts: those of them that hold the same text throughout, and that text.
    notes: what was repaired in reading, in words for a reader.
    """

    file: str
    channels: Mapping[str, Channel] = field(default_factory=dict[str, Channel])
    left_out: Mapping[str, str] = field(default_factory=dict[str, str])
    notes: tuple[str, ...] = ()
    texts: Mapping[str, str] = field(default_factory=dict[str, str])

    def __post_init__(self) -> None:
        if not self.channels:
            raise InputError(f"log holds no channel of numbers{self.besides}", place=self.file)

    def find(self, name: str) -> Channel | None:
        """The channel of a name, or a column of one: `effort.elbow` by its label, `rec.speed[2]` counted from 0."""
        if name in self.channels:
            return self.channels[name]
        stem, _, label = name.rpartition(".")
        if stem in self.channels and label in self.channels[stem].labels:
            return self.channels[stem].column(self.channels[stem].labels.index(label))
        place = re.fullmatch(r"(.+)\[(\d{1,4})\]", name)
        if place and place[1] in self.channels and int(place[2]) < self.channels[place[1]].width:
            return self.channels[place[1]].column(int(place[2]))
        bare, unit = name_and_unit(name)
        return self.find(bare) if unit else None

    def missing(self, name: str) -> str:
        """The message for a name that is not found."""
        if name in self.left_out:
            return f"the log's channel {name!r} holds {self.left_out[name]}: it must hold numbers"
        return f"the log has no channel {name!r}; {those_that_exist(name, self.channels)}{self.besides}"

    @property
    def besides(self) -> str:
        """The end of a message about a missing channel: what was left out, as it may be that."""
        found = [f"{name!r} holds {what}" for name, what in self.left_out.items()]
        return "".join(f"; {each}" for each in found[:SHOWN]) + ("; ..." if len(found) > SHOWN else "")


def channel(values: Any, unit: str = "") -> Channel | None:
    """An array of numbers as a channel, or None for anything else: a single number, texts, three axes, no samples.

    The longer axis of a matrix is taken for the samples, as no log has more joints than samples.
    """
    array = np.asarray(values)
    if array.dtype.kind not in "fiub" or array.size < 2 or array.ndim > 2:
        return None
    if array.ndim == 2 and array.shape[0] < array.shape[1]:
        array = array.T
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    return Channel(array.astype(np.float64), unit=unit)


def check_size(size: int, what: str, place: str) -> None:
    """Raises InputError for more bytes than are read."""
    if size > LARGEST_FILE:
        raise InputError(
            f"{what} of {size:,} bytes is too large: at most {LARGEST_FILE:,} are read", place=place, size=size
        )


@contextmanager
def placed(file: str) -> Generator[None, None, None]:
    """Errors in what was read from a file, "" for none, name it."""
    try:
        yield
    except InputError as error:
        if error.place or not file:
            raise
        raise InputError(str(error), place=file, **error.evidence) from error


@contextmanager
def read_as(kind: str, path: Path, *others: type[BaseException], remedy: str = "") -> Generator[None, None, None]:
    """What a library raises for a file that is not of its kind, as InputError.  others: besides UNREADABLE."""
    try:
        yield
    except InputError:
        raise
    except (*UNREADABLE, *others) as error:
        raise InputError(f"file is not a readable {kind}: {error}{remedy}", place=path) from error


def optional(module: str, kind: str) -> Any:
    """A module of the extra `logs`.  Raises CutpointError, with the command that installs it, where it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise CutpointError(f"{kind} needs {package}: pip install 'cutpoint[logs]'", module=module) from error

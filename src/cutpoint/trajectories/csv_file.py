"""A motion from a CSV file: its first line names the time and the joints, every other line is one sample."""

import csv
import math
import re
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cutpoint.door import LARGEST, checked_names, path_of
from cutpoint.errors import InputError, listed, those_that_exist, unknown_name
from cutpoint.files import check_readable
from cutpoint.model.stated_units import ANGLES, LENGTHS, TIMES, name_and_unit
from cutpoint.model.validation import DEGREES_BEYOND
from cutpoint.trajectories.csv_rows import check_width, rows_of
from cutpoint.trajectories.samples import Smoothed, from_samples

LARGEST_FILE = 200_000_000
"""Bytes: more than an hour of seven joints at 1 kHz."""

MOST_COLUMNS = 1000

EXAMPLE = "as in 't, shoulder, elbow'"
"""Of a first line."""


class Column(NamedTuple):
    """A column of positions as the first line names it.  slides: whether its joint does, None if that is not known."""

    name: str
    unit: str
    slides: bool | None = None

    @property
    def known(self) -> list[str]:
        """The units that suit its joint."""
        return [unit for unit in ANGLES if self.slides is None or (unit in LENGTHS) == self.slides]


def from_csv(
    path: str | Path,
    joints: Sequence[str] | None = None,
    *,
    bandwidth: float | None = None,
    at_rest: bool = True,
    sliding: Collection[str] | None = None,
) -> Smoothed:
    """A smooth motion near the samples of a CSV file; see `from_samples` for the smoothing and what it warns of.

    The first line is `t, shoulder, elbow`, or with units `t [s], shoulder [deg], elbow [rad], lift [mm]`; a column
    without one is in rad (m).  Of a log, a .csv of `Log.save`, the motion is its `reference_q`, or else its `q`.

    Args:
        path: UTF-8, separated by commas, or by semicolons or tabs, with a decimal point or comma.
        joints: the columns wanted, in the order wanted, others may hold anything; by default all in the file's order.
        sliding: names of prismatic joints, such as robot.mechanism.sliding; if given, units are checked against it.

    Raises:
        InputError: what `from_samples` refuses, an invalid header, an unknown unit or joint, an angle for a prismatic
            joint or a length for a revolute one, a line of another length, a cell that is not a number, or positions
            above two turns in a column without a unit.
    """
    path = path_of("from_csv", path)
    check_readable(path, LARGEST_FILE)
    asked = None if joints is None else checked_names("from_csv", joints)
    if asked and len({*asked}) < len(asked):
        raise InputError(f"from_csv: joints {listed(asked)} must differ from each other", joints=asked)
    try:
        with path.open(encoding="utf-8-sig", newline="") as lines:
            names, rows = _read(lines, path, sliding, asked)
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"file is not comma-separated UTF-8 text: {error}", place=path) from error
    data = np.array(rows, dtype=np.float64).reshape(-1, 1 + len(names))
    try:
        return from_samples(data[:, 0], data[:, 1:], bandwidth=bandwidth, at_rest=at_rest, joints=names)
    except InputError as error:
        raise InputError(str(error), place=path, **error.evidence) from error


def _read(
    lines: Iterator[str], path: Path, sliding: Collection[str] | None, asked: Sequence[str] | None
) -> tuple[list[str], list[list[float]]]:
    """The joints' names, and rows of time and their positions in rad (m).  asked: the joints wanted; None for all."""
    table = rows_of(lines, path)
    head, titles = next(table, (f"{path}:1", list[str]()))
    second, columns = _header(titles, head)
    names = [column.name for column in columns[1:]]
    if missing := [name for name in asked or () if name not in names]:
        told = f"no column is named {listed(missing)}; {those_that_exist(missing[0], names)}"
        rule = "name the missing, or lock joints that stand still (lock= of load, --lock)"
        raise InputError(f"{told}; {rule}", name=missing[0], known=names, place=path)
    taken = [1 + names.index(name) for name in asked] if asked is not None else range(1, len(columns))
    wanted = [(k, _checked(k, columns, sliding, head)) for k in taken]
    rows: list[list[float]] = []
    for place, cells in table:
        check_width(cells, len(columns), place)
        time = second * _number(cells[0], "time", place)
        if abs(time) > LARGEST:
            rule = f"it must be within {LARGEST:g} s; name its unit in the first line, as in 't [ns]'"
            raise InputError(f"time is {time:g} s: {rule}", place=place)
        if rows and time <= rows[-1][0]:
            raise InputError(f"time {time} s must be later than {rows[-1][0]} s, the one before it", place=place)
        rows.append([time, *(_position(cells[k], column, place) for k, column in wanted)])
    return [column.name for _, column in wanted], rows


def _header(cells: list[str], place: str) -> tuple[float, list[Column]]:
    """The unit of time, s, and all columns."""
    if len(cells) == 1 and "|" in cells[0]:
        told = f"first line {cells[0][:200]!r} separates columns with '|': use commas, {EXAMPLE}"
        raise InputError(told, place=place)
    columns = [Column(*name_and_unit(cell.strip())) for cell in cells[:MOST_COLUMNS]] or [Column("", "")]
    time = columns[0]
    _check_brackets(time.name, place)
    if not 2 <= len(cells) <= MOST_COLUMNS or time.name.lower() not in ("t", "time"):
        shown = ", ".join(cells[:8])
        raise InputError(
            f"first line {shown[:200]!r} must name the columns, {EXAMPLE}: time first, then joints", place=place
        )
    unit = time.unit or "s"
    if unit not in TIMES:
        raise InputError(f"time is in {unit!r}: it must be in {', '.join(map(repr, TIMES))}", place=place)
    return TIMES[unit], columns


def _checked(index: int, columns: list[Column], sliding: Collection[str] | None, place: str) -> Column:
    """The column of a joint, with whether that slides if it is told which do."""
    column = columns[index]
    _check_brackets(column.name, place)
    if not column.name or [other.name for other in columns].count(column.name) > 1:
        raise InputError(f"column {column.name!r} must have its own name", place=place)
    if column.unit and column.unit not in ANGLES:
        raise unknown_name(f"unit of joint {column.name!r}", column.unit, ANGLES, place=place)
    return column if sliding is None else _held_against(column, sliding, place)


def _held_against(column: Column, sliding: Collection[str], place: str) -> Column:
    """The column with whether its joint slides.  Raises InputError if its unit does not suit that."""
    column = column._replace(slides=column.name in sliding)
    if column.unit and column.unit not in column.known:
        way, units = ("slides" if column.slides else "turns"), ", ".join(map(repr, column.known))
        told = f"joint {column.name!r} is in {column.unit!r}: it {way}, so its unit must be one of {units}"
        raise InputError(told, place=place, joint=column.name)
    return column


def _check_brackets(name: str, place: str) -> None:
    if re.search(r"[][]", name):
        raise InputError(f"column {name!r} must be a name, or a name and its unit, as in 'elbow [deg]'", place=place)


def _position(cell: str, column: Column, place: str) -> float:
    name = column.name
    value = _number(cell, f"position of joint {name!r}", place)
    if not column.unit and abs(value) > DEGREES_BEYOND:
        kind, *units = ("millimetres", "mm", "m") if column.slides else ("degrees", "deg", "rad")
        choices = " or ".join(repr(f"{name} [{unit}]") for unit in units)
        told = f"joint {name!r}: position {value} looks like {kind}; name the unit in the first line, {choices}"
        raise InputError(told, place=place, joint=name)
    return value * ANGLES[column.unit or "rad"]


def _number(cell: str, name: str, place: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} is {cell.strip()!r}: it must be a finite number", place=place, cell=cell)
    return value

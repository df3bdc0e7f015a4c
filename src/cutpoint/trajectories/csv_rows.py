"""Lines of a CSV file as cells, in the dialects of spreadsheets; of a log that `Log.save` wrote, those of a motion."""

import csv
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path

from cutpoint.errors import InputError, counted
from cutpoint.files import delimiter_of

Row = tuple[str, list[str]]
"""A line's place, for messages, and its cells."""

OWN_LOG = '# {"cutpoint_log"'
"""The start of our own logs, whose second line names the columns, as `q.elbow [rad]`."""

MOTIONS = ("reference_q", "q")
"""Channels of a log that are a motion; the first that is there is taken."""


def rows_of(lines: Iterator[str], path: Path) -> Iterator[Row]:
    """The line that names the columns, then every line that is not empty.

    If cells are separated by something other than commas, a comma may be the decimal point.
    """
    first = next(lines, "")
    is_log = first.startswith(OWN_LOG)
    mark = "," if is_log else delimiter_of(first).replace(" ", ",")
    reader = csv.reader(chain([first], lines), delimiter=mark)
    rows = ((f"{path}:{reader.line_num}", cells) for cells in reader if len(cells) > 1 or "".join(cells).strip())
    if is_log:
        return _motion_of_log(rows, path)
    return rows if mark == "," else _with_points(rows)


def _with_points(rows: Iterator[Row]) -> Iterator[Row]:
    yield from islice(rows, 1)
    for place, cells in rows:
        yield place, [cell.replace(",", ".") for cell in cells]


def check_width(cells: list[str], width: int, place: str) -> None:
    """Raises InputError for a line of another length than that of the names."""
    if len(cells) != width:
        rule = f"it must have {width}, as the line of names"
        raise InputError(f"line has {counted(len(cells), 'cell')}: {rule}", place=place)


def _motion_of_log(rows: Iterator[Row], path: Path) -> Iterator[Row]:
    """The same without the first line, and without columns of other channels."""
    next(rows)
    place, titles = next(rows, (f"{path}:2", list[str]()))
    found = {name: [k for k, x in enumerate(titles) if x.startswith(f"{name}.")] for name in MOTIONS}
    channel = next((name for name in MOTIONS if found[name]), None)
    if channel is None:
        told = f"this is a cutpoint log without a motion: it has neither {' nor '.join(MOTIONS)}"
        raise InputError(f"{told}; save one with such a channel", place=place)
    yield place, ["t [s]", *(titles[k].removeprefix(f"{channel}.") for k in found[channel])]
    for place, cells in rows:
        check_width(cells, len(titles), place)
        yield place, [cells[0], *(cells[k] for k in found[channel])]

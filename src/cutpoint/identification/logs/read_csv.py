"""Logs as text: a line that names the columns, with units if it likes (`q1 [deg]`), then a line for each sample."""

import csv
import math
import re
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import numpy as np

from cutpoint.errors import InputError
from cutpoint.files import check_readable
from cutpoint.identification.logs.table import Channel, Table

LARGEST_TEXT = 200_000_000
"""Bytes: more than an hour of seven joints at 1 kHz."""

LONGEST_LINE = 100_000
"""Characters of the line that names the columns."""

COMMENTS = ("#", "%")

UNKNOWN = ("", "nan", "null", "none", "na", "n/a")
"""Cells in which a logger says that it has no number."""


def read_csv(path: Path) -> Table:
    """Columns of numbers, by the names in the first line that is no comment; columns of texts are left out.

    Cells are divided by semicolons, tabs, commas or blanks, by the first of them that the first line holds.  Where it
    is another than the comma, a comma may be the decimal point.  An empty cell is NaN.

    Raises InputError, with the line: a first line without names, a name twice, a line of another length, a word among
    numbers.
    """
    check_readable(path, LARGEST_TEXT)
    try:
        with path.open(encoding="utf-8-sig", newline="") as text:
            return _read(text, path)
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"file is not UTF-8 text in columns: {error}", place=path) from error


def _read(text: TextIO, path: Path) -> Table:
    line, first = 1, text.readline(LONGEST_LINE)
    while first.startswith(COMMENTS) or first.isspace():
        line, first = line + 1, text.readline(LONGEST_LINE)
    delimiter = next((mark for mark in ";\t," if mark in first), " ")
    names, units = _header(_cells(next(csv.reader([first], delimiter=delimiter), []), delimiter), f"{path}:{line}")
    numbers, texts = array("d"), set[int]()
    for place, row in _rows(text, delimiter, path, line):
        if len(row) != len(names):
            raise InputError(f"{len(row)} cells must be {len(names)}, as in the line of names", place=place)
        values = [_number(cell, delimiter) for cell in row]
        if None in values:
            _check_words(row, values, names, texts, is_first=not numbers, place=place)
        numbers.extend(math.nan if value is None else value for value in values)
    table = np.array(numbers).reshape(-1, len(names))
    if len(table) < 2:
        raise InputError(f"file holds {len(table)} samples below the line of names: at least 2 are needed", place=path)
    return Table(str(path), {n: Channel(table[:, k], (), units[k]) for k, n in enumerate(names) if k not in texts})


def _rows(text: TextIO, delimiter: str, path: Path, before: int) -> Iterator[tuple[str, list[str]]]:
    """The place and the cells of each line that is neither empty nor a comment."""
    reader = csv.reader(text, delimiter=delimiter)
    for row in reader:
        cells = _cells(row, delimiter)
        if any(cells) and not cells[0].startswith(COMMENTS):
            yield f"{path}:{before + reader.line_num}", cells


def _cells(row: list[str], delimiter: str) -> list[str]:
    """Without the blanks around them; between blanks, any number of which divides, nothing is no cell."""
    cells = [cell.strip() for cell in row]
    return [cell for cell in cells if cell] if delimiter == " " else cells


def _header(titles: list[str], place: str) -> tuple[list[str], list[str]]:
    """Names and units of the columns; one without a name, as pandas writes its index, is called by its place."""
    if not any(titles) or all(_number(title, " ") is not None for title in titles):
        shown = ", ".join(titles[:8])
        raise InputError(f"first line '{shown}' must name the columns, as in 't, q1, q2, tau1, tau2'", place=place)
    found = [re.fullmatch(r"(.*?)\s*(?:\[([^\[\]\d]*)\])?", title) for title in titles]
    names = [match[1] if match and match[1] else f"column {k}" for k, match in enumerate(found)]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"column {name!r} is named twice: each must have a name of its own", place=place)
    return names, [(match and match[2]) or "" for match in found]


def _number(cell: str, delimiter: str) -> float | None:
    """The number in a cell, NaN for one that says it has none, None for a word."""
    if cell.lower() in UNKNOWN:
        return math.nan
    try:
        return float(cell if delimiter == "," else cell.replace(",", "."))
    except ValueError:
        return None


def _check_words(
    row: list[str], values: list[float | None], names: list[str], texts: set[int], is_first: bool, place: str
) -> None:
    """A word in the first row makes its column one of texts.  Raises InputError for a word in another column."""
    words = {k for k, value in enumerate(values) if value is None}
    if is_first:
        texts |= words
    for k in sorted(words - texts):
        raise InputError(f"column {names[k]!r} holds {row[k][:40]!r} among numbers", place=place, column=names[k])

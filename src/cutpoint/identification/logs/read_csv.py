"""Logs as text: a line that names the columns, optionally with units (`q1 [deg]`), then one line per sample."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from cutpoint.errors import InputError, counted
from cutpoint.files import check_readable
from cutpoint.identification.logs.csv_cells import Cells, split
from cutpoint.identification.logs.csv_header import COMMENTS, Header, read_header, units_below
from cutpoint.identification.logs.table import Table

LARGEST_TEXT = 200_000_000
"""Bytes: more than an hour of seven joints at 1 kHz."""


def read_csv(path: Path) -> Table:
    """Columns of numbers, by the names in the first line that is no comment; columns of texts are left out.

    If cells are separated by something other than commas, a comma may be the decimal point.  An empty cell is NaN, and
    so is a word in a column of numbers, with a note.  Date-times become seconds since the first of them.  A line below
    the names may hold the columns' units.  A last line that was cut off is left out, with a note.

    Raises InputError, with the line: a first line without names, a repeated name, a line of another length, words
    below the names that are not units; a text that is not UTF-8.
    """
    check_readable(path, LARGEST_TEXT, "save it as .npz or .parquet, which are smaller, or split it into several logs")
    try:
        with path.open(encoding="utf-8-sig", newline="") as text:
            return _read(text, path)
    except UnicodeDecodeError as error:
        rule = "file is not UTF-8 text, but UTF-16, Latin-1 or not text at all"
        raise InputError(f"{rule}: save it as UTF-8, in Excel as 'CSV UTF-8'", place=path) from error
    except csv.Error as error:
        raise InputError(f"file is not UTF-8 text in columns: {error}", place=path) from error


def _read(text: TextIO, path: Path) -> Table:
    header = read_header(text, str(path))
    cells, units, cut_off = Cells(len(header.names), header.delimiter), header.units, None
    for count, (line, row) in enumerate(_rows(header)):
        if cut_off or len(row) > cells.width:
            line, found = cut_off or (line, len(row))
            rule = f"line has {counted(found, 'cell')}: it must have {cells.width}, as the line of names"
            rule += "" if cells.count else f"; {header.remedy}"
            if not cells.count and found > cells.width and header.delimiter == ",":
                rule += "; if commas are decimal points here, save the log with semicolons between cells"
            raise InputError(rule, place=f"{path}:{line}")
        if len(row) < cells.width:
            cut_off = line, len(row)
            continue
        below = None if count else units_below(row, header, f"{path}:{line}")
        if below:
            units = [under or beside for under, beside in zip(below, units, strict=True)]
        else:
            cells.add(row)
    if cells.count < 2:
        rule = f"file holds {counted(cells.count, 'sample')} below the line of names: at least 2 are needed"
        raise InputError(rule, place=path)
    notes: list[str] = []
    if cut_off:
        line, found = cut_off
        notes.append(f"line {line}, the last, was cut off after {found} of {cells.width} cells and is left out")
    return cells.table(str(path), header.names, units, notes)


def _rows(header: Header) -> Iterator[tuple[int, list[str]]]:
    """The number and the cells of each line that is neither empty nor a comment."""
    reader = csv.reader(header.rest, delimiter=header.delimiter)
    for row in reader:
        cells = split(row, header.delimiter)
        if any(cells) and not cells[0].startswith(COMMENTS):
            yield header.line + reader.line_num, cells

"""The header of a text: the delimiter, and the names and units of its columns."""

import csv
import re
from collections import Counter
from collections.abc import Iterator
from itertools import chain
from math import isfinite
from typing import NamedTuple, TextIO

from cutpoint.errors import InputError
from cutpoint.files import delimiter_of
from cutpoint.identification.logs.csv_cells import is_word, number, split
from cutpoint.model.stated_units import known_unit, name_and_unit

LONGEST_LINE = 100_000
"""Largest length, in characters, of the line that names the columns."""

COMMENTS = ("#", "%", "//")

NO_UNIT = ("", "-", "1")
"""Cells for a column without a unit in a line of units."""


class Header(NamedTuple):
    """names, units: of the columns.  delimiter: between cells.  line: the number of the last line before `rest`."""

    names: list[str]
    units: list[str]
    delimiter: str
    line: int
    rest: Iterator[str]

    @property
    def remedy(self) -> str:
        """The end of a message about a line that does not fit the names, which may be something else."""
        names = ", ".join(self.names[:8])[:200]
        return f"line {self.line} was taken as the names: '{names}'; if they stand farther down, remove the lines above"


def read_header(text: TextIO, file: str) -> Header:
    """The line of names: the first that is no comment, or a comment right above a sample of as many cells.

    Excel's `sep=;` before it states the delimiter.  Otherwise it is the first of semicolon, tab, comma and blanks that
    the line contains.

    Raises InputError: a first line without names, a repeated name, a text that is not UTF-8.
    """
    line, first, comment = 1, _line(text, file, 1), ""
    stated = re.fullmatch(r'"?sep=([^\r\n])"?\s*', first)
    if stated:
        line, first = 2, _line(text, file, 2)
    while first.startswith(COMMENTS) or first.isspace():
        comment = first if first.strip() else comment
        line, first = line + 1, _line(text, file, line + 1)
    if not first:
        raise InputError("file holds no line that names the columns: it is empty, or all comments", place=file)
    if "\0" in first:
        raise InputError(f"file is not UTF-8 text: line {line} holds zero bytes; save it as UTF-8", place=file)
    delimiter = stated[1] if stated else delimiter_of(first)
    titles, words = _cells(first, delimiter), comment.strip("#%/ \r\n")
    above = _cells(words, stated[1] if stated else delimiter_of(comment))
    if _has_numbers(titles) and len(above) == len(titles) and not _are_numbers(above):
        return Header(*_named(above, f"{file}:{line - 1}"), delimiter, line - 1, chain([first], text))
    return Header(*_named(titles, f"{file}:{line}"), delimiter, line, text)


def _line(text: TextIO, file: str, number: int) -> str:
    """The next line.  Raises InputError for one too long to name columns."""
    found = text.readline(LONGEST_LINE)
    if len(found) == LONGEST_LINE and not found.endswith("\n"):
        raise InputError(f"line {number} is longer than {LONGEST_LINE:,} characters: shorten it", place=file)
    return found


def units_below(cells: list[str], header: Header, place: str) -> list[str] | None:
    """The columns' units, if the line below the names states them; None if it is a sample.

    Raises InputError for a line of words that are not all units.
    """
    stated = [cell for cell in cells if cell not in NO_UNIT]
    # only dashes: missing samples
    are_words = all(is_word(cell, header.delimiter) for cell in stated)
    if not any(re.search(r"[^\W\d_]|[°%]", cell) for cell in stated) or not are_words:
        return None
    units = ["" if cell in NO_UNIT else known_unit(cell) for cell in cells]
    if None in units:
        shown, wrong = ", ".join(cells[:8])[:200], cells[units.index(None)][:40]
        rule = f"it must hold numbers, or the columns' units, and {wrong!r} is neither; remove or correct it"
        raise InputError(f"the line below the names holds {shown!r}: {rule}; {header.remedy}", place=place)
    return [unit or "" for unit in units]


def _cells(line: str, delimiter: str) -> list[str]:
    return split(next(csv.reader([line], delimiter=delimiter), []), delimiter)


def _are_numbers(titles: list[str]) -> bool:
    return not any(titles) or all(number(title, " ") is not None for title in titles)


def _has_numbers(titles: list[str]) -> bool:
    """Whether a line may be a sample, which may also hold words, such as a frame's name."""
    found = [number(title, " ") for title in titles]
    return _are_numbers(titles) or any(each is not None and isfinite(each) for each in found)


def _named(titles: list[str], place: str) -> tuple[list[str], list[str]]:
    """Names and units of the columns; an unnamed one, such as pandas' index, is named by its position."""
    if _are_numbers(titles):
        shown = ", ".join(titles[:8])
        raise InputError(f"first line '{shown}' must name the columns, as in 't, q1, q2, tau1, tau2'", place=place)
    found = [name_and_unit(title) for title in titles]
    names = [name or f"column {k}" for k, (name, _) in enumerate(found)]
    for name, times in Counter(names).items():
        if times > 1:
            raise InputError(f"column {name!r} occurs twice: each name must be unique", place=place)
    return names, [unit for _, unit in found]

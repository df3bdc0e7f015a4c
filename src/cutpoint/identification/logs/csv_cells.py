"""The cells of a text: numbers, date-times, words, and markers of missing values."""

import math
import re
from array import array
from collections import Counter

import numpy as np

from cutpoint.errors import counted
from cutpoint.identification.logs.table import Channel, Table

UNKNOWN = ("", "nan", "null", "none", "na", "n/a")
"""Cells that mark a missing number."""

LONGEST_TEXT = 40
"""Largest length, in characters, of a text that is kept."""

DATE_TIME = re.compile(r"(\d{4}-\d\d-\d\d)[T ](\d\d:\d\d(?::\d\d(?:[.,]\d{1,9})?)?) ?(?:Z|UTC|([+-]\d\d):?(\d\d))?")
"""ISO 8601 as pandas and most loggers write it."""


def split(row: list[str], delimiter: str) -> list[str]:
    """Cells without surrounding blanks; blanks as delimiter, any number of them, leave no empty cells."""
    cells = [cell.strip() for cell in row]
    return [cell for cell in cells if cell] if delimiter == " " else cells


def number(cell: str, delimiter: str) -> float | None:
    """The number in a cell, NaN for a marker of a missing one, None for a word."""
    if cell.lower() in UNKNOWN:
        return math.nan
    if "_" in cell:  # Python's own syntax, which no logger writes
        return None
    try:
        return float(cell if delimiter == "," else cell.replace(",", "."))
    except ValueError:
        return None


def nanoseconds(cell: str) -> int | None:
    """Nanoseconds of a date-time since 1970 (UTC if it states its zone), or None for anything else."""
    found = DATE_TIME.fullmatch(cell)
    if not found:
        return None
    try:
        instant = np.datetime64(f"{found[1]}T{found[2].replace(',', '.')}", "ns").astype(np.int64)
    except ValueError:
        return None
    zone = 60 * int(found[3]) + int(found[3][0] + found[4]) if found[3] else 0
    return int(instant) - zone * 60 * 10**9


def is_word(cell: str, delimiter: str) -> bool:
    """Whether a cell is neither a number nor a date-time, nor empty."""
    return number(cell, delimiter) is None and nanoseconds(cell) is None


class Cells:
    """The cells of samples as numbers, NaN for a word; date-times in s since the first of their column."""

    def __init__(self, width: int, delimiter: str) -> None:
        self.width, self.delimiter = width, delimiter
        self.numbers = array("d")
        self.starts: dict[int, int] = {}
        self.words: Counter[int] = Counter()
        self.examples: dict[int, str] = {}
        self.varying: set[int] = set()

    def add(self, row: list[str]) -> None:
        for k, cell in enumerate(row):
            value = number(cell, self.delimiter)
            self.numbers.append(self._word(k, cell) if value is None else value)

    def _word(self, k: int, cell: str) -> float:
        instant = nanoseconds(cell)
        if instant is not None:
            return 1e-9 * (instant - self.starts.setdefault(k, instant))
        self.words[k] += 1
        if self.examples.setdefault(k, cell[:LONGEST_TEXT]) != cell:
            self.varying.add(k)
        return math.nan

    @property
    def count(self) -> int:
        """Number of samples."""
        return len(self.numbers) // self.width

    def table(self, file: str, names: list[str], units: list[str], notes: list[str]) -> Table:
        """Columns of numbers; columns of words are left out, and single words among numbers are missing samples."""
        table = np.array(self.numbers).reshape(-1, self.width)
        channels: dict[str, Channel] = {}
        left_out: dict[str, str] = {}
        texts: dict[str, str] = {}
        for k, name in enumerate(names):
            count, example = self.words[k], self.examples.get(k)
            if count >= max(1, np.isfinite(table[:, k]).sum()):
                left_out[name] = f"text, such as {example!r}"
                if example and count == self.count and k not in self.varying:
                    texts[name] = example
                continue
            channels[name] = Channel(table[:, k], (), "s" if k in self.starts else units[k])
            if count:
                cells = f"text in {count} of {counted(self.count, 'cell')}, such as {example!r}"
                notes.append(f"column {name!r}: {cells}, counts as missing")
        return Table(file, channels, left_out, tuple(notes), texts)

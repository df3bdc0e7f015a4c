"""Tables as wide as the terminal, with words and numbers whole where there is room for them."""

from collections.abc import Iterator

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Column, Table
from rich.text import Text

WIDEST = 10_000
"""Columns, more than any table has."""


def print_table(table: Table, console: Console) -> None:
    """Prints a table with its columns narrowed until it fits; as a list, where words would have to be broken."""
    if _narrowed(table, console):
        console.print(table)
    else:
        console.print(*_listed(table), sep="\n")


def natural_width(table: Table, console: Console) -> int:
    """Width at which no line is broken."""
    return Measurement.get(console, console.options.update_width(WIDEST), table).maximum


def _narrowed(table: Table, console: Console) -> bool:
    """Narrows the widest columns of a table, which loses its frame first; whether it then fits with its words whole."""
    sizes = [_size(column, console) for column in table.columns]
    widths, spare = [size.maximum for size in sizes], sum(size.span for size in sizes)
    if _excess(table, console) > spare:
        table.box, table.show_edge, table.pad_edge, table.padding = SIMPLE_HEAD, False, False, (0, 1, 0, 0)
    excess = _excess(table, console)
    if excess > spare:
        return False
    for _ in range(excess):
        loose = [width if width > size.minimum else 0 for width, size in zip(widths, sizes, strict=True)]
        widths[loose.index(max(loose))] -= 1
    for column, width in zip(table.columns, widths, strict=True):
        column.width = width
    return True


def _listed(table: Table) -> Iterator[Padding | Text]:
    """The title, each row under its first cell, and the caption."""
    if table.title:
        yield Text(str(table.title), style="bold")
    names = [_in_line(column.header) for column in table.columns]
    for first, *others in zip(*(column.cells for column in table.columns), strict=True):
        yield Text(_in_line(first))
        for name, cell in zip(names[1:], others, strict=True):
            yield Padding(Text(f"{name}: {_in_line(cell)}"), (0, 0, 0, 2))
    if table.caption:
        yield Text(str(table.caption))


def _in_line(cell: object) -> str:
    return " ".join(str(cell).split())


def _excess(table: Table, console: Console) -> int:
    return natural_width(table, console) - console.width


def _size(column: Column, console: Console) -> Measurement:
    """Lengths of a column's longest word and its longest line; in some columns a line counts as a word."""
    sizes = [Measurement.get(console, console.options.update_width(WIDEST), x) for x in (column.header, *column.cells)]
    longest = max(size.maximum for size in sizes)
    return Measurement(longest if column.no_wrap else max(size.minimum for size in sizes), longest)

"""Tables as wide as the terminal, with words and numbers whole where there is room for them."""

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.measure import Measurement
from rich.table import Column, Table

WIDEST = 10_000
"""Columns, more than any table has."""


def print_table(table: Table, console: Console) -> None:
    """Prints a table with its columns narrowed until it fits."""
    narrow(table, console)
    console.print(table)


def natural_width(table: Table, console: Console) -> int:
    """Width at which no line is broken."""
    return Measurement.get(console, console.options.update_width(WIDEST), table).maximum


def narrow(table: Table, console: Console) -> None:
    """Narrows the widest columns of a table, which loses its frame before any word is broken."""
    sizes = [_size(column, console) for column in table.columns]
    widths = [size.maximum for size in sizes]
    if _excess(table, console) > sum(size.span for size in sizes):
        table.box, table.show_edge, table.pad_edge, table.padding = SIMPLE_HEAD, False, False, (0, 1, 0, 0)
    for _ in range(min(_excess(table, console), sum(widths) - len(widths))):
        spare = [width if width > size.minimum else 0 for width, size in zip(widths, sizes, strict=True)]
        widest = spare if any(spare) else widths
        widths[widest.index(max(widest))] -= 1
    for column, width, size in zip(table.columns, widths, sizes, strict=True):
        # a line that is kept whole where there is no room for it would lose its end
        column.width, column.no_wrap = width, column.no_wrap and width >= size.minimum


def _excess(table: Table, console: Console) -> int:
    return natural_width(table, console) - console.width


def _size(column: Column, console: Console) -> Measurement:
    """Lengths of a column's longest word and its longest line; in some columns a line counts as a word."""
    sizes = [Measurement.get(console, console.options.update_width(WIDEST), x) for x in (column.header, *column.cells)]
    longest = max(size.maximum for size in sizes)
    return Measurement(longest if column.no_wrap else max(size.minimum for size in sizes), longest)

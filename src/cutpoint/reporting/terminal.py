"""Tables and prose of a report in a terminal."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from cutpoint.reporting.page import Page, Table, plain

_NARROWEST = 108
"""Columns; on a narrower terminal lines wrap, and no number is cut."""


def show(pages: Sequence[Page]) -> None:
    console = Console(width=max(Console().width, _NARROWEST))
    for page in pages:
        for table in page.tables():
            console.print(_rich(table))


def say(page: Page) -> None:
    """A page's paragraphs under its title."""
    console = Console(width=min(Console().width, _NARROWEST))
    console.print(Text(plain(page.title), style="bold"))
    for block in page.blocks:
        if isinstance(block, str):
            console.print(Text(plain(block)), "")


def _rich(table: Table) -> RichTable:
    title = Text(plain(f"{table.label}. {table.caption}"))
    shown = RichTable(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False)
    for k, name in enumerate(table.columns):
        widest = max(len(plain(cells[k])) for cells in table.rows)
        shown.add_column(Text(plain(name)), justify="left" if k == 0 else "right", min_width=widest if k else None)
    for k, cells in enumerate(table.rows):
        shown.add_row(*(Text(plain(cell)) for cell in cells), style="yellow" if k in table.printed else None)
    return shown

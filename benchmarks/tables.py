"""Tables of a document in Markdown: times, ratios, and what is said of rows that miss their target."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

Times = Mapping[str, Mapping[str, float]]
"""By contender, median and least, ns."""

NONE = "–"


class Row(NamedTuple):
    """names: its first cells, which say what it is of."""

    names: Sequence[str]
    cells: Sequence[str]


def table(head: str, rows: Sequence[Row]) -> str:
    """head: titles with bars between."""
    titles = [title.strip() for title in head.split("|")]
    lines = [f"| {' | '.join(titles)} |", f"|{'-|' * len(titles)}"]
    lines += [f"| {' | '.join([*row.names, *row.cells])} |" for row in rows]
    return "\n".join(lines) + "\n"


def cells(times: Times, names: Sequence[str]) -> list[str]:
    """Median and least of each."""
    return [f"{plain(times[x]['median'])} ({plain(times[x]['least'])})" if x in times else NONE for x in names]


def plain(x: float) -> str:
    """Three digits or so."""
    return f"{x:.0f}" if x >= 100 else f"{x:.1f}" if x >= 10 else f"{x:.2f}"


def times_as_quick(times: Times, ours: str, peers: Sequence[str]) -> float | None:
    """The quickest peer's time over ours, by what was least."""
    found = [times[name]["least"] for name in peers if name in times]
    return min(found) / times[ours]["least"] if found and ours in times else None


def ratio(x: float | None) -> str:
    return NONE if x is None else f"{x:.2g}" if x < 10 else f"{x:.0f}"


def share(x: float) -> str:
    return f"{100 * x:.0f} %"

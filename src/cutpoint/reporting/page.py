"""Parts of a report page: prose, tables and pictures, and the numbers behind them."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Table:
    """Rows of text under column heads; `printed` are the indices of rows that the paper prints."""

    label: str
    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    printed: tuple[int, ...] = ()

    @property
    def key(self) -> str:
        return _key(self.label)


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure with its caption."""

    label: str
    caption: str
    figure: Figure

    @property
    def key(self) -> str:
        return _key(self.label)


Block = str | Table | Picture
"""A paragraph, a table or a picture.  In text, _{x} is a subscript, ^{x} a superscript and `x` code."""


@dataclass(frozen=True, eq=False)
class Page:
    """A section of the report; results go to the JSON file under their table's or figure's key."""

    key: str
    title: str
    blocks: tuple[Block, ...]
    results: Mapping[str, Mapping[str, Any]] = field(default_factory=dict[str, Mapping[str, Any]])

    def pictures(self) -> list[Picture]:
        return [block for block in self.blocks if isinstance(block, Picture)]

    def tables(self) -> list[Table]:
        return [block for block in self.blocks if isinstance(block, Table)]


def row(name: str, values: ArrayLike, digits: int) -> tuple[str, ...]:
    """A name and numbers with this many decimals; a nonzero number that would read as zero gets two digits."""
    return (name, *(number(x, digits) for x in np.ravel(values)))


def number(x: float, digits: int) -> str:
    if x != 0 and abs(x) < 0.5 * 10.0**-digits:
        mantissa, exponent = f"{x:.1e}".split("e")
        return f"{mantissa}·10^{{{int(exponent)}}}".replace("-", "−")
    return f"{x:.{digits}f}".replace("-", "−")


def plain(text: str) -> str:
    """Text without marks, for output without subscripts and superscripts."""
    text = re.sub(r"·10\^\{([^}]*)\}", r"e\1", text)
    return re.sub(r"\^\{([^}]*)\}", r"^\1", re.sub(r"_\{([^}]*)\}", r"\1", text))


def listed(values: Iterable[float], digits: int = 1) -> str:
    return ", ".join(number(x, digits) for x in values)


def _key(label: str) -> str:
    return label.lower().replace(" ", "_")

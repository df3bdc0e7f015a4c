"""Rows for sums of what bodies carry.

A sum is needed from the step of a body's first child to its own, inward, so bodies use rows in turn: a chain needs two,
which stay in the nearest cache.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.bodies import BASE

NOTHING, OF_BASE, UNREAD, FIRST = range(4)
"""The row that stays zero, that of a base, the one where roots leave what nobody reads, and the first of the others."""


class SumRows(NamedTuple):
    """Which rows a body's step uses.

    own: of what it carries.  so_far: of what its carrier's other children have added; NOTHING for the first child.
    carriers: where it adds its own.  rows: how many there are.
    """

    own: np.ndarray
    so_far: np.ndarray
    carriers: np.ndarray
    rows: int

    @property
    def lists(self) -> dict[str, np.ndarray]:
        """Lists of rows, for views."""
        named = {"own sum": self.own, "sum so far": self.so_far, "carrier's sum": self.carriers}
        return named | {"base's sum": np.array([OF_BASE])}


def sum_rows(parents: Iterable[int]) -> SumRows:
    """parents: numbers of the bodies' parents, WORLD or BASE; children have higher numbers, and come first."""
    given = [*map(int, parents)]
    own, so_far, carriers = np.full((3, len(given)), NOTHING)
    held, spare, count = {BASE: OF_BASE}, list[int](), FIRST
    for body, carrier in reversed([*enumerate(given)]):
        if carrier in held:
            so_far[body] = held[carrier]
        elif carrier != WORLD:
            held[carrier], count = (spare.pop(), count) if spare else (count, count + 1)
        carriers[body] = held.get(carrier, UNREAD)
        if body in held:
            own[body] = held[body]
            spare.append(held.pop(body))
    return SumRows(own, so_far, carriers, count)

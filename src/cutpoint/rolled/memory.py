"""Working memory of a function's loops, and the data that they need of their robot."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Generic, TypeVar

import numpy as np

from cutpoint.mechanics.bodies.spatial import AT_ORIGIN
from cutpoint.mechanics.system import Place, System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.bodies import BASE, Columns, base_row, parents_of, place_of
from cutpoint.rolled.packing import flat
from cutpoint.rolled.recipes import Recipe
from cutpoint.rolled.sums import sum_rows

T = TypeVar("T")

COLUMN = "column"
"""The region with a column of a Jacobian for every body."""

LINE = 64
"""Bytes of a line of the cache, where each array begins."""


class Task:
    """The data of one function's calls: its recipe, robot, frame and backend."""

    def __init__(self, recipe: Recipe, system: System, columns: Columns, backend: str, frame: str | None) -> None:
        self.recipe, self.columns, self.backend = recipe, columns, backend
        self.steps, self.bodies = recipe.steps(columns), columns.bodies
        place = place_of(system, frame) if frame else Place(WORLD, AT_ORIGIN)
        R, p, number = place.pose.rotation, place.pose.position, np.inf if place.body == WORLD else place.body
        known = {"frame": (*flat(R), *p, number), "gravity": [*system.gravity]}
        known |= {"base.body": base_row(system)} if columns.base else {}
        self.constants = {k: np.array(known[k], dtype=np.float64) for k in self.steps.constants}
        self._parents, self._tip = parents_of(system), np.array([place.body])
        self.sums = sum_rows(self._parents)
        base = [*system.base_acceleration]
        rows = {k: [base[x[1]] if isinstance(x, tuple) else x for x in row] for k, row in self.steps.world.items()}
        self.world = {name: np.array(row, dtype=np.float64) for name, row in rows.items()}

    def of_base(self, name: str) -> int:
        """How many of a vector's numbers are a base's; they come first."""
        return self.steps.apart.get(f"base.{name}", 0)

    def size(self, name: str) -> int:
        """Size of an input."""
        return self.of_base(name) + self.bodies

    def shape(self, name: str) -> tuple[int, ...]:
        """Shape of an output."""
        speeds = self.bodies + (len(self.columns.base.axes) if self.columns.base else 0)
        in_parts = {**dict.fromkeys(self.steps.matrices, (speeds, speeds)), COLUMN: (6, speeds)}
        every = self.bodies + (self.columns.base is not None)
        in_parts |= {name: (speeds, k * every) for name, k in self.steps.entries.items()}
        return {**in_parts, **self.steps.shapes}.get(name, (self.size(name),))

    def pairs(self, lanes: int) -> tuple[dict[str, np.ndarray], dict[str, int]]:
        """Bodies and blocks of others, by number, where one carries the other, and the positions of their entries.

        By kinship: see `Kinship.lists`; then their counts, by its name.
        """
        n, blocks = self.bodies, -(-self.bodies // lanes)
        carry = np.eye(n, blocks * lanes, dtype=bool)  # each body, by those that carry it, and itself
        for i, parent in enumerate(self._parents):
            if parent >= 0:
                carry[i] |= carry[parent]
        carried = np.zeros_like(carry)
        carried[:, :n] = carry[:, :n].T
        is_carried, carries = (x.reshape(n, blocks, lanes).any(axis=2) for x in (carry, carried))
        lists: dict[str, np.ndarray] = {}
        counts: dict[str, int] = {}
        for kin in self.steps.kinships(is_sure=lanes == 1):
            chosen = (carries == kin.carries) & (is_carried == kin.is_carried)
            body, block = map(np.ascontiguousarray, np.nonzero(chosen))
            lists |= dict(zip(kin.lists, (body, block, body * blocks + block), strict=True))
            counts[kin.name] = len(body)
        return lists, counts

    def rows(self, world: int) -> dict[str, np.ndarray]:
        """Lists of rows, given the world's; the base's row follows it."""
        numbers = {"parent": self._parents, "world": np.array([WORLD]), "base": np.array([BASE]), "tip": self._tip}
        lists = {k: np.select([x == WORLD, x == BASE], [world, world + 1], x) for k, x in numbers.items()}
        lists |= self.sums.lists
        views = [self.steps.views, *(self.steps.rows_of(p) for p in self.steps.passes if p.way == "once")]
        used = {view.index for some in views for view in some}
        return {name: rows.astype(np.int64) for name, rows in lists.items() if name in used}


class Spare(Generic[T]):
    """A pool of memory for calls: as many pieces as calls run concurrently."""

    def __init__(self, make: Callable[[], T]) -> None:
        self._make, self._free = make, list[T]()

    @contextmanager
    def lent(self) -> Iterator[T]:
        """Memory for the exclusive use of a call."""
        try:
            memory = self._free.pop()
        except IndexError:
            memory = self._make()
        yield memory
        self._free.append(memory)


def aligned(size: int, head: int = 0) -> np.ndarray:
    """(head + size,) zeros, of which those after the head are aligned to a cache line."""
    room = np.zeros(head + size + LINE // 8)
    skipped = -(room.ctypes.data + 8 * head) % LINE // 8
    return room[skipped : skipped + head + size]

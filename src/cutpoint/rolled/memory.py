"""Memory that a function's loops work in, and what they need to know of their robot."""

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.recipes import Recipe

Array = np.ndarray
T = TypeVar("T")

MATRIX = "matrix"
"""The region with a number for every pair of bodies."""

LINE = 64
"""Bytes of a line of the cache, where each array begins."""


class Task:
    """What calls of one function need to know: its recipe, its robot and the backend."""

    def __init__(self, recipe: Recipe, system: System, columns: Columns, backend: str) -> None:
        self.recipe, self.columns, self.backend = recipe, columns, backend
        self.steps, self.bodies = recipe.steps(columns), len(system.segments)
        self._parents = np.array([b.parent for b in system.segments], dtype=np.int64)
        base = [*system.base_acceleration]
        told = {k: [base[x[1]] if isinstance(x, tuple) else x for x in row] for k, row in self.steps.world.items()}
        self.world = {name: np.array(row, dtype=np.float64) for name, row in told.items()}

    @property
    def shape(self) -> tuple[int, ...]:
        """Of each output."""
        return (self.bodies, self.bodies) if MATRIX in self.recipe.outputs else (self.bodies,)

    def parents(self, world: int) -> Array:
        """(n,) the row of each body's parent, given the world's."""
        return np.where(self._parents == WORLD, world, self._parents)


class Spare(Generic[T]):
    """Memory for calls: as many pieces as calls run at once."""

    def __init__(self, make: Callable[[], T]) -> None:
        self._make, self._free = make, list[T]()

    def take(self) -> T:
        """Memory that no other call uses."""
        try:
            return self._free.pop()
        except IndexError:
            return self._make()

    def give_back(self, memory: T) -> None:
        self._free.append(memory)


def aligned(rows: int, size: int) -> Array:
    """(rows, size) zeros that begin where a line of the cache does."""
    room = np.zeros(rows * size + LINE // 8)
    skipped = -room.ctypes.data % LINE // 8
    return room[skipped : skipped + rows * size].reshape(rows, size)

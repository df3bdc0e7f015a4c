"""Positions of quantities in a loop's rows, and numbers of any kind as arrays."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.interface import Command, Measurement, Reference, completed
from cutpoint.control.sensors import SAMPLED
from cutpoint.scalars import Scalar

Scalars = list[Scalar]


@dataclass(frozen=True)
class Layout:
    """Positions in the memory regions: n drives, nv speeds; lengths of a state and of a sample's noise."""

    n: int
    nv: int
    state: int
    noise: int

    @property
    def row(self) -> int:
        """Per control period: time, reference with four derivatives, disturbance."""
        return 1 + 5 * self.n + self.nv

    def reference(self, row: Scalars) -> Reference:
        """The links' reference of a row; the motors' is the same unless a law makes its own."""
        q, v, a, jerk, snap = (array_of(row[1 + k * self.n : 1 + (k + 1) * self.n]) for k in range(5))
        return Reference(q, v, a, jerk, snap, q, v)

    def seen(self, measured: Any, row: Any, period: Scalar) -> tuple[Measurement, Reference]:
        """The measurement for a controller."""
        given = {name: array_of(measured[k * self.n : (k + 1) * self.n]) for k, name in enumerate(SAMPLED)}
        return Measurement(row[0], period, **given), self.reference(row)

    def command(self, command: Command, row: Any) -> Scalars:
        """A command as recorded: a missing motor reference is taken from the links'."""
        *parts, fault = completed(command, self.reference(row), self.n)
        return [*(x for part in parts for x in part), fault]

    def disturbance(self, row: Scalars) -> Scalars:
        return row[1 + 5 * self.n :]

    def references(self, rows: Array) -> Array:
        """Of all rows (N, row), (5, N, n): to be read or written."""
        return np.moveaxis(rows[:, 1 : 1 + 5 * self.n].reshape(len(rows), 5, self.n), 1, 0)

    def disturbances(self, rows: Array) -> Array:
        """Of all rows (N, row), (N, nv): to be read or written."""
        return rows[:, 1 + 5 * self.n :]


def array_of(numbers: Any) -> Any:
    """Numbers as an array, of objects when they are traced, so that laws can be written with array arithmetic."""
    plain = all(isinstance(x, float) for x in numbers)
    array = np.empty(len(numbers), dtype=float if plain else object)
    array[:] = numbers
    return array

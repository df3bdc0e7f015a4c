"""Where things stand in a loop's rows, and numbers of any kind as arrays."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Reference
from cutpoint.scalars import Scalar

Scalars = list[Scalar]


@dataclass(frozen=True)
class Layout:
    """Where things stand in the regions: n drives, nv speeds; how long a state and a sample's noise are."""

    n: int
    nv: int
    state: int
    noise: int

    @property
    def row(self) -> int:
        """Per control period: time, reference with four derivatives, disturbance."""
        return 1 + 5 * self.n + self.nv

    def reference(self, row: Scalars) -> Reference:
        """The links' reference of a row; until a law makes a better one, the motors' is the same."""
        q, v, a, jerk, snap = (array_of(row[1 + k * self.n : 1 + (k + 1) * self.n]) for k in range(5))
        return Reference(q, v, a, jerk, snap, q, v)

    def disturbance(self, row: Scalars) -> Scalars:
        return row[1 + 5 * self.n :]


def array_of(numbers: Any) -> Any:
    """Numbers as an array, of objects when they are traced, so that laws can be written with array arithmetic."""
    plain = all(isinstance(x, float) for x in numbers)
    array = np.empty(len(numbers), dtype=float if plain else object)
    array[:] = numbers
    return array

"""Location of a program's inputs and outputs in its memory: some are assembled from parts of it."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.programs.plan import Plan


class Part(NamedTuple):
    """Part of a program's memory, and the slices of the output that it fills, in the order of its numbers."""

    own: np.ndarray
    index: Any = ...

    def place(self, output: np.ndarray) -> np.ndarray:
        """Its slices of an output, in the shape that it has in memory: a view, since slices are only subdivided."""
        return output[self.index].reshape(self.own.shape)


class Output(NamedTuple):
    """An output's shape, and the parts that fill it."""

    shape: tuple[int, ...]
    parts: Sequence[Part]

    def put(self, output: np.ndarray) -> None:
        for part in self.parts:
            part.place(output)[...] = part.own


def whole(own: np.ndarray) -> Output:
    """An output that lies in memory as it is returned."""
    return Output(own.shape, [Part(own)])


class Fixed(NamedTuple):
    """A program with everything that its runs share.

    counts: of its loops.  arrays: of regions and lists of rows, in their state before a run.  inputs, outputs: their
    locations in these arrays, by name.
    """

    plan: Plan
    counts: Mapping[str, int]
    arrays: Mapping[str, np.ndarray]
    inputs: Mapping[str, Output]
    outputs: Mapping[str, Output]

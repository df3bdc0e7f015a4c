"""Where a program's inputs and outputs stand in its memory: some are put together from parts of it."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.programs.plan import Plan


class Part(NamedTuple):
    """Some of a program's memory, and the slices of the output where it stands, read in the order of its numbers."""

    own: np.ndarray
    index: Any = ...

    def place(self, output: np.ndarray) -> np.ndarray:
        """Where it stands, in the shape that it has in memory: a view, as slices are only ever cut finer."""
        return output[self.index].reshape(self.own.shape)


class Output(NamedTuple):
    """An output's shape, and the parts that fill it."""

    shape: tuple[int, ...]
    parts: Sequence[Part]

    def put(self, output: np.ndarray) -> None:
        for part in self.parts:
            part.place(output)[...] = part.own


def whole(own: np.ndarray) -> Output:
    """One that lies in memory as it is given."""
    return Output(own.shape, [Part(own)])


class Fixed(NamedTuple):
    """A program with all that its runs have in common.

    counts: of its loops.  arrays: of regions and lists of rows, as they are before a run.  inputs, outputs: where in
    these arrays they stand, by name.
    """

    plan: Plan
    counts: Mapping[str, int]
    arrays: Mapping[str, np.ndarray]
    inputs: Mapping[str, Output]
    outputs: Mapping[str, Output]

"""Encoder noise: standard normal numbers by the method of Box and Muller (1958), many at once in compiled lanes."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.kernels import Kernel
from cutpoint.scalars import Scalar, cos, log, sin, sqrt

BLOCK = 512
"""Samples whose noise is made at once, while the cache still has it."""


class Noise:
    """Noise of runs side by side, sample after sample, `size` numbers per run.

    Blocks are drawn whole: a run's noise depends on its seed and size only, and a longer run begins like a shorter one.
    """

    def __init__(self, seeds: Sequence[int], size: int, backend: str) -> None:
        self._sources, self._size, self._backend = [np.random.default_rng(seed) for seed in seeds], size, backend

    def fill(self, rows: Array) -> None:
        """The next samples, (samples, size * runs): number k of run l is in column k * runs + l.

        rows: C-contiguous; a whole number of blocks, but for the last.
        """
        for start in range(0, len(rows) if self._size else 0, BLOCK):
            own = rows[start : start + BLOCK]
            if len(own) == BLOCK:
                self._draw(own)
            else:
                whole = np.empty((BLOCK, rows.shape[1]))
                self._draw(whole)
                own[:] = whole[: len(own)]

    def _draw(self, block: Array) -> None:
        pairs = block.reshape(-1, 2, len(self._sources))
        normals = _box_muller(self._backend)
        for run, source in enumerate(self._sources):
            radius, turn = source.random((2, len(pairs)))
            normals(radius, turn, out=pairs[..., run])


@cache
def _box_muller(backend: str) -> Kernel:
    def normals(radius: Scalar, turn: Scalar) -> list[Scalar]:
        """Two normal numbers from two uniform ones in [0, 1)."""
        r, phi = sqrt(-2 * log(1 - radius)), 2 * np.pi * turn
        return [r * cos(phi), r * sin(phi)]

    return kernels.compile(normals, name="normals", backend=backend, radius=(), turn=())

"""Noise of encoders: standard normal numbers by the method of Box and Muller (1958), many at once in compiled lanes."""

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from cutpoint import kernels
from cutpoint.kernels import Kernel
from cutpoint.scalars import Scalar, cos, log, sin, sqrt

Array = NDArray[np.float64]

BLOCK = 512
"""Samples whose noise is made at once, while the cache still has it."""


def noise_beside(seeds: Sequence[int], samples: int, size: int, backend: str) -> Array:
    """Noise of runs side by side, (samples, size * runs): number k of run l is in column k * runs + l."""
    noise: Array = np.empty((samples, size * len(seeds)))
    starts = range(0, samples if size else 0, BLOCK)
    for start, block in zip(starts, blocks_beside(seeds, size, backend), strict=False):
        noise[start : start + BLOCK] = block[: samples - start]
    return noise


def blocks_beside(seeds: Sequence[int], size: int, backend: str) -> Iterator[Array]:
    """The same without end, BLOCK samples after BLOCK samples.

    Blocks are drawn whole: what a run gets depends on its seed and size alone, and a longer run begins as a shorter.
    """
    sources = [np.random.default_rng(seed) for seed in seeds]
    while True:
        block: Array = np.empty((BLOCK * size, len(seeds)))
        for run, source in enumerate(sources):
            block[:, run] = _normals(source, BLOCK * size, backend)
        yield block.reshape(BLOCK, -1)


def _normals(source: np.random.Generator, count: int, backend: str) -> Array:
    """An even count of normal numbers."""
    radius, turn = source.random((2, count // 2))
    return _box_muller(backend)(radius, turn).ravel()


@cache
def _box_muller(backend: str) -> Kernel:
    def normals(radius: Scalar, turn: Scalar) -> list[Scalar]:
        """Two normal numbers from two uniform ones in [0, 1)."""
        r, phi = sqrt(-2 * log(1 - radius)), 2 * np.pi * turn
        return [r * cos(phi), r * sin(phi)]

    return kernels.compile(normals, name="normals", backend=backend, radius=(), turn=())

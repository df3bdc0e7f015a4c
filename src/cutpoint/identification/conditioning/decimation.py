"""Decimation to a lower bandwidth: the same window is applied to all quantities of an equation.

Linear equations of the samples hold for their weighted means too: if torque = W p at every sample, it also holds for
the means of torque and of W.  Gautier (1997), ICRA, calls that parallel filtering.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import firwin
from scipy.sparse import csr_array

from cutpoint.arrays import Array
from cutpoint.door import number
from cutpoint.errors import InputError

CROSSINGS = 3
"""Zeros of the window's sinc on each side: the noise of neighbouring means is almost uncorrelated."""


@dataclass(frozen=True, eq=False)
class Decimation:
    """Weighted means over windows of samples.

    window: (w,), symmetric, its sum 1.  starts: (M,), the first sample of each.  period: s between samples.
    """

    window: Array
    starts: NDArray[np.intp]
    period: float

    @property
    def size(self) -> int:
        """Number of means, M."""
        return self.starts.size

    @property
    def times(self) -> Array:
        """(M,) s, the middles of the windows, counted from the first sample."""
        return self.period * (self.starts + self.window.size // 2).astype(np.float64)

    def samples(self, rows: slice) -> slice:
        """The samples that contribute to some of the means."""
        starts = self.starts[rows]
        return slice(int(starts[0]), int(starts[-1]) + self.window.size)

    def __call__(self, values: Array, rows: slice | None = None) -> Array:
        """The means (M, ...) of values (N, ...); with rows, only those means, from values[samples(rows)]."""
        used = values[self.samples(slice(None))] if rows is None else values
        matrix = self._matrix if rows is None else self._weights(rows)
        flat = used.reshape(used.shape[0], math.prod(used.shape[1:]))
        return np.asarray(matrix @ flat).reshape(matrix.shape[0], *used.shape[1:])

    @cached_property
    def _matrix(self) -> Any:
        return self._weights(slice(None))

    def _weights(self, rows: slice) -> Any:
        """(means, samples), sparse."""
        starts = self.starts[rows] - self.starts[rows][0]
        columns = starts[:, None] + np.arange(self.window.size)
        edges = np.arange(starts.size + 1) * self.window.size
        shape = (starts.size, int(starts[-1]) + self.window.size)
        return csr_array((np.tile(self.window, starts.size), columns.ravel(), edges), shape=shape)


def decimation(known: NDArray[np.bool_], period: float, bandwidth: float) -> Decimation:
    """Means with a bandwidth (Hz), at twice its rate, over windows in which every sample is known (N,).

    Raises InputError: a bandwidth that is not between 0 and half of the sampling rate, or too few known samples.
    """
    if not 0.0 < number("identify_rigid", "bandwidth", bandwidth, "Hz") < 0.5 / period:
        rate = 0.5 / period
        raise InputError(f"bandwidth {bandwidth} Hz must lie between 0 and {rate:g} Hz, half the sampling rate")
    step = max(1, int(0.5 / (bandwidth * period)))
    window: Any = firwin(2 * CROSSINGS * step + 1, bandwidth, fs=1.0 / period) if step > 1 else np.ones(1)
    unknown = np.concatenate([[0], np.cumsum(~known)])
    starts = np.arange(0, known.size - window.size + 1, step)
    starts = starts[unknown[starts + window.size] == unknown[starts]]
    if starts.size < 2:
        longest = window.size * period
        raise InputError(
            f"the recording has no two stretches of {longest:.3g} s in which every joint's positions and torques are "
            f"known, in all its {known.size * period:.3g} s: record more, or raise bandwidth (--bandwidth)"
        )
    return Decimation(window, starts, period)

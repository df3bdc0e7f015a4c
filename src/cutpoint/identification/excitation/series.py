"""Periodic motions: a finite Fourier series for every joint.  Swevers et al. (1997), IEEE Trans. Robot. Autom. 13(5).

q(t) = centre + sum over l = 1 ... L of [sine_l sin(l w t) - cosine_l cos(l w t)] / (l w),  w = 2 pi base_frequency,

so that sine and cosine are parts of the speed.  It starts and ends at rest if its coefficients are combinations of
`still_waves`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

from cutpoint.arrays import Array
from cutpoint.trajectories import Trajectory


@dataclass(frozen=True, eq=False)
class FourierSeries(Trajectory):
    """base_frequency in Hz; centre (n,) in rad (m); sine and cosine (L, n) in rad/s (m/s)."""

    base_frequency: float
    centre: Array
    sine: Array
    cosine: Array

    @property
    def size(self) -> int:
        return self.centre.size

    @property
    def harmonics(self) -> int:
        """L."""
        return len(self.sine)

    def _inside(self, t: Array, order: int) -> Array:
        rate = 2.0 * np.pi * self.base_frequency * np.arange(1.0, self.harmonics + 1.0)
        s, c = np.sin(t[..., None] * rate), np.cos(t[..., None] * rate)
        quarters = (s, c, -s, -c)
        found = np.empty((order + 1, *t.shape, self.size))
        for k in range(order + 1):
            # every derivative advances both waves by a quarter period
            grown = rate ** (k - 1)
            found[k] = (quarters[k % 4] * grown) @ self.sine - (quarters[(k + 1) % 4] * grown) @ self.cosine
        found[0] += self.centre
        return found


def still_waves(harmonics: int, rest: int) -> tuple[Array, Array]:
    """Sine and cosine parts (L, r) of waves whose first `rest` derivatives vanish at the start and end of a period.

    r = 2 L - rest; the waves have unit coefficients and are orthogonal.
    """
    order = np.arange(1.0, harmonics + 1.0) / harmonics
    sines = null_space(np.array([order ** (k - 1) for k in range(1, rest + 1, 2)]))
    cosines = null_space(np.array([order ** (k - 1) for k in range(2, rest + 1, 2)]))
    sine, cosine = np.zeros((2, harmonics, sines.shape[1] + cosines.shape[1]))
    sine[:, : sines.shape[1]], cosine[:, sines.shape[1] :] = sines, cosines
    return sine, cosine

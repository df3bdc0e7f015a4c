"""How far estimates may be off when residuals follow each other.  Newey and West (1987), Econometrica 55(3)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

Array = NDArray[np.float64]

TIMES = 5.0
"""Correlation times of the residuals up to which lags count.  Sokal (1997)."""

LONGEST = 0.1
"""Share of a recording beyond which no lag counts."""


class Spread(NamedTuple):
    """covariance (c, c), infinite where nothing was seen.  degrees: of freedom, of Student's t.

    lag: rows over which residuals were taken to be related.  correlation: how many rows weigh as much as one would if
    they were not.
    """

    covariance: Array
    degrees: float
    lag: int
    correlation: float

    def deviations(self) -> Array:
        """Standard deviations, (c,)."""
        return np.sqrt(np.diag(self.covariance))

    def margins(self, level: float) -> Array:
        """Half the widths (c,) of intervals that hold the truth with a probability."""
        return float(t.ppf(0.5 + 0.5 * level, self.degrees)) * self.deviations()


def spread(scores: Array, P: Array, seen: NDArray[np.bool_], residuals: Array) -> Spread:
    """The spread of P @ sum of scores (M, c), related as the residuals (M, n; of unit size) are.

    Scores of neighbours are multiplied up to a lag, weighted by Bartlett's triangle; what fitting took from the
    residuals is given back.  The estimated covariance itself is as uncertain as one of 3/2 M / lag samples.
    """
    M, n = residuals.shape
    lag, correlation = _memory(residuals)
    S = scores.T @ scores
    for k in range(1, lag + 1):
        product = scores[k:].T @ scores[:-k]
        S += (1.0 - k / (lag + 1.0)) * (product + product.T)
    free = max(1.0, M * n / correlation - scores.shape[1])
    covariance = P @ S @ P * (1.0 + scores.shape[1] / free)
    covariance[~seen] = covariance[:, ~seen] = 0.0
    covariance[~seen, ~seen] = np.inf
    return Spread(covariance, min(free, max(1.0, 1.5 * M / (lag + 1.0))), lag, correlation)


def _memory(residuals: Array) -> tuple[int, float]:
    """The lag after which residuals know nothing of each other, and their correlation time, both in rows."""
    M = len(residuals)
    padded = np.fft.rfft(residuals, 2 * M, axis=0)
    each = np.fft.irfft((padded * padded.conj()).real, axis=0)[: max(2, int(LONGEST * M))]
    rho = each.sum(axis=1) / max(each[0].sum(), np.finfo(float).tiny)
    times = 2.0 * np.cumsum(rho) - 1.0
    lags = np.flatnonzero(np.arange(rho.size) >= TIMES * np.maximum(times, 0.2))
    lag = int(lags[0]) if lags.size else rho.size - 1
    return lag, max(1.0, float(times[lag]))

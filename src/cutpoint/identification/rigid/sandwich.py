"""Uncertainty of estimates with serially correlated residuals."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from cutpoint.identification.conditioning.correlated_noise import alike, as_found, at_least

Array = NDArray[np.float64]

TIMES = 5.0
"""Correlation times of the residuals up to which lags count.  Sokal (1997)."""

LONGEST = 0.1
"""Share of a recording beyond which no lag counts."""


LEAST = 0.1
"""Of a residual that a row alone decides: what is taken to be left of it, at least."""


class Spread(NamedTuple):
    """covariance (c, c), infinite where nothing was seen.  degrees: of freedom, of Student's t.

    lag: rows over which residuals were taken to be related, of the joint of which it is longest.  correlation: how many
    rows weigh as much as one would if they were not.
    """

    covariance: Array
    degrees: float
    lag: int
    correlation: float

    def first(self, count: int, known: Array) -> "Spread":
        """Of the first parameters alone.  known (c, k): how far what was taken as known may pull each, k at a time."""
        pulled = self.covariance + known @ known.T
        return self._replace(covariance=pulled[:count, :count])

    def deviations(self) -> Array:
        """Standard deviations, (c,)."""
        return np.sqrt(np.diag(self.covariance))

    def margins(self, level: float) -> Array:
        """Half-widths (c,) of confidence intervals at a level."""
        return float(t.ppf(0.5 + 0.5 * level, self.degrees)) * self.deviations()


def spread(design: Array, residuals: Array, P: Array, seen: NDArray[np.bool_]) -> Spread:
    """The spread of P @ sum of design (M, n, c) times residuals (M, n), both weighted.

    Each residual is brought to what it would be had its row not been fitted: MacKinnon and White (1985).  As found, a
    covariance is as uncertain as that of 3/2 M / lag samples.
    """
    M, n, c = design.shape
    lags, correlations = zip(*map(_memory, residuals.T), strict=True)
    lag, correlation = max(lags), float(np.mean(correlations))
    # P goes in before sums are squared: of what is hardly seen, rounding would else leave negative variances
    pull = design @ P
    left = residuals / np.maximum(1.0 - np.einsum("mjc,mjc->mj", pull, design), LEAST)
    found = as_found(np.einsum("mjc,mj->mc", pull, left), lag + 1)
    # noise of one joint is taken to know nothing of another's
    steady = sum(alike(pull[:, j], left[:, j], lags[j] + 1) for j in range(n))
    covariance = at_least(found, np.asarray(steady))
    covariance[~seen] = covariance[:, ~seen] = 0.0
    covariance[~seen, ~seen] = np.inf
    free = max(1.0, M * n / correlation - c)
    return Spread(covariance, min(free, max(1.0, 1.5 * M / (lag + 1.0))), lag, correlation)


def _memory(residual: Array) -> tuple[int, float]:
    """The lag after which a joint's residuals (M,) know nothing of each other, and their correlation time, both in
    rows."""
    M = residual.size
    padded = np.fft.rfft(residual, 2 * M)
    rho = np.fft.irfft((padded * padded.conj()).real)[: max(2, int(LONGEST * M))]
    rho = rho / max(rho[0], np.finfo(float).tiny)
    times = 2.0 * np.cumsum(rho) - 1.0
    lags = np.flatnonzero(np.arange(rho.size) >= TIMES * np.maximum(times, 0.2))
    lag = int(lags[0]) if lags.size else rho.size - 1
    return lag, max(1.0, float(times[lag]))

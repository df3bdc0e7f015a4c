"""Uncertainty of estimates with serially correlated residuals."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.correlated_noise import alike, as_found, at_least, autocorrelations, without

TIMES = 5.0
"""Largest lag, in correlation times of the residuals.  Sokal (1997)."""

LONGEST = 0.1
"""Largest lag, as a share of a recording."""


LEAST = 0.1
"""Least share assumed to remain of a residual whose row alone determines a parameter."""


class Spread(NamedTuple):
    """covariance (c, c), infinite for unobservable parameters.  degrees: of freedom, of Student's t.

    lag: rows over which residuals were taken as correlated, the longest of all joints.  correlation: number of rows
    that carry as much information as one uncorrelated row.
    """

    covariance: Array
    degrees: float
    lag: int
    correlation: float

    def first(self, count: int, known: Array) -> "Spread":
        """That of the first parameters.  known (c, k): effects on each of k errors in known quantities."""
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

    Each residual is scaled to what it would be had its row not been fitted: MacKinnon and White (1985).  As found, a
    covariance is as uncertain as that of 3/2 M / lag samples.
    """
    M, n, c = design.shape
    lags, correlations = zip(*map(_memory, residuals.T), strict=True)
    lag, correlation = max(lags), float(np.mean(correlations))
    # P comes before squaring: otherwise rounding would leave negative variances of hardly observable parameters
    pull = design @ P
    left = residuals / np.maximum(1.0 - np.einsum("mjc,mjc->mj", pull, design), LEAST)
    found = as_found(np.einsum("mjc,mj->mc", pull, left), lag + 1)
    # noise of different joints is taken as independent
    steady = sum(alike(pull[:, j], left[:, j], lags[j] + 1) for j in range(n))
    covariance = without(at_least(found, np.asarray(steady)), ~seen)
    free = max(1.0, M * n / correlation - c)
    return Spread(covariance, min(free, max(1.0, 1.5 * M / (lag + 1.0))), lag, correlation)


def _memory(residual: Array) -> tuple[int, float]:
    """The lag after which a joint's residuals (M,) are uncorrelated, and their correlation time, both in rows."""
    rho = autocorrelations(residual)[: max(2, int(LONGEST * residual.size))]
    rho = rho / max(rho[0], np.finfo(float).tiny)
    times = 2.0 * np.cumsum(rho) - 1.0
    lags = np.flatnonzero(np.arange(rho.size) >= TIMES * np.maximum(times, 0.2))
    lag = int(lags[0]) if lags.size else rho.size - 1
    return lag, max(1.0, float(times[lag]))

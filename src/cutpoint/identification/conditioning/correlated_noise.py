"""Covariance of sums of columns times correlated noise: two estimates, and the larger of the two.

`as_found` needs no model of the noise, but is unreliable where few samples determine a parameter.  `alike` assumes
stationary noise, which is estimated from all samples.  Both weight lags by Bartlett's triangle: Newey and West (1987),
Econometrica 55(3).
"""

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array

FARTHEST = 3.0
"""Standard deviations, from the median, at which residuals are clipped where noise is assumed stationary."""

NORMAL = 0.6745
"""Median of |x| of a standard normal x."""


def autocorrelations(x: Array) -> Array:
    """Sums of x (N,) times itself 0 to N - 1 samples later, (N,)."""
    padded = np.fft.rfft(x, 2 * x.size)
    return np.fft.irfft((padded * padded.conj()).real)[: x.size]


def as_found(scores: Array, length: int) -> Array:
    """Covariance (p, p) of the sum of scores (N, p), each correlated with others less than a length away.

    From their sums over all windows of that length, one starting at each sample.
    """
    N = len(scores)
    summed = np.cumsum(np.vstack([np.zeros_like(scores[:1]), scores]), axis=0)
    # with windows that begin before the first sample and end after the last, all pairs count equally often
    ends = np.arange(1, N + length)
    windows = summed[np.minimum(ends, N)] - summed[np.maximum(ends - length, 0)]
    return np.asarray(windows.T @ windows / length)


def alike(columns: Array, residual: Array, length: int) -> Array:
    """The same for columns (N, p) times stationary noise, with the autocovariance of most of a residual (N,)."""
    edge = FARTHEST * float(np.median(np.abs(residual))) / NORMAL
    residual = np.clip(residual, -edge, edge)
    N = residual.size
    size = 1 << (N + length).bit_length()  # circular in lags that the triangle leaves out
    power = np.abs(np.fft.rfft(residual, size)) ** 2
    lags = np.minimum(np.arange(size), size - np.arange(size))
    tapered = np.fft.irfft(power, size) / N * np.maximum(1.0 - lags / length, 0.0)
    spectrum = np.maximum(np.fft.rfft(tapered).real, 0.0)  # nonnegative with a triangle, but for rounding
    spectrum[1:-1] *= 2.0  # the negative frequencies
    parts = np.fft.rfft(columns, size, axis=0)
    return np.asarray((parts.conj().T @ (spectrum[:, None] * parts)).real / size)


def at_least(covariance: Array, other: Array) -> Array:
    """A covariance (p, p), with each deviation raised to at least that of another."""
    own, least = np.diag(covariance), np.diag(other)
    larger = np.sqrt(np.maximum(least / np.where(own > 0.0, own, 1.0), 1.0))
    return covariance * np.outer(larger, larger)


def independent(covariance: Array) -> Array:
    """(p, p): columns S with S S^T the covariance (p, p), each an error that is independent of the others'; S of what
    is not determined at all, so that its covariance is infinite, is zero."""
    variances, directions = np.linalg.eigh(np.where(np.isfinite(covariance), covariance, 0.0))
    return np.asarray(directions * np.sqrt(np.maximum(variances, 0.0)))


def without(covariance: Array, unseen: NDArray[np.bool_]) -> Array:
    """A covariance (p, p), with infinite variances of what was not observed, (p,)."""
    found = np.where(unseen | unseen[:, None], 0.0, covariance)
    found[unseen, unseen] = np.inf
    return found

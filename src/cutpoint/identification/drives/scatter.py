"""How uncertain least-squares estimates are when neighbouring residuals depend on one another."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WINDOWS = 25
"""Errors that change within a share of the recording, one part in this many, are accounted for."""

DEGREES = 1.5 * WINDOWS
"""Of freedom, of Student's t: how uncertain such a covariance itself is."""


def covariance(jacobian: Array, residual: Array) -> Array:
    """Covariance (p, p) of p estimates from the model's derivatives (N, p) and its residual (N,).

    Of two estimates of each variance the larger.  One takes scores as they are, which needs no model of the noise, but
    is itself uncertain where few samples tell a parameter.  The other takes noise to be alike all along.
    A column that the others make up has an infinite variance.
    """
    size = np.linalg.norm(jacobian, axis=0)
    scaled = jacobian / np.where(size > 0.0, size, 1.0)
    inverse = np.linalg.pinv(scaled.T @ scaled, hermitian=True)
    length = max(1, residual.size // WINDOWS)
    spread = inverse @ _as_found(scaled * residual[:, None], length) @ inverse
    alike = inverse @ _alike(scaled, residual, length) @ inverse
    own, other = np.diag(spread), np.diag(alike)
    larger = np.sqrt(np.maximum(other / np.where(own > 0.0, own, 1.0), 1.0))
    spread = spread * np.outer(larger, larger)
    found = spread / np.outer(size, size).clip(np.finfo(float).tiny)
    return _without(found, _undetermined(scaled.T @ scaled))


def _as_found(scores: Array, length: int) -> Array:
    """Covariance (p, p) of the sum of scores (N, p), each related to others less than a length away.

    From their sums over all windows of that length, each a sample after the other: triangular weights.
    Newey and West (1987), Econometrica 55(3).
    """
    N = len(scores)
    summed = np.cumsum(np.vstack([np.zeros_like(scores[:1]), scores]), axis=0)
    # windows that begin before the first sample and end after the last count each pair as often as the others
    ends = np.arange(1, N + length)
    windows = summed[np.minimum(ends, N)] - summed[np.maximum(ends - length, 0)]
    return np.asarray(windows.T @ windows / length)


def _alike(columns: Array, residual: Array, length: int) -> Array:
    """The same of columns (N, p) times noise whose autocovariance is the residual's (N,), with the same weights."""
    N, size = residual.size, 1 << (2 * residual.size).bit_length()
    power = np.abs(np.fft.rfft(residual, size)) ** 2
    lags = np.minimum(np.arange(size), size - np.arange(size))
    tapered = np.fft.irfft(power, size) / N * np.maximum(1.0 - lags / length, 0.0)
    spectrum = np.fft.rfft(tapered).real
    spectrum[1:-1] *= 2.0  # the negative frequencies
    parts = np.fft.rfft(columns, size, axis=0)
    return np.asarray((parts.conj().T @ (spectrum[:, None] * parts)).real / size)


def _undetermined(gram: Array) -> NDArray[np.bool_]:
    """Columns with a part in a direction that no combination of samples shows."""
    values, directions = np.linalg.eigh(gram)
    hidden = directions[:, values < gram.shape[0] * np.finfo(float).eps * max(values[-1], 1.0)]
    return np.asarray((np.abs(hidden) > 1e-3).any(axis=1))


def _without(covariance: Array, which: NDArray[np.bool_]) -> Array:
    found = covariance.copy()
    found[which, :] = found[:, which] = 0.0
    found[which, which] = np.inf
    return found

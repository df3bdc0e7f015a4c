"""Uncertainty of least-squares estimates with correlated residuals."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.correlated_noise import alike, as_found, at_least, without

WINDOWS = 25
"""Errors that change within one part in this many of the recording are accounted for."""

DEGREES = 1.5 * WINDOWS
"""Degrees of freedom of Student's t: the uncertainty of such a covariance itself."""

FAINT = 1e-100
"""rad over an unknown's unit: columns no larger count as zero, as for constants that drifted out of effect."""

SIGNIFICANT = 4.0
"""Standard deviations above which a value is significantly different from zero."""


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Estimates: names (p,), values (p,) and covariance (p, p), in SI; `found["inertia"]` is one value."""

    names: tuple[str, ...]
    values: Array
    covariance: Array = field(repr=False)

    def __getitem__(self, name: str) -> float:
        return float(self.values[self.names.index(name)])

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each unknown, by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))


def covariance(jacobian: Array, residual: Array) -> Array:
    """Covariance (p, p) of p estimates from the model's derivatives (N, p) and its residual (N,).

    A column that is a combination of others has an infinite variance, and so has a zero column.
    """
    size = np.linalg.norm(jacobian, axis=0)
    shown = size > FAINT
    size = np.where(shown, size, 1.0)
    scaled = np.where(shown, jacobian, 0.0) / size
    inverse = np.linalg.pinv(scaled.T @ scaled, hermitian=True)
    length = max(1, residual.size // WINDOWS)
    found, steady = as_found(scaled * residual[:, None], length), alike(scaled, residual, length)
    spread = at_least(inverse @ found @ inverse, inverse @ steady @ inverse)
    spread = spread / np.outer(size, size) / _left(residual, int(np.count_nonzero(shown)))
    lost = np.diag(spread) < 0.0  # only rounding errors
    return without(spread, lost | _undetermined(scaled.T @ scaled))


def _left(residual: Array, fitted: int) -> float:
    """Share of the noise's power that remains in the residual (N,) of a fit of this many parameters, at least a half.

    Narrow-band noise has the effective number of samples N rho(0)^2 / sum rho(k)^2, here from its spectrum by
    Parseval's theorem.
    """
    power = np.abs(np.fft.rfft(residual)) ** 2
    # a periodogram's squares are, on average, twice those of the spectrum: Brockwell and Davis (1991) section 10.3
    numbers = 2.0 * residual.size * np.mean(power) ** 2 / max(float(np.mean(power**2)), np.finfo(float).tiny)
    return max(0.5, 1.0 - fitted / max(float(numbers), 1.0))


def _undetermined(gram: Array) -> NDArray[np.bool_]:
    """Columns with a component in the null space."""
    values, directions = np.linalg.eigh(gram)
    hidden = directions[:, values < gram.shape[0] * np.finfo(float).eps * max(values[-1], 1.0)]
    return np.asarray((np.abs(hidden) > 1e-3).any(axis=1))

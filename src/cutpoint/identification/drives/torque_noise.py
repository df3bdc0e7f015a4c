"""Corrects a spring's fit for noise in the torque: treating the torque as exact overestimates stiffness."""

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.drives.deflections import DeflectionFit, Deflections
from cutpoint.identification.triangle import lengths

ROUNDS = 3
"""Rounds: each leaves a share of the step before it, which is small if the noise is."""

RELIABLE = 0.5
"""Least noise-free share of the signal that separates the spring from all else; below it, nothing is done."""


def without_attenuation(data: Deflections, fit: DeflectionFit) -> DeflectionFit:
    """The fit with the stiffness for which the residual is uncorrelated with the torques' best estimates.

    The residual beyond the deflection's own noise is the torque's: the best estimate of each torque then differs from
    the measured one by that share of its residual.  Deming (1943); Fuller (1987) section 1.3.
    """
    share = 1.0 - data.reading.noise**2 / max(float(np.mean(fit.residual**2)), np.finfo(float).tiny)
    for _ in range(ROUNDS if share > 0.0 else 0):
        fit = _softened(data, fit, data.torque + share * fit.tangent * fit.residual)
    return fit


def attenuation(data: Deflections, fit: DeflectionFit) -> Array:
    """(p,): possible bias of the unknowns due to noise in the torque's derivatives.

    At the true values the residual correlates with a noisy column through their common noise; least squares removes
    that correlation.  To first order in the noise's share; Fuller (1987) section 1.1.
    """
    pull = np.zeros(fit.columns.shape[1])
    pull[fit.places["corrections"]] = data.shared_noise * np.sum(1.0 / fit.tangent**2)
    return _moved(fit, pull[:, None])[:, 0]


def spread_of_errors(data: Deflections, fit: DeflectionFit) -> Array:
    """(p, p): covariance of the unknowns due to possible errors of the torque."""
    if data.reading.errors is None:
        return np.zeros((fit.values.size, fit.values.size))
    moved = _moved(fit, fit.columns.T @ (data.reading.errors / fit.tangent[:, None]))
    return np.asarray(moved @ moved.T)


def _moved(fit: DeflectionFit, pull: Array) -> Array:
    """By how much least squares move the unknowns, (p, m), if the columns' products with the lead change by (p, m)."""
    size = lengths(fit.columns)
    scaled = fit.columns / size
    return np.asarray(np.linalg.pinv(scaled.T @ scaled, hermitian=True) @ (pull / size[:, None]) / size[:, None])


def _softened(data: Deflections, fit: DeflectionFit, torque: Array) -> DeflectionFit:
    """All stiffnesses scaled by one factor, with the deflection under other torques (N,) as instrument; all else but
    reaches changes with them."""
    count, beside = fit.law.stiffnesses, fit.beside_the_law
    size = lengths(fit.columns[:, beside])
    columns = fit.columns[:, beside] / size
    deflection = fit.law.deflection(fit.constants, data.torque)
    instrument = _beside(columns, fit.law.deflection(fit.constants, torque))
    alone = _beside(columns, deflection)
    if not instrument @ alone > RELIABLE * (alone @ alone):
        return fit
    softer = float(instrument @ fit.residual / (instrument @ alone))
    if abs(softer) > 1.0 / RELIABLE - 1.0:  # more than noise can hide: the spring cannot be separated from the rest
        return fit
    weights = np.linalg.lstsq(columns, fit.residual - softer * deflection, rcond=None)[0]
    step = np.zeros(fit.columns.shape[1])
    step[:count] = fit.constants[:count] * (1.0 / (1.0 + softer) - 1.0)
    step[beside] = weights / size
    return fit.moved(step, fit.residual - softer * deflection - columns @ weights)


def _beside(columns: Array, values: Array) -> Array:
    """The part of values (N,) that the columns (N, k) do not explain."""
    return np.asarray(values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0])

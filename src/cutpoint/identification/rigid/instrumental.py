"""Parameters by instrumental variables: noise in measured positions does not bias them.

Janot, Vandanjon and Gautier (2014), IEEE Trans. Control Syst. Technol. 22(1).  Columns of a regression are made of
noisy positions, and least squares shrink what noise multiplies.  Instruments move as the columns do and know nothing of
their noise: columns of the motion that was asked for, of a simulated one, or, if noise is short-lived, earlier ones.
"""

import numpy as np
from numpy.typing import NDArray

from cutpoint.errors import InputError
from cutpoint.identification.rigid.least_squares import ROUNDS, SETTLED, Estimate, check_size, solved
from cutpoint.identification.rigid.regression import Regression, triangle
from cutpoint.identification.rigid.sandwich import spread

Array = NDArray[np.float64]

LATER = 3
"""Rows after which windows of a decimation share no sample worth mentioning."""


def instrumental_variables(regression: Regression, instruments: Array | None = None) -> Estimate:
    """Two stages, weighted by each joint's noise and iterated: what instruments (M, n, c) tell of the columns takes
    their place.  By default they are the columns of three rows before.

    Raises InputError: instruments of another shape, or fewer rows than parameters.
    """
    if instruments is None:
        regression, instruments = lagged(regression, LATER)
    if instruments.shape != regression.columns.shape:
        rule = f"must have the columns' shape, {regression.columns.shape}"
        raise InputError(f"instruments of shape {instruments.shape} {rule}", shape=instruments.shape)
    check_size(regression)
    noise = np.ones(regression.torque.shape[1])
    for _ in range(ROUNDS):
        _, R, z = _second_stage(regression, instruments, noise)
        residuals = regression.residuals(solved(R, z)[0])
        before, noise = noise, np.maximum(np.sqrt(np.mean(residuals**2, axis=0)), np.finfo(float).tiny)
        if np.abs(noise / before - 1.0).max() < SETTLED:
            break
    told, R, z = _second_stage(regression, instruments, noise)
    values, P, seen = solved(R, z)
    residuals = regression.residuals(values)
    found = spread(told, residuals / noise, P, seen)
    scale = np.sqrt(found.correlation)
    return Estimate(values, found, noise, R / scale, z / scale, residuals)


def lagged(regression: Regression, rows: int) -> tuple[Regression, Array]:
    """The regression without its first rows, and the columns of so many rows before, where no gap is in between."""
    times = regression.times
    step = float(np.median(np.diff(times)))
    if len(times) <= rows:
        raise InputError(f"{len(times)} rows are too few for instruments of {rows} rows before: record a longer motion")
    whole = times[rows:] - times[:-rows] < (rows + 0.5) * step
    return regression.part(slice(rows, None)).part(whole), regression.columns[:-rows][whole]


def _second_stage(regression: Regression, instruments: Array, noise: Array) -> tuple[Array, Array, Array]:
    """Weighted columns as far as the instruments tell them (M, n, c), and R x = z of the estimate."""
    shape, weights = instruments.shape, 1.0 / noise[:, None]
    Z, W = ((weights * x).reshape(-1, shape[2]) for x in (instruments, regression.columns))
    y = (regression.torque / noise).reshape(-1)
    length = np.linalg.norm(Z, axis=0)
    U, s, _ = np.linalg.svd(Z / np.where(length, length, 1.0), full_matrices=False)
    U = U[:, s > 1e-9 * s[0]]
    both = triangle(U.T @ np.column_stack([W, y]))
    return (U @ (U.T @ W)).reshape(shape), both[:-1, :-1], both[:-1, -1]

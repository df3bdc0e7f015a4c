"""Parameters by instrumental variables: noise in measured positions does not bias them.

Janot, Vandanjon and Gautier (2014), IEEE Trans. Control Syst. Technol. 22(1).  A regression's columns come from
noisy positions, which biases least squares towards zero.  Instruments are correlated with the columns but not with
their noise: columns of the desired motion, of a simulated one, or, if noise is short-lived, earlier ones.
"""

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.identification.rigid.least_squares import MOST_ROUNDS, SETTLED, Estimate, check_size, solved
from cutpoint.identification.rigid.regression import UNSEEN, Regression, reduced
from cutpoint.identification.rigid.sandwich import Spread, spread
from cutpoint.identification.triangle import lengths

LATER = 3
"""Rows after which windows of a decimation share practically no samples."""


def instrumental_variables(
    regression: Regression, instruments: Array | None = None, shapes: Array | None = None, known: Array | None = None
) -> Estimate:
    """Two stages, weighted by each joint's noise and iterated: columns are replaced by their projection on instruments
    (M, n, c), by default the columns of three rows before.

    shapes, known: further contributions to the spread, as in `least_squares`.
    Raises InputError: instruments of another shape, or fewer rows than parameters.
    """
    nothing = np.empty((*regression.torque.shape, 0))
    shapes, known = (nothing if x is None else x for x in (shapes, known))
    if instruments is None:
        rows, before = lagged(regression.times, LATER)
        instruments, regression = regression.columns[before], regression.part(rows)
        shapes, known = shapes[rows], known[rows]
    if instruments.shape != regression.columns.shape:
        rule = f"must have the columns' shape, {regression.columns.shape}"
        raise InputError(f"instruments of shape {instruments.shape} {rule}", shape=instruments.shape)
    check_size(regression)
    noise = np.ones(regression.torque.shape[1])
    for _ in range(MOST_ROUNDS):
        _, R, z = _second_stage(regression, instruments, noise)
        residuals = regression.residuals(solved(R, z)[0])
        before, noise = noise, np.maximum(np.sqrt(np.mean(residuals**2, axis=0)), np.finfo(float).tiny)
        if np.abs(noise / before - 1.0).max() < SETTLED:
            break
    _, R, z = _second_stage(regression, instruments, noise)
    values = solved(R, z)[0]
    residuals = regression.residuals(values)
    found = _spread(regression, instruments, residuals, noise, shapes, known)
    scale = np.sqrt(found.correlation)
    return Estimate(values, found, noise, R / scale, z / scale, residuals)


def lagged(times: Array, rows: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The rows at times (M,) that have another so many rows earlier, without a gap in between; and those others."""
    step = float(np.median(np.diff(times)))
    if len(times) <= rows:
        raise InputError(f"{len(times)} rows are too few for instruments {rows} rows before: record a longer motion")
    before = np.flatnonzero(times[rows:] - times[:-rows] < (rows + 0.5) * step)
    return before + rows, before


def _spread(
    regression: Regression, instruments: Array, residuals: Array, noise: Array, shapes: Array, known: Array
) -> Spread:
    """shapes (M, n, k), known (M, n, k): as above; shapes are their own instruments."""
    both = regression.with_columns(shapes)
    columns, R, z = _second_stage(both, np.concatenate([instruments, shapes], axis=2), noise)
    _, P, seen = solved(R, z)
    pull = P @ np.einsum("mjc,mjk->ck", columns, known / noise[:, None])
    return spread(columns, residuals / noise, P, seen).first(len(regression.names), pull)


def _second_stage(regression: Regression, instruments: Array, noise: Array) -> tuple[Array, Array, Array]:
    """Weighted columns projected on the instruments (M, n, c), and R x = z of the estimate."""
    shape, weights = instruments.shape, 1.0 / noise[:, None]
    Z, W = ((weights * x).reshape(-1, shape[2]) for x in (instruments, regression.columns))
    y = (regression.torque / noise).reshape(-1)
    U, s, _ = np.linalg.svd(Z / lengths(Z), full_matrices=False)
    U = U[:, s > UNSEEN * s[0]]
    return (U @ (U.T @ W)).reshape(shape), *reduced(U.T @ np.column_stack([W, y]))

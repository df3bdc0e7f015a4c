"""Parameters of a regression by least squares: ordinary, weighted by each joint's noise, or robust to outliers."""

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.special import erf

from cutpoint.arrays import Array
from cutpoint.door import checked_name
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.correlated_noise import NORMAL
from cutpoint.identification.rigid.regression import UNSEEN, Regression, reduced
from cutpoint.identification.rigid.sandwich import Spread, spread
from cutpoint.identification.triangle import lengths

Method = Literal["ordinary", "weighted", "huber"]
METHODS = get_args(Method)

EDGE = 1.345
"""Standard deviations beyond which Huber's weight falls: 95 % as efficient as least squares on normal noise."""

NEARBY = 11
"""Rows over which residuals have similar sizes."""

MOST_ROUNDS = 50
SETTLED = 1e-6
"""Reweighting ends when no joint's noise changes by more than this share of itself."""


class Estimate(NamedTuple):
    """Result of a regression.

    values (c,).  spread: covariance and degrees of freedom.  noise (n,): standard deviation of each joint's residuals,
    by their median where large ones count by their size.
    R (c, c), z (c,): ||R x - z||^2 is the weighted sum of squares beyond its minimum, in which one is a variance.
    residuals (M, n).
    """

    values: Array
    spread: Spread
    noise: Array
    R: Array
    z: Array
    residuals: Array


def least_squares(
    regression: Regression, method: Method = "weighted", shapes: Array | None = None, known: Array | None = None
) -> Estimate:
    """ordinary: equal weights.  weighted: by each joint's noise, iterated.  huber: in addition, residuals beyond 1.345
    standard deviations count linearly, not quadratically.  Huber (1964).

    Directions that the motion does not excite stay zero, with an infinite variance.
    Further contributions to the spread: shapes (M, n, k), the torques' derivatives by parameters fitted to the same
    torques before; known (M, n, k), N m per standard deviation of each known quantity.
    Raises InputError: an unknown method, or fewer rows than parameters.
    """
    checked_name("method of least squares", method, METHODS)
    check_size(regression)
    if method == "huber":
        weights, noise = huber_weights(regression)
    else:
        noise = np.ones(regression.torque.shape[1]) if method == "ordinary" else _noise_and_values(regression)[0]
        weights = np.broadcast_to(1.0 / noise, regression.torque.shape)
    R, z = weighted(regression, weights)
    values = solved(R, z)[0]
    residuals = regression.residuals(values)
    slope = _slope(residuals, noise) if method == "huber" else weights
    found = _spread(regression, residuals, weights, slope, (shapes, known))
    noise = np.sqrt(np.mean(residuals**2, axis=0)) if method != "huber" else noise
    scale = np.sqrt(found.correlation) * (np.sqrt(np.mean((weights * residuals) ** 2)) if method == "ordinary" else 1.0)
    return Estimate(values, found, noise, R / scale, z / scale, residuals)


def _slope(residuals: Array, noise: Array) -> Array:
    """(M, n): slope of Huber's bounded residuals, over the noise.

    It is 1 inside the edge and 0 beyond; here, the expected share inside for residuals as large as those nearby.
    """
    # a running mean is below zero by its rounding, where small residuals follow far larger ones
    size = np.sqrt(np.maximum(uniform_filter1d(residuals**2, NEARBY, axis=0), 0.0))
    share = erf(EDGE * noise / np.maximum(size, np.finfo(float).tiny) / np.sqrt(2.0))
    return np.asarray(np.sqrt(share) / noise)


def _spread(
    regression: Regression, residuals: Array, weights: Array, slope: Array, beside: tuple[Array | None, Array | None]
) -> Spread:
    """slope (M, n): derivative of the weighted residuals by the torques.  beside: shapes and known, as above."""
    nothing = np.empty((*residuals.shape, 0))
    shapes, known = (nothing if x is None else x for x in beside)
    both = regression.with_columns(shapes)
    _, P, seen = solved(*weighted(both, slope))
    found = spread(weights[..., None] * both.columns, weights * residuals, P, seen)
    pull = P @ np.einsum("mjc,mj,mjk->ck", both.columns, slope**2, known)
    return found.first(len(regression.names), pull)


def with_further(regression: Regression, columns: Array) -> Estimate:
    """A robust fit with further columns (M, n, k), whose values are the last."""
    return least_squares(regression.with_columns(columns), "huber")


def check_size(regression: Regression) -> None:
    """Raises InputError for fewer rows than parameters."""
    rows, count, times = regression.torque.size, len(regression.names), regression.times
    if rows < 2 * count:
        whole = 1 + round(float(np.ptp(times) / np.diff(times).min())) if times.size > 1 else 1
        lost = f" (gaps leave {times.size} of {whole} means)" if times.size < whole else ""
        remedy = f"record {'without gaps, or ' * bool(lost)}a longer motion, or raise bandwidth (--bandwidth)"
        rule = f"{rows} torques{lost} are too few for {count} parameters: {remedy}"
        raise InputError(rule, rows=rows, parameters=count)


def solved(R: Array, z: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """x of R x = z, (R^T R)^-1, and which parameters are observable, (c,); unobservable directions are left out."""
    length = lengths(R)
    U, s, Vt = np.linalg.svd(R / length)
    kept = s > UNSEEN * s[0]
    inverse = Vt[kept].T / s[kept]
    seen = (Vt[~kept] ** 2).sum(axis=0) < UNSEEN
    P = inverse @ inverse.T / np.outer(length, length)
    return inverse @ (U[:, kept].T @ z) / length, P, seen


def huber_weights(regression: Regression) -> tuple[Array, Array]:
    """Weights (M, n) that bound each residual's influence, and the noise (n,) without outliers."""
    noise, values = _noise_and_values(regression)
    weights, least = np.ones_like(regression.torque), _rounding(np.linalg.norm(regression.torque, axis=0))
    for _ in range(MOST_ROUNDS):
        residuals = regression.residuals(values)
        before, noise = noise, np.maximum(np.median(np.abs(residuals), axis=0) / NORMAL, least)
        size = np.abs(residuals) / noise
        weights = np.sqrt(np.minimum(1.0, EDGE / np.maximum(size, EDGE))) / noise
        values = solved(*weighted(regression, weights))[0]
        if np.abs(noise / before - 1.0).max() < SETTLED:
            break
    return weights, noise


def weighted(regression: Regression, weights: Array) -> tuple[Array, Array]:
    """R x = z of a regression with weights (M, n), see `reduced`."""
    return reduced(weights[..., None] * regression.rows)


def _noise_and_values(regression: Regression) -> tuple[Array, Array]:
    """Each joint's noise (n,) and the parameters, from only the joints' triangles."""
    factors, rows = regression.factors, len(regression.times)
    noise, values = np.ones(len(factors)), np.zeros(factors.shape[2] - 1)
    for _ in range(MOST_ROUNDS):
        values = solved(*reduced(factors / noise[:, None, None]))[0]
        before, noise = noise, np.linalg.norm(factors @ [*-values, 1.0], axis=1) / np.sqrt(rows)
        noise = np.maximum(noise, _rounding(np.linalg.norm(factors[:, :, -1], axis=1)))
        if np.abs(noise / before - 1.0).max() < SETTLED:
            break
    return noise, values


def _rounding(norms: Array) -> Array:
    """The least noise (n,) of torques of these norms, due to rounding; arbitrary for zero torques."""
    return np.where(norms > 0.0, np.finfo(float).eps * norms, 1.0)

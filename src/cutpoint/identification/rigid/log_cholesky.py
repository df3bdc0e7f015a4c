"""Physical bodies without constraints.  Rucker and Wensing (2022), IEEE Robot. Autom. Lett. 7(2), eq. (11).

X = U U^T with U upper triangular, its diagonal exponentials: any ten numbers give a physical body.  Rotors and
friction, which are single numbers, are bounded instead.
"""

from functools import partial
from typing import Any, Literal

import numpy as np
from scipy.optimize import least_squares

from cutpoint.arrays import Array
from cutpoint.errors import CutpointError
from cutpoint.identification.rigid.physical_fit import Fit

UPPER = np.triu_indices(4)
DIAGONAL = np.flatnonzero(UPPER[0] == UPPER[1])

ENDS = 1e-8
"""Relative change at which the search ends."""

STEPS = 1000

CLEAR = 1e-6
"""Distance from the bound at which the search starts."""


def solve(fit: Fit) -> Array:
    """The unknowns of a fit, starting from the file's bodies.  Raises CutpointError if the search does not converge."""
    bodies, rotors, others = np.zeros(10 * fit.bodies.count), np.ones(fit.scale.size), np.zeros(fit.positive.size)
    # friction starts at least squares with all else as in the file
    files = _unknowns(fit, np.concatenate([bodies, rotors, others]))
    others = np.linalg.lstsq(fit.data[:, fit.first_other :], fit.z - fit.data @ files, rcond=None)[0]
    start = np.concatenate([bodies, rotors, others], dtype=np.float64)
    low = np.concatenate([np.full_like(bodies, -np.inf), np.zeros_like(rotors), np.where(fit.positive, 0.0, -np.inf)])
    high = np.concatenate([np.full_like(bodies, np.inf), np.full_like(rotors, np.inf), fit.most])
    near, _ = _searched(fit, start, low, high, "dogbox")  # may stall where torques are known well
    x, converged = _searched(fit, near, low, high, "trf")  # from the start, would creep along bounds
    if not converged:
        remedy = "check the torques' and positions' units and signs, or try solver='lmi', --solver lmi"
        raise CutpointError(f"the search for physical bodies did not converge in {STEPS} steps: {remedy}")
    return _unknowns(fit, x)


def _searched(fit: Fit, start: Array, low: Array, high: Array, method: Literal["dogbox", "trf"]) -> tuple[Array, bool]:
    """Where a search between bounds ends, and whether it converged."""
    slopes: Any = partial(_slopes, fit)  # SciPy's stubs allow only names
    with np.errstate(over="ignore", invalid="ignore"):  # a step that is too long is rejected
        found = least_squares(
            partial(_residuals, fit),
            np.clip(start, low + CLEAR, high - CLEAR),
            slopes,
            (low, high),
            method=method,
            ftol=ENDS,
            xtol=ENDS,
            gtol=ENDS,
            max_nfev=STEPS,
        )
    return np.asarray(found.x, dtype=np.float64), found.success


def _factors(fit: Fit, x: Array) -> Array:
    """U of each body, (bodies, 4, 4)."""
    U = np.zeros((fit.bodies.count, 4, 4))
    own = x[: 10 * fit.bodies.count].reshape(-1, 10).copy()
    own[:, DIAGONAL] = np.exp(own[:, DIAGONAL])
    U[:, *UPPER] = own
    return U


def _unknowns(fit: Fit, x: Array) -> Array:
    U = _factors(fit, x)
    return np.concatenate([(U @ U.transpose(0, 2, 1)).ravel(), x[10 * fit.bodies.count :]])


def _residuals(fit: Fit, x: Array) -> Array:
    unknowns = _unknowns(fit, x)
    X, rotors, others = fit.unpacked(unknowns)
    apart = np.concatenate([0.5 * (X - np.eye(4)).ravel(), rotors - fit.stated])
    return np.concatenate([fit.data @ unknowns - fit.z, apart / fit.spread, (others - fit.prior) / fit.loose])


def _slopes(fit: Fit, x: Array) -> Array:
    """Derivatives of the residuals, by the chain rule over each body's U."""
    count, first = fit.bodies.count, 10 * fit.bodies.count
    U = _factors(fit, x)
    slope = np.zeros((16 * count + x.size - first, x.size))
    for k, (i, j) in enumerate(zip(*UPPER, strict=True)):
        # d(U U^T) for U_ij alone: column j of U in row i, and mirrored
        turned = np.zeros((count, 4, 4))
        turned[:, i, :] = U[:, :, j]
        turned += turned.transpose(0, 2, 1)
        turned *= U[:, i, i, None, None] if i == j else 1.0
        for body in range(count):
            slope[16 * body : 16 * (body + 1), 10 * body + k] = turned[body].ravel()
    slope[16 * count :, first:] = np.eye(x.size - first)
    bodies, rotors, others = np.split(slope, [fit.first_rotor, fit.first_other])
    others = others / fit.loose[:, None]
    return np.concatenate([fit.data @ slope, 0.5 * bodies / fit.spread, rotors / fit.spread, others])

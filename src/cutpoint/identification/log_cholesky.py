"""Physical bodies without constraints.  Rucker and Wensing (2022), IEEE Robot. Autom. Lett. 7(2), eq. (11).

X = U U^T with U upper triangular, its diagonal exponentials: every ten numbers are a body that can exist.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from cutpoint.errors import CutpointError
from cutpoint.identification.physical import Fit

Array = NDArray[np.float64]

UPPER = np.triu_indices(4)
DIAGONAL = np.flatnonzero(UPPER[0] == UPPER[1])


def solve(fit: Fit) -> Array:
    """The unknowns of a fit, from the file's bodies on.  Raises CutpointError where the search does not end."""
    start = np.zeros(10 * fit.bodies.count + fit.scale.size + fit.positive.size)
    # friction starts at what least squares say where all else is the file's
    others = fit.data[:, fit.first_other :]
    whole = _unknowns(fit, start)[: fit.first_other]
    free = np.linalg.lstsq(others, fit.z - fit.data[:, : fit.first_other] @ whole)[0]
    start[start.size - free.size :] = np.where(fit.positive, np.sqrt(np.maximum(free, 1e-6)), free)
    found = least_squares(lambda x: _residuals(fit, x), start, jac=lambda x: _slopes(fit, x), method="trf", x_scale="jac")
    if not found.success:
        raise CutpointError(f"the search for physical bodies did not end: {found.message}; try solver='lmi'")
    return _unknowns(fit, found.x)


def _factors(fit: Fit, x: Array) -> Array:
    """U of each body, (bodies, 4, 4)."""
    U = np.zeros((fit.bodies.count, 4, 4))
    own = x[: 10 * fit.bodies.count].reshape(-1, 10).copy()
    own[:, DIAGONAL] = np.exp(own[:, DIAGONAL])
    U[:, *UPPER] = own
    return U


def _unknowns(fit: Fit, x: Array) -> Array:
    U = _factors(fit, x)
    rotors, others = np.split(x[10 * fit.bodies.count :], [fit.scale.size])
    return np.concatenate([(U @ U.transpose(0, 2, 1)).ravel(), np.exp(rotors), np.where(fit.positive, others**2, others)])


def _residuals(fit: Fit, x: Array) -> Array:
    unknowns = _unknowns(fit, x)
    X, rotors, _ = fit.unpacked(unknowns)
    apart = np.concatenate([0.5 * (X - np.eye(4)).ravel(), rotors - fit.stated])
    return np.concatenate([fit.data @ unknowns - fit.z, apart / fit.spread])


def _slopes(fit: Fit, x: Array) -> Array:
    """Of the residuals, by the chain rule over each body's U."""
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
    rotors, others = np.split(x[first:], [fit.scale.size])
    rest = np.concatenate([np.exp(rotors), np.where(fit.positive, 2.0 * others, 1.0)])
    slope[16 * count :, first:] = np.diag(rest)
    bodies, rotors = np.split(slope[: fit.first_other], [fit.first_rotor])
    return np.concatenate([fit.data @ slope, 0.5 * bodies / fit.spread, rotors / fit.spread])

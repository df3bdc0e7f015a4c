"""The smoothest spline near given samples: least squares with a penalty on the snap.

Minimises the integral of (s - q)^2 + (d^4 s / dt^4)^2 / (2 pi f)^8.  Away from the ends this is the zero-phase
low-pass filter 1 / (1 + (frequency / f)^8): a Butterworth filter of order 4 run forward and backward.
O'Sullivan (1986), A Statistical Perspective on Ill-Posed Inverse Problems, on penalised B-splines.
"""

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import solveh_banded
from scipy.sparse import csr_array, diags_array, eye_array

from cutpoint.arrays import Array
from cutpoint.trajectories.arrays import durations

DEGREE = 7
"""Twice four, less one: the degree of the exact minimiser, with six continuous derivatives."""

KNOTS_PER_PERIOD = 8
"""Knots in one period of the bandwidth: fine enough not to be seen, and the equations stay well conditioned."""


def smoothing_spline(t: Array, q: Array, bandwidth: float, at_rest: bool) -> tuple[BSpline, float]:
    """The spline, in units of its knot spacing, and that spacing in s.

    t (N,), s, from zero; q (N, n); bandwidth f in Hz, with half a period or more in the duration.  At rest, the first
    four derivatives are zero at both ends.
    """
    intervals = int(np.ceil(t[-1] * bandwidth * KNOTS_PER_PERIOD))
    spacing = float(t[-1] / intervals)
    knots = np.pad(np.arange(intervals + 1.0), DEGREE, mode="edge")
    basis = csr_array(BSpline.design_matrix(np.minimum(t / spacing, intervals), knots, DEGREE))
    weights = diags_array(durations(t) / spacing)
    stiffness = (2.0 * np.pi * bandwidth * spacing) ** -8
    normal = basis.T @ weights @ basis + stiffness * _snap_squared(knots)
    ends = _ends(knots.size - DEGREE - 1, tied=5 if at_rest else 1)
    free = solveh_banded(_upper_bands(csr_array(ends.T @ normal @ ends)), ends.T @ (basis.T @ (weights @ q)))
    return BSpline(knots, ends @ free, DEGREE), spacing


def peak_accelerations(spline: BSpline) -> Array:
    """(n,) at its knots, in its own unit of time."""
    return np.abs(spline(np.unique(spline.t), nu=2)).max(axis=0)


def _snap_squared(knots: Array) -> csr_array:
    """The matrix P of c' P c, the integral of the squared fourth derivative; Gauss's rule of 4 points is exact."""
    snap = csr_array(eye_array(knots.size - DEGREE - 1))
    for degree in range(DEGREE, DEGREE - 4, -1):
        knots = knots[1:-1]
        slope = diags_array(degree / (knots[degree:] - knots[:-degree]))
        snap = csr_array(slope @ (snap[1:] - snap[:-1]))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    starts = np.unique(knots)[:-1, None]
    basis = BSpline.design_matrix((starts + (nodes + 1.0) / 2.0).ravel(), knots, DEGREE - 4)
    values = csr_array(basis) @ snap
    return csr_array(values.T @ diags_array(np.tile(weights / 2.0, starts.size)) @ values)


def _ends(count: int, tied: int) -> csr_array:
    """Expands free coefficients to all: the first `tied` are one and the last are one, which is rest there."""
    owner = np.clip(np.arange(count) - (tied - 1), 0, count - 2 * tied + 1)
    return csr_array((np.ones(count), (np.arange(count), owner)))


def _upper_bands(matrix: csr_array) -> Array:
    """A symmetric banded matrix in LAPACK's upper form."""
    diagonals = [matrix.diagonal(k) for k in range(DEGREE, -1, -1)]
    width = diagonals[-1].size
    bands = [np.pad(diagonal, (width - diagonal.size, 0)) for diagonal in diagonals if diagonal.size]
    return np.array(bands, dtype=np.float64)

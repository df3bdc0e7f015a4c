"""Linear least squares in which some weights cannot be negative: stiffnesses, dampings, friction."""

import numpy as np
from scipy.optimize import lsq_linear

from cutpoint.arrays import Array
from cutpoint.identification.triangle import lengths, triangle


def bounded_weights(columns: Array, target: Array, free: int) -> Array:
    """Least-squares weights, those after the first `free` nonnegative; 0 for zero columns."""
    size = lengths(columns)
    reduced = triangle(np.column_stack([columns / size, target]))
    lower = np.where(np.arange(size.size) < free, -np.inf, 0.0)
    found = lsq_linear(reduced[:, :-1], reduced[:, -1], (lower, np.inf), method="bvls")
    return np.where(columns.any(axis=0), found.x / size, 0.0)

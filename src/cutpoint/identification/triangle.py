"""What least squares need of a tall matrix: its triangular factor, and the lengths of its columns."""

import numpy as np
from scipy.linalg import qr

from cutpoint.arrays import Array

CHUNK = 4096
"""Rows that are in memory, and in the processor's cache, at once."""


def triangle(rows: Array) -> Array:
    """R (k, k) of rows (m, k) = Q R, a chunk at a time."""
    width = rows.shape[1]
    R = np.zeros((0, width))
    for start in range(0, len(rows), CHUNK):
        R = np.asarray(qr(np.concatenate([R, rows[start : start + CHUNK]]), mode="r", check_finite=False)[0])[:width]
    return np.concatenate([R, np.zeros((width - len(R), width))])


def lengths(columns: Array) -> Array:
    """(k,), by which columns (N, k) are divided to be of length one; 1 for zero columns."""
    found = np.linalg.norm(columns, axis=0)
    return np.where(found > 0.0, found, 1.0)

"""How a cost grows with the number of joints: exponents and polynomials."""

from collections.abc import Mapping

import numpy as np

from cutpoint.arrays import Array

_FROM = 4
_TOLERANCE = 0.01


def exponent(values: Mapping[int, float]) -> float | None:
    """Slope of the straight line through log value over log n, n >= 4; None with fewer than three such n."""
    at = {n: x for n, x in values.items() if n >= _FROM}
    if len(at) < 3:
        return None
    return float(np.polyfit(np.log([*at]), np.log([*at.values()]), 1)[0])


def polynomial(counts: Mapping[int, int]) -> Array | None:
    """Coefficients, highest first, of the lowest polynomial in n that tells all counts from n = 2 on to 1 %.

    None where that would take as many coefficients as there are counts.  (A first joint moves on a base at rest, so
    n = 1 is cheaper than the rule.)
    """
    sizes = np.array([n for n in counts if n > 1], dtype=float)
    values = np.array([x for n, x in counts.items() if n > 1], dtype=float)
    for degree in range(1, len(sizes) - 1):
        coefficients = np.polyfit(sizes, values, degree, w=1 / values)
        if np.abs(np.polyval(coefficients, sizes) / values - 1).max() < _TOLERANCE:
            return coefficients
    return None

"""Mass matrices of large robots, inverted."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

from cutpoint.errors import InputError

Array = NDArray[np.float64]

_factors, _inverse = get_lapack_funcs(("potrf", "potri"), dtype=np.float64)


def inverse_of(M: Array) -> Array:
    """Of each symmetric positive definite matrix (..., n, n), by Cholesky's factors: in half of the time that LU takes.

    Raises:
        InputError: one is not positive definite, to rounding.
    """
    inverse = np.empty_like(M)
    for k in np.ndindex(M.shape[:-2]):
        factor, order = _factors(M[k])
        if order:
            told = f"the first {order} rows of the mass matrix are singular to rounding"
            raise InputError(f"forward_dynamics_derivatives: {told}; give light links inertia, or drives rotors")
        half, _ = _inverse(factor, overwrite_c=True)  # zeros below the diagonal
        np.add(half, half.T, out=inverse[k])
    np.einsum("...ii->...i", inverse)[...] /= 2
    return inverse

"""Derivatives of large robots' accelerations, from those of inverse dynamics at these accelerations.

M d_a = d_tau - d(inverse dynamics).  Carpentier and Mansard (2018).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

from cutpoint.drive_slopes import EffortSlopes
from cutpoint.errors import InputError
from cutpoint.mechanics.elastic import Driven

Array = NDArray[np.float64]

_factors, _inverse = get_lapack_funcs(("potrf", "potri"), dtype=np.float64)


def forward_dynamics(d_q: Array, d_v: Array, M: Array) -> tuple[Array, Array, Array]:
    """d a / d (q, v, tau), each (..., nv, nv), from those of inverse dynamics.

    Raises:
        InputError: see `inverse_of`.
    """
    d_tau = inverse_of(M, "forward_dynamics_derivatives")
    return -d_tau @ d_q, -d_tau @ d_v, d_tau


def elastic_forward_dynamics(
    drives: Sequence[Driven], d_q: Array, d_v: Array, M: Array, slopes: EffortSlopes
) -> list[Array]:
    """d a / d (q, v, theta, theta_dot, motor_torque), then those of theta_ddot; rotors do not feel their carriers.

    d_q, d_v, M: of inverse dynamics, (..., nv, nv).  slopes: of the drives, (..., drives) each.

    Raises:
        InputError: see `inverse_of`.
    """
    inverse, at = inverse_of(M, "elastic_forward_dynamics_derivatives"), [d.v for d in drives]
    nv, n, motors, on_link, alpha = M.shape[-1], len(at), [*range(len(at))], slopes[:5], slopes[5:]
    by_link = zip(on_link, (d_q, d_v), strict=False)
    d_a = [inverse @ (_entries(x, at, at, (nv, nv)) - d) for x, d in by_link]
    d_a += [inverse[..., at] * x[..., None, :] for x in on_link[2:]]
    d_alpha = [_entries(x, motors, at, (n, nv)) for x in alpha[:2]]
    d_alpha += [_entries(x, motors, motors, (n, n)) for x in alpha[2:]]
    bends = np.array([[d.drive.is_elastic] for d in drives], bool)  # a rigid drive's motor moves with its link
    return [*d_a, *(np.where(bends, own, links[..., at, :]) for own, links in zip(d_alpha, d_a, strict=True))]


def _entries(x: Array, rows: Sequence[int], columns: Sequence[int], shape: tuple[int, ...]) -> Array:
    """Matrices (..., *shape) with x (..., n) at these places, and zeros elsewhere."""
    found = np.zeros((*x.shape[:-1], *shape))
    found[..., rows, columns] = x
    return found


def inverse_of(M: Array, asked: str) -> Array:
    """Of each symmetric positive definite matrix (..., n, n), by Cholesky's factors: in half of the time that LU takes.

    asked: the function that users called.

    Raises:
        InputError: one is not positive definite, to rounding.
    """
    inverse = np.empty_like(M)
    for k in np.ndindex(M.shape[:-2]):
        factor, order = _factors(M[k])
        if order:
            told = f"the first {order} rows of the mass matrix are singular to rounding"
            raise InputError(f"{asked}: {told}; give light links inertia, or drives rotors")
        half, _ = _inverse(factor, overwrite_c=True)  # zeros below the diagonal
        np.add(half, half.T, out=inverse[k])
    np.einsum("...ii->...i", inverse)[...] /= 2
    return inverse

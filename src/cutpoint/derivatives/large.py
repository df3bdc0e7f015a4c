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
    inverse, nv, n = inverse_of(M, "elastic_forward_dynamics_derivatives"), M.shape[-1], len(drives)
    links, motors, bends = [d.v for d in drives], [*range(n)], [[d.drive.is_elastic] for d in drives]
    # where each drive's q, v, theta, theta_dot and motor_torque stand, and among how many
    columns = [(links, nv)] * 2 + [(motors, n)] * 3
    forces = [_entries(x, links, at, (nv, width)) for x, (at, width) in zip(slopes[:5], columns, strict=True)]
    d_a = [inverse @ x for x in (forces[0] - d_q, forces[1] - d_v, *forces[2:])]
    # a rotor by its own drive's state; a rigid drive's moves with its link
    alpha = [_entries(x, motors, at, (n, width)) for x, (at, width) in zip(slopes[5:], columns, strict=True)]
    return [*d_a, *(np.where(bends, own, of_links[..., links, :]) for own, of_links in zip(alpha, d_a, strict=True))]


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

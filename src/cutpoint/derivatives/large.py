"""Derivatives of large robots' accelerations, from those of inverse dynamics at these accelerations.

M d_a = d_tau - d(inverse dynamics).  Carpentier and Mansard (2018).
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import get_blas_funcs, get_lapack_funcs

from cutpoint.arrays import Array
from cutpoint.drive_slopes import EffortSlopes
from cutpoint.errors import InputError
from cutpoint.mechanics.system import Driven

if TYPE_CHECKING:
    from cutpoint.rolled.equations.solver import Solver

Numbers = NDArray[np.int64]

_factors, _inverse = get_lapack_funcs(("potrf", "potri"), dtype=np.float64)
_product: Any = get_blas_funcs("gemm", dtype=np.float64)


def elastic_forward_dynamics(
    drives: Sequence[Driven],
    q: ArrayLike,
    d_q: Array,
    d_v: Array,
    M: Array,
    slopes: EffortSlopes[Array],
    solver: "Solver | None",
) -> list[Array]:
    """d a / d (q, v, theta, theta_dot, motor_torque), then those of theta_ddot; rotors do not feel their carriers.

    d_q, d_v, M: of inverse dynamics, (..., nv, nv).  slopes: of the drives, (..., drives) each.

    Raises:
        InputError: see `inverse_of`.
    """
    nv, n = M.shape[-1], len(drives)
    links, motors = np.array([d.v for d in drives]), np.arange(n)
    rigid = [k for k, d in enumerate(drives) if not d.drive.is_elastic]
    # each drive's effort acts on its own link, and depends on its own q, v, theta, theta_dot and motor_torque
    B = d_q.copy(), d_v.copy()
    for x, slope in zip(B, slopes[:2], strict=True):
        x[..., links, links] -= slope
    *d_a, inverse = solved(q, M, B, solver, "elastic_forward_dynamics_derivatives")
    by_effort = inverse[..., links]
    d_a += [by_effort * slope[..., None, :] for slope in slopes[2:5]]
    # a rotor depends on its own drive's state; a rigid drive's moves with its link
    columns = [(links, nv)] * 2 + [(motors, n)] * 3
    alpha = [_entries(x, motors, at, (n, width)) for x, (at, width) in zip(slopes[5:], columns, strict=True)]
    for own, of_links in zip(alpha, d_a, strict=True) if rigid else ():
        own[..., rigid, :] = of_links[..., links[rigid], :]
    return [*d_a, *alpha]


def solved(q: ArrayLike, M: Array, B: Sequence[Array], solver: "Solver | None", asked: str) -> list[Array]:
    """Each X with M X + B = 0, and the inverse of M: of d torque / d q and d v, d a / d q, d v and d tau.

    Raises:
        InputError: see `inverse_of`.
    """
    found = solver(solver.state(np.asarray(q, dtype=np.float64), M), *B) if solver else None
    if found is None:
        inverse = inverse_of(M, asked)
        found = [*(_less_products(inverse, b) for b in B), inverse]
    return [*found]


def _less_products(A: Array, B: Array) -> Array:
    """-A B of matrices (..., n, n) and (..., n, width).

    By the library that inverts: NumPy's own has threads too, and on few cores the two would compete.
    """
    found = np.empty_like(B)
    for k in np.ndindex(B.shape[:-2]):
        found[k] = _product(-1.0, B[k].T, A[k].T).T  # it takes column-major arrays
    return found


def _entries(x: Array, rows: Numbers, columns: Numbers, shape: tuple[int, ...]) -> Array:
    """Matrices (..., *shape) with x (..., n) at these entries, and zeros elsewhere."""
    found = np.zeros((*x.shape[:-1], *shape))
    found[..., rows, columns] = x
    return found


def inverse_of(M: Array, asked: str) -> Array:
    """The inverse of each symmetric positive definite matrix (..., n, n), by Cholesky factors: in half the time of LU.

    asked: the function that users called.

    Raises:
        InputError: one is not positive definite, to rounding.
    """
    inverse = np.empty_like(M)
    for k in np.ndindex(M.shape[:-2]):
        factor, order = _factors(M[k])
        if order:
            told = f"the first {order} rows of the mass matrix are singular to rounding"
            raise InputError(f"{asked}: {told}; give light links more inertia, or drives rotors")
        half, _ = _inverse(factor, overwrite_c=True)  # zeros below the diagonal
        np.add(half, half.T, out=inverse[k])
    np.einsum("...ii->...i", inverse)[...] /= 2
    return inverse

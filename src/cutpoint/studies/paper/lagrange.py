"""The Lagrangian formulation, for comparison with virtual decomposition.

Spong, Hutchinson and Vidyasagar (2005), "Robot Modeling and Control", chapter on dynamics: mass matrix from the
Jacobians of the centroids, Christoffel symbols from its derivatives, gravity from the potential energy.  Derivatives
are complex steps, and so exact: q is moved by i h with h so small that h^2 vanishes (Squire and Trapp 1998, SIAM Review
40(1)).
"""

import numpy as np

from cutpoint.arrays import Array
from cutpoint.studies.paper.chain import Chain, Numbers, places

_STEP = 1e-30


def torques(chain: Chain, q: Array, v: Array, a: Array) -> Array:
    """Joint torques (forces on prismatic joints), N m (N), of the motion q, v, a; all (..., n)."""
    inertial = np.einsum("...ij,...j->...i", mass_matrix(chain, q), a)
    quadratic = np.einsum("...ijk,...j,...k->...i", christoffel_symbols(chain, q), v, v)
    return inertial + quadratic + gravity_torques(chain, q)


def mass_matrix(chain: Chain, q: Numbers) -> Numbers:
    """Mass matrix (..., n, n) at q (..., n), real or complex."""
    linear, angular = centroid_jacobians(chain, q)
    R = places(chain, q).rotations
    inertias = R @ chain.inertias @ np.swapaxes(R, -1, -2)
    translation = np.einsum("b,...bxi,...bxj->...ij", chain.masses, linear, linear)
    return translation + np.einsum("...bxi,...bxy,...byj->...ij", angular, inertias, angular)


def centroid_jacobians(chain: Chain, q: Numbers) -> tuple[Numbers, Numbers]:
    """Velocity of each body's centroid and its angular velocity per joint rate, each (..., n bodies, 3, n joints)."""
    at = places(chain, q)
    linear = np.zeros((*q.shape, 3, q.shape[-1]), dtype=q.dtype)
    angular = np.zeros_like(linear)
    for body, joint in _carried(chain):
        axis = at.axes[..., joint, :]
        if chain.kinds[joint] == "revolute":
            linear[..., body, :, joint] = np.cross(axis, at.centroids[..., body, :] - at.origins[..., joint, :])
            angular[..., body, :, joint] = axis
        else:
            linear[..., body, :, joint] = axis
    return linear, angular


def christoffel_symbols(chain: Chain, q: Array) -> Array:
    """Symbols of the first kind (..., i, j, k): (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) / 2."""
    dM = np.imag(mass_matrix(chain, _stepped(q))) / _STEP  # (k, ..., i, j)
    dM = np.moveaxis(dM, 0, -1)
    return (dM + np.swapaxes(dM, -1, -2) - np.moveaxis(dM, -1, -3)) / 2


def potential_energy(chain: Chain, q: Numbers) -> Numbers:
    """Potential energy (...,) in J, zero where the centroids lie at the world's origin."""
    return -np.einsum("b,...bx,x->...", chain.masses, places(chain, q).centroids, chain.gravity)


def gravity_torques(chain: Chain, q: Array) -> Array:
    """Torques (..., n) that hold the robot still at q."""
    return np.moveaxis(np.imag(potential_energy(chain, _stepped(q))) / _STEP, 0, -1)


def _stepped(q: Array) -> Numbers:
    """Copies of q (n, ..., n), the k-th with its k-th coordinate moved along the imaginary axis."""
    n = q.shape[-1]
    steps = np.eye(n).reshape(n, *(1,) * (q.ndim - 1), n)
    return q + 1j * _STEP * steps


def _carried(chain: Chain) -> list[tuple[int, int]]:
    """Pairs (body, joint) where the joint moves the body."""
    pairs = []
    for body in range(len(chain.parents)):
        joint = body
        while joint >= 0:
            pairs.append((body, joint))
            joint = chain.parents[joint]
    return pairs

"""Each body's ten parameters as a factor of its pseudo-inertia, relative to the robot's files.

L = C X C^T with L_0 = C C^T: X is the identity for the file's body, and positive semidefinite for all
physically consistent bodies.  Wensing, Kim and Slotine (2018), IEEE Robot. Autom. Lett. 3(1).
"""

from dataclasses import dataclass, replace

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.bodies.pseudo_inertia import pseudo_inertia
from cutpoint.model.mechanism import Body, Mechanism
from cutpoint.robot import Robot

BASIS = np.array([pseudo_inertia([float(j == k) for j in range(10)]) for k in range(10)], dtype=np.float64)
"""Pseudo-inertia of each of the ten parameters at one, (10, 4, 4)."""

MASS = 1e-3
"""Least mass assumed for a body, as a share of the mean body's, if the file states less."""

RADIUS = 0.03
"""Least radius of gyration in any direction, as a share of the robot's longest distance between joints, as for a thin
rod; for a smaller body, as a share of its own largest one."""

POINT = 0.01
"""Share of that radius: a smaller body is a point."""

THINNEST = 1e-7
"""Least eigenvalue of X that is kept: a flatter body is due to rounding."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """C of each body, (bodies, 4, 4); maps (bodies, 10, 16): ten parameters of each are maps @ X.ravel()."""

    roots: Array
    maps: Array

    @property
    def count(self) -> int:
        return len(self.roots)

    def parameters(self, X: Array) -> Array:
        """(10 bodies,), of X (bodies, 4, 4) projected on the nearest positive definite matrices."""
        values, vectors = np.linalg.eigh(0.5 * (X + X.transpose(0, 2, 1)))
        positive = np.einsum("bik,bk,bjk->bij", vectors, np.maximum(values, THINNEST), vectors)
        return np.einsum("bpk,bk->bp", self.maps, positive.reshape(-1, 16)).ravel()


def bodies_of(robot: Robot) -> Bodies:
    """The file's bodies with the rotors that they carry; points, rods and massless bodies get a small volume."""
    prior = np.tensordot(robot.inertial_parameters.reshape(-1, 10), BASIS, 1)
    mass = max(MASS * float(prior[:, 3, 3].mean()), np.finfo(float).tiny)
    longest = max(float(np.linalg.norm(body.placement[:3, 3])) for body in robot.mechanism.bodies)
    grown = [_with_volume(L, mass, longest) for L in prior]
    roots = np.linalg.cholesky(np.array(grown, dtype=np.float64)).astype(np.float64)
    # L = C X C^T, and p from L by the inverse of the basis
    to_parameters = np.linalg.pinv(BASIS.reshape(10, 16).T)
    maps = np.array([to_parameters @ np.kron(C, C) for C in roots])
    return Bodies(roots, maps)


def with_parameters(mechanism: Mechanism, p: Array) -> Mechanism:
    """The mechanism with other inertial parameters (10 bodies,) of its bodies."""
    new = [_with(body, own) for body, own in zip(mechanism.bodies, p.reshape(-1, 10), strict=True)]
    return replace(mechanism, bodies=tuple(new))


def _with(body: Body, p: Array) -> Body:
    L = np.tensordot(p, BASIS, 1)
    com = L[:3, 3] / L[3, 3]
    S = L[:3, :3] - L[3, 3] * np.outer(com, com)
    return replace(body, mass=float(L[3, 3]), com=com, inertia=np.trace(S) * np.eye(3) - S)


def _with_volume(L: Array, mass: float, longest: float) -> Array:
    """The body, heavy and thick enough, about the same centre.  longest: m, largest distance between the joints."""
    m = max(float(L[3, 3]), mass)
    com = L[:3, 3] / m
    values, vectors = np.linalg.eigh(L[:3, :3] - m * np.outer(com, com))
    own, radius = float(np.sqrt(max(values[-1], 0.0) / m)), RADIUS * (longest or 1.0)
    radius = min(own, radius) if own > POINT * radius else radius
    S = (vectors * np.maximum(values, m * radius**2)) @ vectors.T
    grown = np.empty((4, 4))
    grown[:3, :3] = S + m * np.outer(com, com)
    grown[:3, 3] = grown[3, :3] = m * com
    grown[3, 3] = m
    return grown

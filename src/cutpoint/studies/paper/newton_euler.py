"""The classical recursive Newton-Euler formulation, for comparison with virtual decomposition.

Luh, Walker and Paul (1980), "On-line computational scheme for mechanical manipulators", ASME J. Dyn. Syst. Meas.
Control 102(2): three-vectors, motion outward, balances of force and moment about the centroids, forces inward.
Everything is in world axes.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from cutpoint.arrays import Array
from cutpoint.studies.paper.chain import Chain, Places, places


@dataclass(frozen=True, eq=False)
class Motion:
    """Of one body, in world axes, each (..., 3): angular velocity and acceleration, acceleration of its origin."""

    omega: Array
    alpha: Array
    a: Array

    @classmethod
    def at_rest(cls, samples: tuple[int, ...]) -> Self:
        zero = np.zeros((*samples, 3))
        return cls(zero, zero, zero)

    def acceleration_at(self, r: Array) -> Array:
        """Acceleration of the body's point at r from its origin."""
        return self.a + np.cross(self.alpha, r) + np.cross(self.omega, np.cross(self.omega, r))


def torques(chain: Chain, q: Array, v: Array, a: Array) -> Array:
    """Joint torques (forces on prismatic joints), N m (N), of the motion q, v, a; all (..., n)."""
    at = places(chain, q)
    motions = _outward(chain, at, v, a)
    forces, moments = _inward(chain, at, *_balances(chain, at, motions))
    along = [m if kind == "revolute" else f for kind, f, m in zip(chain.kinds, forces, moments, strict=True)]
    return np.sum(np.stack(along, axis=-2) * at.axes, axis=-1)


def _outward(chain: Chain, at: Places, v: Array, a: Array) -> list[Motion]:
    """Motion of every body from that of the body that carries it."""
    world = Motion.at_rest(v.shape[:-1])
    motions: list[Motion] = []
    for i, parent in enumerate(chain.parents):
        carrier = motions[parent] if parent >= 0 else world
        r = at.origins[..., i, :] - (at.origins[..., parent, :] if parent >= 0 else 0.0)
        axis = at.axes[..., i, :]
        step = _turned if chain.kinds[i] == "revolute" else _slid
        motions.append(step(carrier, r, axis * v[..., i, None], axis * a[..., i, None]))
    return motions


def _turned(carrier: Motion, r: Array, rate: Array, rate_dot: Array) -> Motion:
    """Of a body that turns on its carrier, at r from the carrier's origin."""
    return Motion(
        omega=carrier.omega + rate,
        alpha=carrier.alpha + rate_dot + np.cross(carrier.omega, rate),
        a=carrier.acceleration_at(r),
    )


def _slid(carrier: Motion, r: Array, rate: Array, rate_dot: Array) -> Motion:
    """Of a body that slides on its carrier: the axis turns with the carrier, whence Coriolis' term."""
    return Motion(
        omega=carrier.omega,
        alpha=carrier.alpha,
        a=carrier.acceleration_at(r) + rate_dot + 2 * np.cross(carrier.omega, rate),
    )


def _balances(chain: Chain, at: Places, motions: list[Motion]) -> tuple[list[Array], list[Array]]:
    """Newton's and Euler's equations of every body: net force, and net moment about its centroid, weight carried."""
    forces, moments = [], []
    for i, motion in enumerate(motions):
        R = at.rotations[..., i, :, :]
        inertia = R @ chain.inertias[i] @ np.swapaxes(R, -1, -2)
        arm = at.centroids[..., i, :] - at.origins[..., i, :]
        momentum = np.einsum("...ij,...j->...i", inertia, motion.omega)
        forces.append(chain.masses[i] * (motion.acceleration_at(arm) - chain.gravity))
        moments.append(np.einsum("...ij,...j->...i", inertia, motion.alpha) + np.cross(motion.omega, momentum))
    return forces, moments


def _inward(chain: Chain, at: Places, forces: list[Array], moments: list[Array]) -> tuple[list[Array], list[Array]]:
    """Force through every joint, and moment about its origin: the body's own need and that of the bodies it carries."""
    arms = at.centroids - at.origins
    forces = list(forces)
    moments = [m + np.cross(arms[..., i, :], f) for i, (f, m) in enumerate(zip(forces, moments, strict=True))]
    for i in reversed(range(len(forces))):
        parent = chain.parents[i]
        if parent >= 0:
            r = at.origins[..., i, :] - at.origins[..., parent, :]
            forces[parent] = forces[parent] + forces[i]
            moments[parent] = moments[parent] + moments[i] + np.cross(r, forces[i])
    return forces, moments

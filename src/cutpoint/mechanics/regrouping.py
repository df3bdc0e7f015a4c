"""Base inertial parameters: what of a body's mass the joints cannot tell from its carrier's goes to the carrier.

Gautier and Khalil (1990); Khalil and Dombre (2002) section 9.4.  A body is its `pseudo_inertia` here, the (4, 4) sum
of x x^T dm over its points x = (r, 1).  A pose T takes it to T P T^T.  A part of P made of vectors that the joint's
motion leaves where they are, T x = x, is the same wherever the joint stands and takes no part in its motion, T' x = 0:
both bodies carry it equally well.  For a revolute joint these vectors are its axis' direction and origin.  Nothing asks
for positive mass.  Torques, energies, momentum and mass matrix stay what they are; so do all pivots and columns of the
articulated-body recursion, whose inertias differ by these parts alone.
"""

from collections.abc import Sequence

import numpy as np

from cutpoint.mechanics.placements import NEGLIGIBLE
from cutpoint.model.mechanism import WORLD, Array, Body

UNMOVED: dict[str, tuple[int, ...]] = {
    "revolute": (2, 3), "continuous": (2, 3), "prismatic": (0, 1, 2), "helical": (2,), "planar": (2,),
    "spherical": (3,), "floating": (),
}  # fmt: skip
"""For each kind, which of the directions x, y, z and the origin (3) of its frame its motion leaves where they are."""


def regrouped(bodies: Sequence[Body], own: Sequence[Array], placements: Sequence[Array]) -> list[Array]:
    """Pseudo-inertias (4, 4) after each body has handed on to its carrier what its joint cannot tell from it.

    own: in the frames of the bodies; placements (4, 4) of these frames in their carriers', with joints anywhere.
    What would go to the world stays: it costs nothing, and potential energy keeps its zero.
    """
    P, sizes = [*own], [_size(M) for M in own]
    for i, body in reversed([*enumerate(bodies)]):
        if body.parent != WORLD:
            T, left = placements[i], without_unmoved(P[i], body.joint.kind)
            sizes[body.parent] = sizes[body.parent] + _seen_from(T, sizes[i])
            P[body.parent] = _snapped(P[body.parent] + T @ (P[i] - left) @ T.T, sizes[body.parent])
            P[i] = left
    return P


def without_unmoved(P: Array, kind: str) -> Array:
    """What is left of a pseudo-inertia without all that a joint of this kind leaves where it is."""
    left = P.copy()
    left[np.ix_(UNMOVED[kind], UNMOVED[kind])] = 0.0
    return left


def transformed(T: Array, P: Array) -> Array:
    """The same body in another frame: T P T^T."""
    return _snapped(T @ P @ T.T, _seen_from(T, _size(P)))


def extent(P: Array) -> float:
    """How far from the frame a body's mass lies in the mean of squares, m; 0 without mass."""
    trace, mass = _size(P)
    return float(np.sqrt(trace / mass)) if mass else 0.0


def _snapped(P: Array, size: Array) -> Array:
    """Symmetric, and zero where an entry is nothing beside a body of this size."""
    P = (P + P.T) / 2
    sigma = np.sqrt([size[0], size[0], size[0], size[1]])
    return np.where(np.abs(P) <= NEGLIGIBLE * np.outer(sigma, sigma), 0.0, P)


def _size(P: Array) -> Array:
    """(2,): the trace of the second moment, kg m2, and the mass, kg."""
    return np.array([np.abs(np.diag(P)[:3]).sum(), abs(P[3, 3])])


def _seen_from(T: Array, size: Array) -> Array:
    """The size at most in a frame in which the body's own has the pose T."""
    trace, mass = size
    return np.array([(np.sqrt(trace) + np.linalg.norm(T[:3, 3]) * np.sqrt(mass)) ** 2, mass])

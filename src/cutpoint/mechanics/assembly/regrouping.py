"""Base inertial parameters: mass that the joints cannot tell from their carrier's is moved to the carrier.

Gautier and Khalil (1990); Khalil and Dombre (2002) section 9.4.  A body is its `pseudo_inertia` here, the (4, 4) sum
of x x^T dm over its points x = (r, 1).  A pose T takes it to T P T^T.  A part of P made of vectors that the joint's
motion leaves unchanged, T x = x, is the same at every joint position and takes no part in the motion, T' x = 0: it can
be assigned to either body.  For a revolute joint these vectors are its axis' direction and origin.  Masses need not be
positive.  Torques, energies, momentum and mass matrix stay what they are; so do all pivots and columns of the
articulated-body recursion, whose inertias differ by these parts alone.
"""

from collections.abc import Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.assembly.placements import NEGLIGIBLE
from cutpoint.model.mechanism import WORLD, Body

UNMOVED: dict[str, tuple[int, ...]] = {
    "revolute": (2, 3), "continuous": (2, 3), "prismatic": (0, 1, 2), "helical": (2,), "planar": (2,),
    "spherical": (3,), "floating": (),
}  # fmt: skip
"""For each kind, which of the directions x, y, z and the origin (3) of its frame its motion leaves where they are."""


def regrouped(bodies: Sequence[Body], own: Sequence[Array], placements: Sequence[Array]) -> list[Array]:
    """Pseudo-inertias (4, 4) after moving to each body's carrier the part that its joint cannot tell from it.

    own: in the frames of the bodies; placements (4, 4) of these frames in their carriers', with joints anywhere.
    Parts that would go to the world stay: they cost nothing, and potential energy keeps its zero.
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
    """A pseudo-inertia without the part that a joint of this kind leaves unchanged."""
    left = P.copy()
    left[np.ix_(UNMOVED[kind], UNMOVED[kind])] = 0.0
    return left


def transformed(T: Array, P: Array) -> Array:
    """The same body in another frame: T P T^T."""
    return _snapped(T @ P @ T.T, _seen_from(T, _size(P)))


def extent(P: Array) -> float:
    """Root-mean-square distance of a body's mass from the frame's origin, m; 0 without mass."""
    trace, mass = _size(P)
    return float(np.sqrt(trace / mass)) if mass else 0.0


def _snapped(P: Array, size: Array) -> Array:
    """P made symmetric, with entries set to zero that are negligible for a body of this size."""
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

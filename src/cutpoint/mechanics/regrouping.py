"""Base inertial parameters: what of a body's mass the joints cannot tell from its carrier's goes to the carrier.

Gautier and Khalil (1990); Khalil and Dombre (2002) section 9.4.  A body is its pseudo-inertia, the (4, 4) sum of x x^T dm
over homogeneous points x: second moment, first moment and mass.  A pose T takes it to T P T^T.  A part of P that is
made of vectors which a joint's motion leaves where they are, (T x = x), stays what it is as the joint moves, and takes
no part in its motion (T' x = 0): both bodies carry it equally well.  For a revolute joint these are the direction of its
axis and a point on it.  The rule needs no positive mass: energies, momentum, torques and the mass matrix stay the same,
and so do the pivots and columns of the articulated-body recursion, because its inertias change by these parts alone.
"""

from collections.abc import Sequence

import numpy as np

from cutpoint.model.mechanism import WORLD, Array, Body

UNMOVED: dict[str, tuple[int, ...]] = {
    "revolute": (2, 3), "continuous": (2, 3), "prismatic": (0, 1, 2), "helical": (2,), "planar": (2,),
    "spherical": (3,), "floating": (),
}  # fmt: skip
"""For each kind, which of the directions x, y, z and the origin (3) of its frame its motion leaves where they are."""

ROUNDING = 16 * float(np.finfo(float).eps)
"""A sum this small beside its largest terms is nothing but rounding."""


def pseudo_inertia(body: Body) -> Array:
    """(4, 4): second moment, first moment and mass about the body's own frame; kg m2, kg m, kg."""
    com, P = body.com, np.empty((4, 4))
    P[:3, :3] = np.trace(body.inertia) / 2 * np.eye(3) - body.inertia + body.mass * np.outer(com, com)
    P[:3, 3] = P[3, :3] = body.mass * com
    P[3, 3] = body.mass
    return P


def regrouped(bodies: Sequence[Body], own: Sequence[Array], placements: Sequence[Array]) -> list[Array]:
    """Pseudo-inertias (4, 4) after each body has handed on to its carrier what its joint cannot tell from it.

    own: in the frames of the bodies; placements (4, 4) of these frames in their carriers' at coordinate zero.
    What would go to the world stays: it costs nothing, and potential energy keeps its zero.
    """
    P, sizes = [*own], [np.abs(M) for M in own]
    for i, body in reversed([*enumerate(bodies)]):
        if body.parent != WORLD:
            part, T = np.ix_(UNMOVED[body.joint.kind], UNMOVED[body.joint.kind]), placements[i]
            moved, size = np.zeros((4, 4)), np.zeros((4, 4))
            moved[part], size[part] = P[i][part], sizes[i][part]
            given = T @ moved @ T.T
            borne, borne_size = P[body.parent] + given, sizes[body.parent] + np.abs(T) @ size @ np.abs(T).T
            borne = snapped(borne, borne_size)
            if cost(P[i] - moved) + cost(borne) <= cost(P[i]) + cost(P[body.parent]):
                P[i] = P[i] - moved
                P[body.parent], sizes[body.parent] = (borne + borne.T) / 2, borne_size
    return P


def snapped(P: Array, size: Array) -> Array:
    """Zero where sums of terms of this size have left nothing but rounding."""
    return np.where(np.abs(P) <= ROUNDING * size, 0.0, P)


def cost(P: Array) -> int:
    """Operations that a body's entries other than zero take in inverse dynamics, about."""
    diagonal, products = np.count_nonzero(np.diag(P)[:3]), np.count_nonzero(P[[0, 0, 1], [1, 2, 2]])
    return 4 * diagonal + 9 * products + 10 * np.count_nonzero(P[:3, 3]) + 6 * np.count_nonzero(P[3, 3])

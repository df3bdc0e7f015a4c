"""A body's mass as one matrix, the sum of x x^T dm over its points x = (r, 1): second moment, first moment and mass.

It is positive semidefinite for every body that can exist, and positive definite for every body that has volume.
Wensing, Kim and Slotine (2018).
"""

from collections.abc import Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.bodies.rigid_body import inertia_of, parameters_of
from cutpoint.mechanics.bodies.spatial import Inertia, Mat3, Vec3
from cutpoint.model.mechanism import Body
from cutpoint.scalars import Scalar, sqrt, where

Matrix = list[list[Scalar]]


def pseudo_inertia(p: Sequence[Scalar]) -> Matrix:
    """4 x 4, of ten inertial parameters, in the order of `body_regressor`."""
    return pseudo_inertia_of(inertia_of(p))


def pseudo_inertia_of(M: Inertia) -> Matrix:
    """4 x 4, about the frame that the inertia is about."""
    rows = [[*row, h] for row, h in zip(M.second_moment, M.first_moment, strict=True)]
    return [*rows, [*M.first_moment, M.mass]]


def pseudo_inertia_of_body(body: Body) -> Array:
    """(4, 4), about the body's own frame; kg m2, kg m, kg."""
    com, P = body.com, np.empty((4, 4))
    P[:3, :3] = np.trace(body.inertia) / 2 * np.eye(3) - body.inertia + body.mass * np.outer(com, com)
    P[:3, 3] = P[3, :3] = body.mass * com
    P[3, 3] = body.mass
    return P


def parameters_of_pseudo_inertia(L: Matrix) -> list[Scalar]:
    """The ten parameters of a pseudo-inertia."""
    (xx, xy, xz, hx), (_, yy, yz, hy), (_, _, zz, hz), (_, _, _, m) = L
    rotational = Mat3(Vec3(yy + zz, -xy, -xz), Vec3(-xy, xx + zz, -yz), Vec3(-xz, -yz, xx + yy))
    return parameters_of(Inertia(m, Vec3(hx, hy, hz), rotational))


def nominal_sizes(p: Sequence[Scalar]) -> list[Scalar]:
    """Nominal sizes of ten inertial parameters: mass, mass times radius of gyration, mass times its square."""
    m, *_, xx, _, _, yy, _, zz = p
    radius = sqrt((xx + yy + zz) / (2 * where(m > 0, m, 1)))
    return [m] + [m * radius] * 3 + [m * radius * radius] * 6

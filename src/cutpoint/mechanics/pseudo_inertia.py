"""A body's ten inertial parameters as one matrix, which is positive semidefinite for every body that can exist."""

from collections.abc import Sequence

from cutpoint.mechanics.rigid_body import inertia_of, parameters_of
from cutpoint.mechanics.spatial import Inertia, Mat3, Vec3
from cutpoint.scalars import Scalar, sqrt

Matrix = list[list[Scalar]]


def pseudo_inertia(p: Sequence[Scalar]) -> Matrix:
    """[sum of r r^T dm, h; h^T, m] of ten inertial parameters: positive definite for every body that has volume.

    Wensing, Kim and Slotine (2018).
    """
    M = inertia_of(p)
    rows = [[*row, h] for row, h in zip(M.second_moment, M.first_moment, strict=True)]
    return [*rows, [*M.first_moment, M.mass]]


def parameters_of_pseudo_inertia(L: Matrix) -> list[Scalar]:
    """The ten parameters of a pseudo-inertia."""
    (xx, xy, xz, hx), (_, yy, yz, hy), (_, _, zz, hz), (_, _, _, m) = L
    rotational = Mat3(Vec3(yy + zz, -xy, -xz), Vec3(-xy, xx + zz, -yz), Vec3(-xz, -yz, xx + yy))
    return parameters_of(Inertia(m, Vec3(hx, hy, hz), rotational))


def nominal_sizes(p: Sequence[Scalar]) -> list[float]:
    """How large ten inertial parameters are: mass, that times radius of gyration, that times its square."""
    m, *_, xx, _, _, yy, _, zz = p
    radius = sqrt((xx + yy + zz) / (2 * m)) if m else 0.0
    return [m] + [m * radius] * 3 + [m * radius * radius] * 6

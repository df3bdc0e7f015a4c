"""Records of the mechanics as lists of numbers, as regions keep them, and back."""

from collections.abc import Sequence
from typing import Any

from cutpoint.mechanics.articulated import Articulated
from cutpoint.mechanics.spatial import Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.rolled.subsystem import mat3
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]

UPPER = [(j, k) for j in range(6) for k in range(j, 6)]
"""Entries of a symmetric (6, 6) matrix that are kept."""


def flat(A: Mat3) -> list[Scalar]:
    return [x for row in A for x in row]


def motion_of(six: Scalars) -> Motion:
    return Motion(Vec3(*six[:3]), Vec3(*six[3:]))


def wrench_of(six: Scalars) -> Wrench:
    return Wrench(Vec3(*six[:3]), Vec3(*six[3:]))


def pose_of(twelve: Scalars) -> Pose:
    return Pose(mat3(iter(twelve[:9])), Vec3(*twelve[9:]))


RESISTANCE = len(UPPER) + 6
"""Numbers of an inertia and its bias wrench."""


def packed_resistance(M: Articulated, P: Wrench) -> list[Scalar]:
    return [*(M.rows[j][k] for j, k in UPPER), *P]


def resistance_of(numbers: Scalars) -> tuple[Articulated, Wrench]:
    rows: list[list[Any]] = [[0] * 6 for _ in range(6)]
    for (j, k), x in zip(UPPER, numbers[: len(UPPER)], strict=True):
        rows[j][k] = rows[k][j] = x
    return Articulated(rows), wrench_of(numbers[len(UPPER) :])

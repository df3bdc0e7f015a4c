"""Records of the mechanics as lists of numbers, as stored in regions, and back."""

from collections.abc import Sequence

from cutpoint.mechanics.bodies.articulated import Articulated
from cutpoint.mechanics.bodies.spatial import Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def added(one: Scalars, other: Scalars) -> list[Scalar]:
    """The elementwise sum: what bodies carry, about one point, is a plain sum."""
    return [x + y for x, y in zip(one, other, strict=True)]


def flat(A: Mat3) -> list[Scalar]:
    return [x for row in A for x in row]


def mat3_of(nine: Scalars) -> Mat3:
    return Mat3(*(Vec3(*nine[k : k + 3]) for k in (0, 3, 6)))


def motion_of(six: Scalars) -> Motion:
    return Motion(Vec3(*six[:3]), Vec3(*six[3:]))


def wrench_of(six: Scalars) -> Wrench:
    return Wrench(Vec3(*six[:3]), Vec3(*six[3:]))


def pose_of(twelve: Scalars) -> Pose:
    return Pose(mat3_of(twelve[:9]), Vec3(*twelve[9:]))


def by_columns(X: Pose) -> list[Scalar]:
    """A pose as triples, its rotation in column-major order."""
    return [*flat(X.rotation.T), *X.position]


def pose_by_columns(twelve: Scalars) -> Pose:
    return Pose(mat3_of(twelve[:9]).T, Vec3(*twelve[9:]))


INERTIA = 3 * 9
"""Numbers of an articulated inertia."""

RESISTANCE = INERTIA + 6
"""The same with its bias wrench."""


def packed_inertia(M: Articulated) -> list[Scalar]:
    """As triples: the rows of its blocks."""
    return [x for block in (M.linear, M.coupling, M.angular) for x in flat(block)]


def articulated_of(numbers: Scalars) -> Articulated:
    return Articulated.of_blocks(*(mat3_of(numbers[k : k + 9]) for k in (0, 9, 18)))


def packed_resistance(M: Articulated, P: Wrench) -> list[Scalar]:
    """As triples, the wrench last."""
    return [*packed_inertia(M), *P]


def resistance_of(numbers: Scalars) -> tuple[Articulated, Wrench]:
    return articulated_of(numbers), wrench_of(numbers[INERTIA:])

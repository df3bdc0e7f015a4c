"""Comparisons by the numbers of the equations they hold to account."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutpoint.mechanics.bodies.spatial import Inertia, Mat3, Motion, Pose, Vec3, Wrench

Array = NDArray[np.float64]
Pairs = list[tuple[Any, Any]]
Comparison = Callable[[np.random.Generator], Pairs]

AGREEMENTS: dict[str, Comparison] = {}


def equations(*numbers: str) -> Callable[[Comparison], Comparison]:
    """Registers a comparison under the equations it covers."""

    def register(comparison: Comparison) -> Comparison:
        assert not AGREEMENTS.keys() & set(numbers)
        AGREEMENTS.update(dict.fromkeys(numbers, comparison))
        return comparison

    return register


def six(x: Motion | Wrench) -> Array:
    return np.array([*x], float)


def motion(x: Array) -> Motion:
    return Motion(Vec3(*x[:3]), Vec3(*x[3:]))


def wrench(x: Array) -> Wrench:
    return Wrench(Vec3(*x[:3]), Vec3(*x[3:]))


def pose(R: Array, p: Array) -> Pose:
    return Pose(mat3(R), Vec3(*p))


def mat3(A: Array) -> Mat3:
    return Mat3(*(Vec3(*row) for row in A))


def matrix(linear: Callable[[Array], Motion | Wrench]) -> Array:
    """(6, 6) of a linear function of six numbers."""
    return np.column_stack([six(linear(unit)) for unit in np.eye(6)])


def inertia(m: float, r: Array, I: Array) -> Inertia:
    """From mass, centroid and the tensor about it."""
    return Inertia(m, Vec3(*(m * r)), mat3(I + m * (r @ r * np.eye(3) - np.outer(r, r))))

"""Arrays as the scalars of the recursions: whole numbers where they are 0, 1 or -1."""

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.bodies.spatial import Inertia, Mat3, Pose, Vec3
from cutpoint.scalars import Scalar


def inertia_from(P: Array) -> Inertia:
    """From a pseudo-inertia (4, 4)."""
    S, h, m = P[:3, :3], P[:3, 3], P[3, 3]
    x, y, z = np.diag(S)  # summed so that a second moment of 0 stays exactly 0
    return Inertia(number(m), vec3(h), mat3(np.diag([y + z, z + x, x + y]) + (np.diag([x, y, z]) - S)))


def number(x: float) -> Scalar:
    """A float, or a whole number where it is 0, 1 or -1, so that it vanishes when traced and stays exact."""
    return int(x) if x in (-1.0, 0.0, 1.0) else float(x)


def vec3(v: Array) -> Vec3:
    return _vec3(v.tolist())


def mat3(A: Array) -> Mat3:
    return Mat3(*map(_vec3, A.tolist()))


def pose_of(matrix: Array) -> Pose:
    """A (4, 4) pose as scalars."""
    return Pose(mat3(matrix[:3, :3]), vec3(matrix[:3, 3]))


def _vec3(v: list[float]) -> Vec3:
    return Vec3(*map(number, v))

"""Rigid placements as plain 4x4 matrices, child to parent coordinates, as far as model descriptions need them."""

import numpy as np

from cutpoint.arrays import Array

RIGID_TOLERANCE = 1e-9
"""How far R R^T may be from the identity, per entry."""


def pose(rotation: Array, translation: Array) -> Array:
    """(4, 4) placement of a rotation (3, 3) and a translation (3,) in m."""
    placement = np.eye(4)
    placement[:3, :3], placement[:3, 3] = rotation, translation
    return placement


def rotation_about(axis: Array, angle: float) -> Array:
    """(3, 3) turn by an angle (rad) about a unit axis (3,): Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)


def unit_vector(direction: Array) -> Array:
    """(3,) along a direction of any length: a power of two, which rounds nothing, brings it near 1 before squaring."""
    near = np.ldexp(direction, -np.frexp(np.max(np.abs(direction)))[1])
    return near / np.linalg.norm(near)


def roll_pitch_yaw(angles: Array) -> Array:
    """(3, 3) rotation Rz(yaw) Ry(pitch) Rx(roll) of fixed-axis angles (3,) in rad, in the order URDF states them."""
    x, y, z = np.eye(3)
    roll, pitch, yaw = angles
    return rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)


def is_rigid(placement: Array) -> bool:
    """Whether a (4, 4) matrix is a proper rotation and a translation, within RIGID_TOLERANCE."""
    rotation = placement[:3, :3]
    orthonormal = np.allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=RIGID_TOLERANCE)
    proper = np.linalg.det(rotation) > 0.0
    return bool(orthonormal and proper and np.array_equal(placement[3], (0.0, 0.0, 0.0, 1.0)))

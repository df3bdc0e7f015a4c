"""Logs of a machine that never was: two joints that move smoothly, and the torque that a simple law gives them."""

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification import Recording

Array = NDArray[np.float64]

PERIOD = 1e-3

JOINTS = ("shoulder", "elbow")


def times(count: int = 2000) -> Array:
    return PERIOD * np.arange(count)


def positions(time: Array, order: int = 0) -> Array:
    """(N, 2), rad: sums of three sines of 0.4-2.3 Hz, or their time derivative of an order."""
    frequency = 2.0 * np.pi * np.array([[0.4, 0.5], [1.1, 1.3], [2.3, 1.9]])
    size = np.array([[0.5, 0.4], [0.2, 0.3], [0.05, 0.04]])
    phase = 0.5 * np.pi * order + np.array([[0.3, 1.0], [2.0, 0.1], [0.7, 0.4]])
    waves = size * frequency**order * np.sin(frequency * time[:, None, None] + phase)
    return waves.sum(axis=1)


def recording(count: int = 2000) -> Recording:
    time = times(count)
    q, v = positions(time), positions(time, 1)
    return Recording(time, JOINTS, q=q, theta=q.copy(), v=v, theta_dot=v.copy(), torque=positions(time, 2) + 2.0 * v)

"""Records that a robot's functions return."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ElasticTorques(NamedTuple):
    """Motor torques and motion for a motion; at the joint's side, one entry per drive (joint_torque: per speed).

    motor_torque (N m), theta (rad), theta_dot (rad/s), theta_ddot (rad/s2), joint_torque (N m).
    """

    motor_torque: Array
    theta: Array
    theta_dot: Array
    theta_ddot: Array
    joint_torque: Array


class ElasticAccelerations(NamedTuple):
    """Accelerations of the links' coordinates, a (..., nv), and of the motors, theta_ddot (..., drives); rad/s2."""

    a: Array
    theta_ddot: Array

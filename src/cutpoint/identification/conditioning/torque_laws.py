"""Components of a joint's torque, to find how much later it was sampled than the motion: laws for `clock_skew`."""

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import checked_name
from cutpoint.identification.conditioning.clock_skew import Law
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot

CROSSING = 0.05
"""Smoothing of dry friction's sign change, as a share of the RMS speed."""


def single_joint_torque(q: Array, v: Array, a: Array) -> Array:
    """Components of the torque of a joint that moves alone, a law for `clock_skew`: inertia, friction, gravity.

    q, v, a: its motion, (N, 1) arrays, rad, rad/s, rad/s2; they are not checked.  Returns (N, 5), whose columns are a,
    v, the smoothed sgn of v, sin q and cos q; (N, 4), without sgn, of a joint at rest.
    On an arm whose other joints move too, their reactions on this one look like a delay: use `arm_torque`.
    """
    return np.column_stack([a, _friction(v), np.sin(q), np.cos(q)])


def arm_torque(robot: Robot, joint: str) -> Law:
    """Components of the torque of one joint of an arm, from the motion of all: rigid bodies, rotor, friction.

    A law for `clock_skew`, whose y is then q (N, n) of all joints, in the robot's order.
    Raises InputError for an unknown joint.
    """
    check_robot("arm_torque", robot)
    row = robot.joints.index(checked_name("driven joint", joint, robot.joints))

    def law(q: Array, v: Array, a: Array) -> Array:
        bodies = robot.regressor(q, v, a)[:, row, :]
        return np.column_stack([bodies[:, np.ptp(bodies, axis=0) > 0.0], a[:, row], _friction(v[:, [row]])])

    return law


def _friction(v: Array) -> Array:
    """Viscous and dry friction, (N, 2); they cannot be separated for a joint at rest."""
    crossing = CROSSING * float(np.sqrt(np.mean(v**2)))
    return np.column_stack([v, np.tanh(v / crossing)]) if crossing else v

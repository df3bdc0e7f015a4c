"""What a joint's torque is composed of, to see how much later it was sampled than the motion: laws for `clock_skew`."""

import numpy as np
from numpy.typing import NDArray

from cutpoint.door import checked_name
from cutpoint.identification.conditioning.clock_skew import Law
from cutpoint.robot import Robot, check_robot

Array = NDArray[np.float64]

CROSSING = 0.05
"""Of the RMS speed: dry friction changes sign over that."""


def single_joint_torque(q: Array, v: Array, a: Array) -> Array:
    """Of a joint that moves alone, q (N, 1): inertia, friction, gravity.

    On an arm whose other joints move too, what they exert on this one passes for a delay: take `arm_torque`.
    """
    return np.column_stack([a, _friction(v), np.sin(q), np.cos(q)])


def arm_torque(robot: Robot, joint: str) -> Law:
    """Of one joint of an arm, from the motion of all its joints: rigid bodies of any inertia, rotor, friction.

    Raises InputError for an unknown joint.
    """
    check_robot("arm_torque", robot)
    row = robot.joints.index(checked_name("driven joint", joint, robot.joints))

    def law(q: Array, v: Array, a: Array) -> Array:
        bodies = robot.regressor(q, v, a)[:, row, :]
        return np.column_stack([bodies[:, np.ptp(bodies, axis=0) > 0.0], a[:, row], _friction(v[:, [row]])])

    return law


def _friction(v: Array) -> Array:
    """Viscous and dry, (N, 2); of a joint at rest there is nothing to tell apart."""
    crossing = CROSSING * float(np.sqrt(np.mean(v**2)))
    return np.column_stack([v, np.tanh(v / crossing)]) if crossing else v

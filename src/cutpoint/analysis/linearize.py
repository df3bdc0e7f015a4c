"""A robot with elastic joints, linearised: Jacobians of its equations of motion, exact to rounding."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.analysis.derivatives import kernels_of
from cutpoint.analysis.linear_model import LinearModel, OperatingPoint
from cutpoint.door import checked_array
from cutpoint.errors import InputError
from cutpoint.robot import Robot

Array = NDArray[np.float64]


def linearize(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike | None = None,
    motor_torque: ArrayLike | None = None,
    *,
    friction: bool = False,
) -> LinearModel:
    """The linear model of a robot near a state; derivatives by first-order jets, no step size to choose.

    By default the robot rests: v is zero, each motor leads its link by what gravity bends the drive, and motor torques
    balance gravity.  With v, motors move as at constant speed.  motor_torque replaces the balancing one.  Where nothing
    drives a joint that gravity pulls at (a floating base), there is no equilibrium: see `LinearModel.drift`.

    friction=False leaves friction out and shows the structure: resonances and anti-resonances, damped by the springs'
    own damping only.  friction=True takes its slope at v.  At rest that is the slope of the smoothed sgn, about static /
    smoothing (N m s/rad), steep: it is right only for speeds well below `smoothing`, where the drive creeps.  A joint
    that swings faster sees far less damping, one that dry friction holds sees a lock; a linear model knows neither.

    Args:
        q: (nq,) rad (m).  v: (nv,) rad/s.  motor_torque: (drives,) N m at the joint's side.

    Raises:
        InputError: a wrong shape or number, a batch, or v on a joint of several coordinates (its tangent frame turns).
    """
    point = _operating_point(robot, q, v, motor_torque, friction)
    drift, by_state, by_torque = _accelerations(robot, point, friction)
    n, e, drives = robot.nv, len(_elastic(robot)), robot.machine.drives
    A, B = np.zeros((2 * n + 2 * e, 2 * n + 2 * e)), np.zeros((2 * n + 2 * e, len(drives)))
    speeds, accelerations = np.r_[n : 2 * n, 2 * n + e : 2 * (n + e)], np.r_[n : 2 * n, 2 * n + e : 2 * (n + e)]
    A[np.r_[0:n, 2 * n : 2 * n + e], speeds] = 1.0
    A[accelerations], B[accelerations] = by_state, by_torque
    still = np.zeros(A.shape[0])
    still[np.r_[0:n, 2 * n : 2 * n + e]] = np.r_[point.v, point.theta_dot[_elastic(robot)]]
    still[accelerations] = drift
    C = _outputs(robot)
    return LinearModel(
        A, B, C, np.zeros((len(C), len(drives))), still, *_names(robot), robot.joints, point, friction
    )  # fmt: skip

"""The baseline model: rigid bodies, Coulomb and viscous friction and an offset by ordinary least squares.

The benchmark for the full identification.  Bodies need not be physical, all joints have equal weights, and friction
changes its sign at reversals.  Gautier (1997), ICRA, for the filters that torques and columns share.
"""

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.decimation import decimation
from cutpoint.identification.conditioning.motion import Motion, slide_with_motors, sliding_speeds
from cutpoint.identification.rigid.base_parameters import BaseParameters, base_parameters
from cutpoint.identification.rigid.least_squares import least_squares
from cutpoint.identification.rigid.regression import regression
from cutpoint.identification.rigid.rigid_robot import RigidModel, coulomb_laws, laws_with
from cutpoint.robot import Robot


def plain_model(robot: Robot, motion: Motion, torque: Array, fitted: NDArray[np.bool_], width: float) -> RigidModel:
    """The model of torques (N, n), N m at the joint, explained up to a width, Hz, from the fitted samples (N,).

    Raises InputError: too few samples.
    """
    base = base_parameters(robot, rotors=True)
    laws = coulomb_laws(robot, sliding_speeds(robot, motion)[fitted])
    known = motion.known() & np.isfinite(torque).all(axis=1)
    found = regression(base, laws, motion, torque, decimation(known & fitted, motion.period, width))
    values = least_squares(found, "ordinary").values
    inertial, rotors = _single(base, values)
    others = dict(zip(found.names[base.independent.size :], values[base.independent.size :].tolist(), strict=True))
    offsets = np.array([others[f"offset.{joint}"] for joint in robot.joints])
    return RigidModel(inertial, rotors, offsets, laws_with(laws, others), {}, slide_with_motors(robot), {})


def _single(base: BaseParameters, values: Array) -> tuple[Array, Array]:
    """Inertial parameters (10 bodies,) and rotors (n,), zero except those that stand for combinations."""
    found = np.zeros(len(base.parameters))
    found[base.independent] = values[: base.independent.size]
    bodies = 10 * len(base.robot.mechanism.bodies)
    return found[:bodies], found[bodies:]

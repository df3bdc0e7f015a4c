"""The yardstick: what plain least squares say of a motion's torques, whatever bodies they need for it."""

import numpy as np
import pytest
from machine_logs import PERIOD, positions, times
from two_joints import two_joints

from cutpoint import Coulomb, Robot
from cutpoint.errors import InputError
from cutpoint.identification import Recording
from cutpoint.identification.conditioning.motion import Motion, motion_of
from cutpoint.identification.output.plain_model import plain_model
from cutpoint.identification.rigid.rigid_robot import AT_REST

Array = np.ndarray

COUNT, WIDTH = 8000, 10.0


def moved(robot: Robot) -> Motion:
    return motion_of(robot, Recording(times(COUNT), robot.joints, q=positions(times(COUNT))), 20.0)


def torque_of(robot: Robot, motion: Motion, bodies: float, fitted: Array) -> Array:
    """Of so many times its bodies, 3 and 2 of Coulomb and viscous friction, and offsets."""
    found = np.full(motion.q.shape, np.nan)
    known = motion.known()
    found[known] = robot.regressor(motion.q[known], motion.v[known], motion.a[known]) @ robot.inertial_parameters
    sizes = np.sqrt(np.nanmean(motion.v[fitted] ** 2, axis=0))
    friction = [Coulomb(3.0, 2.0, AT_REST * size).torque(v) for size, v in zip(sizes, motion.v.T, strict=True)]
    return bodies * found + np.column_stack(friction) + [0.5, -0.7]


@pytest.mark.parametrize("bodies", [1.3, 0.0, -1.0])
def test_torques_that_it_can_explain_it_explains_wholly_even_by_bodies_that_cannot_exist(bodies: float):
    robot = two_joints()
    motion, fitted = moved(robot), times(COUNT) < 0.7 * COUNT * PERIOD
    torque = torque_of(robot, motion, bodies, fitted)
    found = plain_model(robot, motion, torque, fitted, WIDTH).torque(robot, motion)
    known = np.isfinite(torque).all(axis=1)
    assert np.abs(found - torque)[known].max() < 1e-9 * np.abs(torque[known]).max()


def test_what_is_held_out_has_no_part_in_it():
    robot = two_joints()
    motion, fitted = moved(robot), times(COUNT) < 0.7 * COUNT * PERIOD
    torque = torque_of(robot, motion, 1.0, fitted)
    other = torque + np.where(fitted, 0.0, 100.0)[:, None]
    one, same = (plain_model(robot, motion, x, fitted, WIDTH) for x in (torque, other))
    assert np.array_equal(one.inertial, same.inertial) and np.array_equal(one.offsets, same.offsets)


def test_too_short_a_log_is_refused():
    robot = two_joints()
    motion = moved(robot)
    with pytest.raises(InputError, match=r"torques are too few for \d+ parameters"):
        plain_model(robot, motion, torque_of(robot, motion, 1.0, motion.known()), times(COUNT) < 0.7, WIDTH)

"""Limits in force: of robot file, drives and motors."""

import numpy as np
import pytest

from cutpoint import Drive, Motor, Robot
from cutpoint.model import Joint, Limits, Link
from cutpoint.model.build import build


def two_joints(**drives: Drive) -> Robot:
    link = Link("base", 1.0, np.zeros(3), 0.1 * np.eye(3))
    links = [link, *(Link(name, 1.0, np.zeros(3), 0.1 * np.eye(3)) for name in ("upper", "lower"))]
    place = np.eye(4)
    joints = [
        Joint("shoulder", "revolute", "base", "upper", place, limits=Limits(-1.0, 2.0, velocity=3.0, effort=50.0)),
        Joint("elbow", "revolute", "upper", "lower", place, limits=Limits(effort=0.0)),
    ]
    return Robot(build("arm", links, joints), drives)


def test_the_tighter_of_joint_and_drive_is_in_force() -> None:
    robot = two_joints(shoulder=Drive(100.0, limits=Limits(-2.0, 1.0, velocity=5.0, effort=40.0)))
    assert robot.limits["shoulder"] == Limits(-1.0, 1.0, velocity=3.0, effort=40.0)
    assert robot.limits["elbow"] == Limits()


def test_positions_that_no_joint_reaches_limit_nothing() -> None:
    """As files state them, 1e16 in SDF, for joints that turn on and on."""
    robot = two_joints(shoulder=Drive(limits=Limits(-0.5)), elbow=Drive(limits=Limits(-1e16, 1e16)))
    assert robot.limits["shoulder"] == Limits(-0.5, 2.0, velocity=3.0, effort=50.0)
    assert robot.limits["elbow"] == Limits()


@pytest.mark.parametrize(("current", "shoulder", "elbow"), [(None, 50.0, np.inf), (4.0, 40.0, 20.0), (9.0, 50.0, 45.0)])
def test_a_motor_exerts_no_more_than_its_current_and_the_joint_allow(
    current: float | None, shoulder: float, elbow: float
) -> None:
    motor = Motor(torque_constant=0.1, current_limit=current)
    robot = two_joints(shoulder=Drive(100.0, motor=motor), elbow=Drive(-50.0, motor=motor))
    assert robot.effort_limits == pytest.approx([shoulder, elbow], rel=1e-15)
    assert not robot.effort_limits.flags.writeable

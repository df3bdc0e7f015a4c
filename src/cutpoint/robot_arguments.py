"""Arguments that are a robot, or a pose of one."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutpoint import door
from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.functions.quaternions import check_quaternions, quaternions_of
from cutpoint.model.limits import check_configuration
from cutpoint.robot import Robot

A_ROBOT = "a Robot (cutpoint.load reads files)"

STANDS = "every joint must have one; if it stands still, as a base on the ground, make it fixed in the robot file"
"""Why identification asks for motors, and what to do."""


def check_robot(function: str, robot: Any) -> None:
    """Raises InputError for an argument that is no robot.  function: who asks."""
    door.check_kind(function, "robot", robot, Robot, A_ROBOT)


def check_all_driven(name: str, robot: Robot, rule: str) -> None:
    """Raises InputError for anything but a robot, and if a joint has no drive.

    name: the caller.  rule: why that matters, and what to do.
    """
    check_robot(name, robot)
    driven = {d.v for d in robot.machine.drives}
    for body, own in zip(robot.mechanism.bodies, robot.machine.system.segments, strict=True):
        if own.v.start not in driven:
            what = "a floating base" if body.joint.kind == "floating" else f"a {body.joint.kind} joint"
            raise InputError(f"{name}: {what} has no motor ({body.joint.name!r}): {rule}", joint=body.joint.name)


def checked_pose(function: str, robot: Robot, q: ArrayLike) -> Array:
    """A single configuration (nq,).

    Raises InputError for another shape, a number that is not finite, a zero quaternion, and for positions far beyond
    limits, as if in degrees or mm.  function: who asks.
    """
    several = [body.joint for body in robot.mechanism.bodies if body.joint.kind in ("planar", "spherical", "floating")]
    if several and np.shape(q) == (len(robot.joints),):
        what = f"{several[0].kind} joint {several[0].name!r} has coordinates too, {robot.nq} are needed in all"
        told = f"{function}: q has one entry for each drive, but {what}: start from robot.neutral()"
        raise InputError(told, name="q")
    pose = door.checked_array(function, "q", q, robot.nq)
    if pose.ndim != 1:
        raise InputError(f"{function}: q has shape {pose.shape}; give a single configuration, ({robot.nq},)", name="q")
    check_quaternions(function, "q", pose, quaternions_of(robot.mechanism, robot.machine.system))
    check_configuration(robot.mechanism, pose[[d.q for d in robot.machine.drives]].tolist())
    return pose

"""A robot as linear models need it, with friction or without: by its size compiled, as loops over bodies, or swept."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint import derivatives
from cutpoint.analysis.derivatives import frictionless, kernels_of, steady_motion
from cutpoint.derivatives import sweeps
from cutpoint.derivatives.sweeps import Slopes
from cutpoint.functions.idle_joints import check_moves_inertia
from cutpoint.robot import ElasticTorques, Robot

Array = NDArray[np.float64]


class Plant(NamedTuple):
    """steady(q, v): what motors do for a motion at constant speed.

    slopes(q, v, theta, theta_dot, motor_torque): [a; theta_ddot] of all motors, and how fast they change by each number
    of the state, by those of q along the directions of the speeds.
    """

    steady: Callable[[Array, Array], ElasticTorques]
    slopes: Callable[..., Slopes]


def plant_of(robot: Robot, friction: bool) -> Plant:
    """Raises ModelError: a joint moves no inertia."""
    if derivatives.elastic_loops(robot):
        return _looped(robot if friction else _bare(robot))
    return _swept(robot if friction else _bare(robot)) if sweeps.is_swept(robot) else _compiled(robot, friction)


def _compiled(robot: Robot, friction: bool) -> Plant:
    kernels, parameters = kernels_of(robot, friction), robot.drive_parameters
    return Plant(lambda q, v: kernels.steady(q, v, parameters), lambda *state: kernels.slopes(*state, parameters))


def _looped(robot: Robot) -> Plant:
    still = np.zeros(robot.nv)

    def slopes(*state: Array) -> Slopes:
        value, found = robot.elastic_forward_dynamics(*state), derivatives.elastic_forward_dynamics(robot, *state)
        return Slopes(np.concatenate(value), np.block([[*found[:5]], [*found[5:]]]))

    return Plant(lambda q, v: robot.elastic_inverse_dynamics(q, v, still, still, still), slopes)


def _swept(robot: Robot) -> Plant:
    check_moves_inertia(robot.mechanism, robot.machine)

    def steady(q: Array, v: Array) -> ElasticTorques:
        found = steady_motion(robot.machine, robot.derivatives_needed, q.tolist(), v.tolist())
        return ElasticTorques(*(np.array(x, float) for x in found))

    def slopes(*state: Array) -> Slopes:
        return Slopes(*sweeps.swept(sweeps.accelerations, robot.machine, *(x.tolist() for x in state)))

    return Plant(steady, slopes)


@lru_cache(maxsize=16)
def _bare(robot: Robot) -> Robot:
    """The robot without friction, the same one at each call: it keeps what it has compiled."""
    return robot.with_drives({k: frictionless(drive) for k, drive in robot.drives.items()})

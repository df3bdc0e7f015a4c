"""A robot's functions for linear models, with friction or without: by size compiled, as loops over bodies, or swept."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from cutpoint import definitions, derivatives, kernels
from cutpoint.arrays import Array
from cutpoint.definitions import Machine
from cutpoint.derivatives import sweeps
from cutpoint.derivatives.definitions import elastic_forward_dynamics
from cutpoint.derivatives.functions import elastic_loops
from cutpoint.derivatives.sweeps import Slopes
from cutpoint.functions.idle_joints import check_moves_inertia
from cutpoint.kernels import Kernel
from cutpoint.mechanics.elastic_inverse import ElasticTorques
from cutpoint.model import Drive
from cutpoint.robot import Robot

Scalars = list[Any]


class Plant(NamedTuple):
    """steady(q, v): the motors' state and torques for a motion at constant speed.

    slopes(q, v, theta, theta_dot, motor_torque): [a; theta_ddot] of all motors, and their derivatives by each number
    of the state, by q along the directions of the speeds.
    """

    steady: Callable[[Array, Array], ElasticTorques[Array]]
    slopes: Callable[..., Slopes]


def plant_of(robot: Robot, friction: bool) -> Plant:
    """Raises ModelError: a joint moves no inertia."""
    if elastic_loops(robot):
        return _looped(robot if friction else _bare(robot))
    return _swept(robot if friction else _bare(robot)) if sweeps.is_swept(robot) else _compiled(robot, friction)


def _compiled(robot: Robot, friction: bool) -> Plant:
    own, parameters = kernels_of(robot, friction), robot.drive_parameters
    return Plant(lambda q, v: own.steady(q, v, parameters), lambda *state: own.slopes(*state, parameters))


def _looped(robot: Robot) -> Plant:
    still = np.zeros(robot.nv)

    def slopes(*state: Array) -> Slopes:
        value, found = robot.elastic_forward_dynamics(*state), derivatives.elastic_forward_dynamics(robot, *state)
        return Slopes(np.concatenate(value), np.block([[*found[:5]], [*found[5:]]]))

    return Plant(lambda q, v: robot.elastic_inverse_dynamics(q, v, still, still, still), slopes)


def _swept(robot: Robot) -> Plant:
    check_moves_inertia(robot.mechanism, robot.machine)

    def steady(q: Array, v: Array) -> ElasticTorques[Array]:
        found = steady_motion(robot.machine, robot.derivatives_needed, q.tolist(), v.tolist())
        return ElasticTorques(*(np.array(x, float) for x in found))

    def slopes(*state: Array) -> Slopes:
        return Slopes(*sweeps.swept(sweeps.accelerations, robot.machine, *(x.tolist() for x in state)))

    return Plant(steady, slopes)


@lru_cache(maxsize=16)
def _bare(robot: Robot) -> Robot:
    """The robot without friction, the same one at each call: it keeps what it has compiled."""
    return robot.with_drives({k: frictionless(drive) for k, drive in robot.drives.items()})


class Kernels(NamedTuple):
    """steady(q, v, parameters): a motion at constant speed.

    slopes(q, v, theta, theta_dot, motor_torque, parameters): see `Plant`.
    """

    steady: Kernel
    slopes: Kernel


@dataclass(frozen=True)
class _Structure:
    """Cache key of a trace: equal for robots that differ in their drives' numbers only.

    It holds the robot, because the key identifies the mechanism by object identity.
    """

    key: Hashable
    friction: bool
    robot: Robot = field(compare=False)


def kernels_of(robot: Robot, friction: bool) -> Kernels:
    """The kernels of a robot, with its friction or without.  Raises ModelError: a joint moves no inertia."""
    return _made(_Structure(robot.trace_key, friction, robot))


@lru_cache(maxsize=16)
def _made(structure: _Structure) -> Kernels:
    robot = structure.robot
    check_moves_inertia(robot.mechanism, robot.machine)
    nq, nv, drives = robot.nq, robot.nv, len(robot.drives)

    def machine(parameters: Scalars) -> Machine:
        made = robot.machine_with(parameters)
        return made if structure.friction else without_friction(made)

    def steady(q: Scalars, v: Scalars, parameters: Scalars) -> Any:
        return steady_motion(machine(parameters), robot.derivatives_needed, q, v)

    def slopes(parameters: Scalars, **state: Scalars) -> Slopes:
        m = machine(parameters)
        found, by_each = definitions.elastic_forward_dynamics(m, **state), elastic_forward_dynamics(m, **state)
        rows = (row for x in (by_each[:5], by_each[5:]) for row in zip(*x, strict=True))
        return Slopes([*found.a, *found.theta_ddot], [[x for part in row for x in part] for row in rows])

    sizes: dict[str, Any] = {"q": nq, "v": nv, "theta": drives, "theta_dot": drives, "motor_torque": drives}
    sizes |= {"parameters": robot.drive_parameters.size}
    return Kernels(
        kernels.compile(steady, backend=robot.backend, q=nq, v=nv, parameters=robot.drive_parameters.size),
        kernels.compile(slopes, backend=robot.backend, **sizes),
    )


def steady_motion(machine: Machine, derivatives: int, q: Scalars, v: Scalars) -> ElasticTorques[Scalars]:
    """The motors' state and torques for a motion at constant speed.  derivatives: number that the machine needs."""
    still = [0] * len(v)
    higher: dict[str, Any] = {f"derivative_{k}": still for k in range(5, derivatives + 1)}
    return definitions.elastic_inverse_dynamics(machine, q, v, still, still, still, **higher)


def without_friction(machine: Machine) -> Machine:
    """The machine with no friction on either side; damping of its springs stays."""
    return Machine(machine.system, [replace(d, drive=frictionless(d.drive)) for d in machine.drives])


def frictionless(drive: Drive) -> Drive:
    return replace(drive, link_friction=None, motor_friction=None)

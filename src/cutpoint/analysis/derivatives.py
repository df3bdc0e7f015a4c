"""The plant's accelerations and their exact derivatives, compiled once for a structure of robot."""

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, NamedTuple

from cutpoint import definitions, kernels
from cutpoint.definitions import Machine
from cutpoint.derivatives.definitions import elastic_forward_dynamics
from cutpoint.functions.idle_joints import check_moves_inertia
from cutpoint.kernels import Kernel
from cutpoint.mechanics.elastic import DEFAULT, ElasticMotion
from cutpoint.model import Drive
from cutpoint.robot import Robot

Scalars = list[Any]


class Slopes(NamedTuple):
    """[a; theta_ddot] of links and motors, and how it changes with (q, v, theta, theta_dot, motor_torque), a row each.

    With q along the directions of the speeds.
    """

    value: Scalars
    slope: list[Scalars]


class Kernels(NamedTuple):
    """steady(q, v, parameters): a motion at constant speed.

    slopes(q, v, theta, theta_dot, motor_torque, parameters): see `Slopes`.
    """

    steady: Kernel
    slopes: Kernel


@dataclass(frozen=True)
class _Structure:
    """What one trace serves: equal for robots that differ in their drives' numbers only.

    It holds the robot, because its key names the mechanism by identity.
    """

    key: Hashable
    friction: bool
    robot: Robot = field(compare=False)


def kernels_of(robot: Robot, friction: bool) -> Kernels:
    """The kernels of a robot, with its friction or without.  Raises ModelError: a joint moves no inertia."""
    return _compiled(_Structure(robot.trace_key, friction, robot))


@lru_cache(maxsize=16)
def _compiled(structure: _Structure) -> Kernels:
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


def steady_motion(machine: Machine, derivatives: int, q: Scalars, v: Scalars) -> ElasticMotion:
    """What motors do for a motion at constant speed.  derivatives: of the position, that the machine takes."""
    still = [0] * len(v)
    higher = {f"derivative_{k}": still for k in range(5, derivatives + 1)}
    return definitions.elastic_inverse_dynamics(machine, DEFAULT, q, v, still, still, still, **higher)


def without_friction(machine: Machine) -> Machine:
    """The machine with no friction on either side; damping of its springs stays."""
    return Machine(machine.system, [replace(d, drive=frictionless(d.drive)) for d in machine.drives])


def frictionless(drive: Drive) -> Drive:
    return replace(drive, link_friction=None, motor_friction=None)

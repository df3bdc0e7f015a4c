"""The plant's accelerations and their exact directional derivatives, compiled once for a structure of robot."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import chain
from typing import Any, NamedTuple

from cutpoint import definitions, kernels
from cutpoint.definitions import Machine
from cutpoint.functions.idle_joints import check_moves_inertia
from cutpoint.kernels import Kernel
from cutpoint.mechanics.elastic import DEFAULT, ElasticMotion
from cutpoint.mechanics.elastic_forward import elastic_forward_dynamics
from cutpoint.mechanics.kinematics import coordinate_rates
from cutpoint.model import Drive
from cutpoint.robot import Robot
from cutpoint.scalars import Jet, Scalar

Scalars = list[Any]


class Slopes(NamedTuple):
    """Accelerations of links and elastic motors [a; theta_ddot], and how fast they change along a direction."""

    value: Scalars
    slope: Scalars


class Kernels(NamedTuple):
    """steady(q, v, parameters): a motion at constant speed; slopes(state, motor_torque, direction, parameters)."""

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

    def slopes(direction: Scalars, parameters: Scalars, **state: Scalars) -> Slopes:
        return slopes_along(machine(parameters), [*state.values()], direction)

    sizes: dict[str, Any] = {"q": nq, "v": nv, "theta": drives, "theta_dot": drives, "motor_torque": drives}
    sizes |= {"direction": 2 * nv + 3 * drives, "parameters": robot.drive_parameters.size}
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


def slopes_along(machine: Machine, state: Sequence[Scalars], direction: Scalars) -> Slopes:
    """d [a; theta_ddot] along a direction of (q, v, theta, theta_dot, motor_torque): one sweep of first-order jets.

    The direction is tangent in q: nv entries, which the joints' own rates turn into those of quaternions.
    """
    nv = machine.system.nv
    along = [*coordinate_rates(machine.system, state[0], direction[:nv]), *direction[nv:]]
    moving = iter(Jet(x, dx) for x, dx in zip(chain(*state), along, strict=True))
    q, v, theta, theta_dot, torque = ([next(moving) for _ in x] for x in state)
    found = elastic_forward_dynamics(machine.system, machine.drives, q, v, theta, theta_dot, torque)
    results = [*found.a, *found.theta_ddot]
    return Slopes([_part(x, 0) for x in results], [_part(x, 1) for x in results])


def _part(x: Scalar, k: int) -> Scalar:
    """Value or slope of a result, which is a plain number where nothing enters it."""
    return x.derivative(k) if isinstance(x, Jet) else (0 if k else x)

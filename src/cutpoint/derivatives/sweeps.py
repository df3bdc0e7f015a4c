"""Derivatives of robots too large for compiling: one sweep through the equations, along all directions at once.

Straight-line code of derivatives grows with the square of the robot.  A sweep runs the same equations uncompiled, on
dual numbers that hold their derivatives in an array, one entry per direction.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint import definitions
from cutpoint.arrays import Array
from cutpoint.definitions import Machine
from cutpoint.door import checked_array
from cutpoint.errors import InputError
from cutpoint.functions.compiled import compiled_of
from cutpoint.functions.quaternions import check_quaternions
from cutpoint.kernels.arrays.arguments import common_batch
from cutpoint.mechanics import elastic_forward
from cutpoint.mechanics.kinematics import coordinate_rates
from cutpoint.robot import Robot
from cutpoint.scalars import Jet, Scalar

Scalars = list[Scalar]
Function = Callable[..., Scalars]

MOST_STRAIGHT_BODIES = 24
"""Bodies up to which straight-line code is taken: it compiles in seconds, and then runs in microseconds."""

MOST_STRAIGHT_SPEEDS = 36
"""Speeds up to which it is: of joints of several axes, 32 took 21 s to compile, 40 half a minute or more than can be
compiled."""

MOST_SWEPT_BODIES = 500
"""Bodies that are swept at most: some seconds, and some hundred megabytes."""

WIDTH = 512
"""Directions that are swept at once: arrays of their length stay in the processor's caches."""


class Slopes(NamedTuple):
    """A function's values (m,) at (q, ...), and derivatives (m, directions), of which the first nv are by q."""

    value: Any
    slope: Any


def is_swept(robot: Robot) -> bool:
    """Whether the robot is large enough for sweeps.  Raises InputError if it is too large for them."""
    bodies = len(robot.mechanism.bodies)
    if bodies > MOST_SWEPT_BODIES:
        raise too_large(bodies, MOST_SWEPT_BODIES)
    return bodies > MOST_STRAIGHT_BODIES or robot.nv > MOST_STRAIGHT_SPEEDS


def too_large(bodies: int, most: int) -> InputError:
    remedy = "use finite differences over a batch of the robot's functions, which loop over bodies"
    return InputError(f"derivatives: {bodies} bodies are too many, at most {most}; {remedy}", bodies=bodies)


def swept(function: Function, machine: Machine, q: Sequence[float], *others: Sequence[float]) -> Slopes:
    """The function of (machine, q, *others) and its derivatives, those by q along the directions of the speeds."""
    n = machine.system.nv + sum(map(len, others))
    parts = [_swept_along(function, machine, (q, *others), x) for x in np.split(np.eye(n), range(WIDTH, n, WIDTH), 1)]
    return Slopes(parts[0].value, np.hstack([x.slope for x in parts]))


def _swept_along(function: Function, machine: Machine, state: Sequence[Sequence[float]], directions: Array) -> Slopes:
    """directions (inputs, k): rates of q's speeds and of each other input along k directions."""
    nv, rows = machine.system.nv, [*directions]
    moving = iter([*coordinate_rates(machine.system, state[0], rows[:nv]), *rows[nv:]])
    found = function(machine, *([Jet(x, next(moving)) for x in part] for part in state))
    pairs = [(x.derivative(0), x.derivative(1)) if isinstance(x, Jet) else (x, 0.0) for x in found]
    width = directions.shape[1]
    return Slopes(np.array([x for x, _ in pairs], float), np.array([np.broadcast_to(dx, width) for _, dx in pairs]))


def inverse_dynamics(robot: Robot, **state: ArrayLike) -> list[Array]:
    """d torque / d (q, v, a), each (..., nv, nv)."""
    machine = _lean(robot)

    def each(*state: Array) -> list[Array]:
        return np.split(swept(definitions.inverse_dynamics, machine, *_lists(state)).slope, 3, axis=1)

    return _over_batch("inverse_dynamics_derivatives", robot, each, [(robot.nv, robot.nv)] * 3, state)


def elastic_forward_dynamics(robot: Robot, **state: ArrayLike) -> list[Array]:
    """d a / d (q, v, theta, theta_dot, motor_torque), then those of theta_ddot."""
    machine, nv, drives = _lean(robot), robot.nv, len(robot.drives)
    widths = (nv, nv, drives, drives, drives)

    def each(*state: Array) -> list[Array]:
        slope = swept(accelerations, machine, *_lists(state)).slope
        return [x for rows in (slope[:nv], slope[nv:]) for x in np.split(rows, np.cumsum(widths)[:-1], axis=1)]

    shapes = [(rows, width) for rows in (nv, drives) for width in widths]
    return _over_batch("elastic_forward_dynamics_derivatives", robot, each, shapes, state)


def accelerations(machine: Machine, *state: Scalars) -> Scalars:
    """[a; theta_ddot] of (q, v, theta, theta_dot, motor_torque)."""
    found = elastic_forward.elastic_forward_dynamics(machine.system, machine.drives, *state)
    return [*found.a, *found.theta_ddot]


def _lean(robot: Robot) -> Machine:
    return robot.machine_with(robot.drive_parameters.tolist(), lean=True)


def _lists(state: Sequence[Array]) -> list[list[float]]:
    return [x.tolist() for x in state]


def _over_batch(
    name: str,
    robot: Robot,
    each: Callable[..., list[Array]],
    shapes: Sequence[tuple[int, int]],
    given: Mapping[str, ArrayLike],
) -> list[Array]:
    """The matrices of these shapes for each configuration, (..., m, n)."""
    compiled = compiled_of(robot)
    compiled.remember_as_loops(name)
    arrays = [checked_array(name, key, x, compiled.size_of(key)) for key, x in given.items()]
    check_quaternions(name, "q", arrays[0], compiled.quaternions)
    batch = common_batch(name, {key: x.shape[:-1] for key, x in zip(given, arrays, strict=True)})
    arrays = [np.broadcast_to(x, (*batch, x.shape[-1])) for x in arrays]
    found = [np.empty((*batch, *shape)) for shape in shapes]
    for k in np.ndindex(batch):
        for whole, own in zip(found, each(*(x[k] for x in arrays)), strict=True):
            whole[k] = own
    return found

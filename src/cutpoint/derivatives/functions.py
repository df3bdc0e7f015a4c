"""Derivatives of a robot's dynamics as users call them: compiled, by loops over bodies, or swept; see the package."""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.derivatives import definitions, large, sweeps
from cutpoint.derivatives.definitions import (
    ElasticForwardDynamicsDerivatives,
    ForwardDynamicsDerivatives,
    InverseDynamicsDerivatives,
    MotorTorqueDerivatives,
)
from cutpoint.door import LARGEST, check_truths
from cutpoint.drive_slopes import STATE, EffortSlopes
from cutpoint.errors import InputError
from cutpoint.functions.compiled import RobotKernels, compiled_of
from cutpoint.functions.facts import FACTS, Facts
from cutpoint.functions.variants import motion_names, wrong_motion
from cutpoint.mechanics.elastic_inverse import Options
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot

if TYPE_CHECKING:
    from cutpoint.rolled.equations.solver import Solver

MOST_COMPILED = 48
"""Bodies beyond which derivatives of an elastic inverse dynamics are more than can be compiled."""

MOST_LOOPED = 4000
"""Bodies of which derivatives run as loops: three matrices, 0.4 gigabytes in all, and as much to work in; to solve for
accelerations takes some 3 gigabytes."""


class ElasticInverseDynamicsDerivatives(NamedTuple):
    """d motor_torque / d (q, v, a, jerk, snap), each (..., drives, nv); d_higher: with respect to each further rate."""

    d_q: Array
    d_v: Array
    d_a: Array
    d_jerk: Array
    d_snap: Array
    d_higher: tuple[Array, ...] = ()


def inverse_dynamics(robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> InverseDynamicsDerivatives[Array]:
    """Derivatives of the joint torques of `Robot.inverse_dynamics`: d_q, d_v and d_a, each (..., nv, nv).

    q (..., nq) in rad (m), v and a (..., nv) in rad/s and rad/s2 (m/s, m/s2).  A row for each torque, N m (N); d_q in
    N m/rad, along the tangent directions of `Robot.integrate`.

    Raises:
        InputError: a wrong shape, a number that is not finite or beyond 1e15, or a robot of too many bodies: more than
            4000, or than 500 where loops do not support it.
    """
    if made := _kernels_of(robot).functions.get("inverse_dynamics_derivatives"):
        return made(q, v, a)
    if not _is_looped(robot) and sweeps.is_swept(robot):
        return InverseDynamicsDerivatives(*sweeps.inverse_dynamics(robot, q=q, v=v, a=a))
    return _function(robot, "inverse_dynamics", definitions.inverse_dynamics, InverseDynamicsDerivatives)(q, v, a)


def forward_dynamics(robot: Robot, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> ForwardDynamicsDerivatives[Array]:
    """Derivatives of the accelerations of `Robot.forward_dynamics`: d_q, d_v and d_tau, each (..., nv, nv).

    q (..., nq) in rad (m), v (..., nv) in rad/s (m/s), tau (..., nv) in N m (N).  A row for each acceleration, rad/s2
    (m/s2); d_q is along the tangent directions of `Robot.integrate`.

    Raises:
        InputError: as for `inverse_dynamics`; of a large robot also a mass matrix that is singular to rounding, or
            accelerations beyond 1e15.
        ModelError: a joint can move without moving any inertia.
    """
    if made := _kernels_of(robot).functions.get("forward_dynamics_derivatives"):
        return made(q, v, tau)
    if _is_looped(robot) or sweeps.is_swept(robot):
        a = robot.forward_dynamics(q, v, tau)
        d_q, d_v, M = _rigid_at(robot, "forward_dynamics", q, v, a)
        found = large.solved(q, M, [d_q, d_v], _solver(robot), "forward_dynamics_derivatives")
        return ForwardDynamicsDerivatives(*found)
    return _function(robot, "forward_dynamics", definitions.forward_dynamics, ForwardDynamicsDerivatives)(q, v, tau)


def elastic_inverse_dynamics(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    jerk: ArrayLike,
    snap: ArrayLike,
    *higher: ArrayLike,
    friction_rates: bool = False,
    quasi_rigid: bool = False,
) -> ElasticInverseDynamicsDerivatives:
    """Derivatives of the motor torques of `Robot.elastic_inverse_dynamics`, each (..., drives, nv).

    q (..., nq) in rad (m); v, a, jerk, snap and higher rates (..., nv) in rad/s, rad/s2, ...: as many as
    `Robot.derivatives_needed` says, four with quasi_rigid.  A row for each motor torque, N m (N) at the joint's side;
    d_q is along the tangent directions of `Robot.integrate`.  Options are as there, but for strains: friction is that
    of steady sliding, and springs have no hysteresis.

    Raises:
        InputError: a wrong shape, another number of rates, a number that is not finite or beyond 1e15, an option that
            is not True or False, or more than 4000 bodies, 48 where loops do not support the robot.
    """
    check_truths("derivatives.elastic_inverse_dynamics", friction_rates=friction_rates, quasi_rigid=quasi_rigid)
    options, kernels = Options(friction_rates, quasi_rigid), _kernels_of(robot)
    needed = 4 if quasi_rigid else robot.derivatives_needed
    given = (q, v, a, jerk, snap, *higher)
    if len(given) != needed + 1:
        raise wrong_motion("derivatives.elastic_inverse_dynamics", len(given) - 1, needed)
    function = kernels.functions.get((_ELASTIC_INVERSE, options)) or _elastic_inverse(robot, needed, options)
    found = function(*given)
    return ElasticInverseDynamicsDerivatives(*found[:5], d_higher=tuple(found[5:]))


def elastic_forward_dynamics(
    robot: Robot, q: ArrayLike, v: ArrayLike, theta: ArrayLike, theta_dot: ArrayLike, motor_torque: ArrayLike
) -> ElasticForwardDynamicsDerivatives[Array]:
    """Derivatives of the accelerations of `Robot.elastic_forward_dynamics`, of the links and of the motors.

    q (..., nq) and theta (..., drives) in rad (m), v (..., nv) and theta_dot (..., drives) in rad/s (m/s), motor_torque
    (..., drives) in N m (N) at the joint's side.  Those by q are along the tangent directions of `Robot.integrate`.
    Friction is that of steady sliding, and springs have no hysteresis.

    Raises:
        InputError, ModelError: as for `forward_dynamics`.
    """
    if made := _kernels_of(robot).functions.get("elastic_forward_dynamics_derivatives"):
        return made(q, v, theta, theta_dot, motor_torque)
    name = "elastic_forward_dynamics"
    state = dict(zip(STATE, (q, v, theta, theta_dot, motor_torque), strict=True))
    if elastic_loops(robot):
        a = robot.elastic_forward_dynamics(**state).a
        of_drives = Facts(" ".join(STATE), definitions.drive_slopes, reads_drives=True, record=EffortSlopes)
        slopes = _kernels_of(robot).function("drive_slopes", of_drives)(*state.values())
        d_q, d_v, M = _rigid_at(robot, name, q, v, a)
        found = large.elastic_forward_dynamics(robot.machine.drives, q, d_q, d_v, M, slopes, _solver(robot))
        return ElasticForwardDynamicsDerivatives(*found)
    if sweeps.is_swept(robot):
        return ElasticForwardDynamicsDerivatives(*sweeps.elastic_forward_dynamics(robot, **state))
    definition, record = definitions.elastic_forward_dynamics, ElasticForwardDynamicsDerivatives
    return _function(robot, name, definition, record)(*state.values())


_ELASTIC_INVERSE = "elastic_inverse_dynamics_derivatives"


def _kernels_of(robot: Robot) -> RobotKernels:
    """What a robot keeps for its functions.  Raises InputError for anything but a robot."""
    try:
        return compiled_of(robot)
    except AttributeError:
        check_robot("derivatives", robot)
        raise


def _elastic_inverse(robot: Robot, needed: int, options: Options) -> Callable[..., Any]:
    """The derivatives of an elastic inverse dynamics, compiled.  Raises InputError if the robot is too large."""
    bodies, compiled = len(robot.mechanism.bodies), _kernels_of(robot)
    most = MOST_LOOPED if compiled.loops((_ELASTIC_INVERSE, options)) else MOST_COMPILED
    if bodies > most:
        raise sweeps.too_large(bodies, most)
    definition = partial(definitions.elastic_inverse_dynamics, options=options)
    record = MotorTorqueDerivatives if needed == 4 else None
    facts = FACTS[_ELASTIC_INVERSE]._replace(definition=definition, inputs=motion_names(needed), record=record)
    return compiled.function((_ELASTIC_INVERSE, options), facts)


def elastic_loops(robot: Robot) -> bool:
    """Whether derivatives of elastic forward dynamics follow from loops: no rotor behind a spring feels its carrier."""
    return _is_looped(robot) and not robot.machine.system.has_sprung_rotors


def _rigid_at(robot: Robot, name: str, q: ArrayLike, v: ArrayLike, a: Array) -> InverseDynamicsDerivatives[Array]:
    """The derivatives of inverse dynamics at the accelerations that a function of this name computed."""
    kernels = _kernels_of(robot)
    are_exported = name == "forward_dynamics" and kernels.derivatives_loop  # by `in_c`
    kernels.remember_as_loops(f"{name}_derivatives", are_exported=are_exported)
    try:
        return inverse_dynamics(robot, q, v, a)
    except InputError as error:
        if (largest := np.abs(a).max(initial=0.0)) <= LARGEST:
            raise
        told = f"state and torques give accelerations up to {largest:.3g}, more than {LARGEST:.0e}"
        remedy = "are they in rad, rad/s and N m?"
        raise InputError(f"{name}_derivatives: {told}; {remedy}", largest=largest) from error


def _solver(robot: Robot) -> "Solver | None":
    """Solver of equations with the mass matrix, where derivatives run as loops."""
    return _kernels_of(robot).solver if _is_looped(robot) else None


def _is_looped(robot: Robot) -> bool:
    """Whether derivatives of rigid dynamics run as loops.  Raises InputError if their matrices would be too large."""
    if not _kernels_of(robot).derivatives_loop:
        return False
    if len(robot.mechanism.bodies) > MOST_LOOPED:
        raise sweeps.too_large(len(robot.mechanism.bodies), MOST_LOOPED)
    return True


def _function(
    robot: Robot, name: str, definition: Callable[..., Any], record: type[tuple[Any, ...]]
) -> Callable[..., Any]:
    """One of the robot's own functions, so that it knows the kernel: `robot.kernel(name + "_derivatives")`."""
    key = f"{name}_derivatives"
    return _kernels_of(robot).function(key, FACTS[key]._replace(definition=definition, record=record))

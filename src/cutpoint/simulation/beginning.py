"""The initial state of a run: given parts, and defaults for the others."""

from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import checked_array
from cutpoint.errors import InputError
from cutpoint.functions.compiled import compiled_of
from cutpoint.functions.quaternions import check_quaternions
from cutpoint.mechanics.drives.strains import count, gathered
from cutpoint.robot import Robot
from cutpoint.simulation.plant import State, lengths

ROUNDING = 1e-9
"""Relative, or in rad, rad/s (m, m/s): within it a rigid drive's motor is where its link is."""


def beginning(robot: Robot, initial: State | None, reference: Array, is_held: bool) -> tuple[State, Array]:
    """The whole state, and the motors' commands until the first sample, N m.

    reference (5, N, drives); is_held: whether those commands hold the arm against gravity, or are zero.
    """
    given = initial or State()
    start = _motion(robot, given, reference)
    commanded = np.zeros(len(robot.drives))
    if is_held:
        commanded = robot.gravity_forces(start.q)[[d.v for d in robot.machine.drives]]
    start = _with_inner_states(robot, given, start, commanded)
    if given.current is not None:  # a motor's earlier command equals its current
        commanded[[d.drive.has_current_lag for d in robot.machine.drives]] = start.current
    return start, commanded


def _motion(robot: Robot, given: State, reference: Array) -> State:
    """Positions and speeds: given, or those of the reference, with motors leading by the static deflection."""
    driven = [d.q for d in robot.machine.drives]
    speeds = [d.v for d in robot.machine.drives]
    q, v = robot.neutral(), np.zeros(robot.nv)
    q[driven], v[speeds] = reference[0, 0], reference[1, 0]
    if given.q is not None:
        q = vector("q", given.q, robot.nq)
        check_quaternions("simulate", "initial.q", q, compiled_of(robot).quaternions)
    v = v if given.v is None else vector("v", given.v, robot.nv)
    theta = q[driven] + robot.static_deflection(q) if given.theta is None else given.theta
    omega = v[speeds] if given.theta_dot is None else given.theta_dot
    return State(q, v, _of_motors(robot, "theta", theta, q[driven]), _of_motors(robot, "theta_dot", omega, v[speeds]))


def vector(name: str, value: Any, size: int) -> Array:
    """A part of the given state, (size,).  Raises InputError for an array of several."""
    array = checked_array("simulate", f"initial.{name}", value, size)
    if array.ndim != 1:
        raise InputError(f"simulate: initial.{name} has shape {array.shape}, but must have ({size},)")
    return array


def _of_motors(robot: Robot, name: str, value: Any, links: Array) -> Array:
    """Positions or speeds of motors (n,); for rigid drives exactly the links'.

    Raises InputError if a rigid drive's differs by more than rounding.
    """
    motors = vector(name, value, len(links))
    rigid = np.array([not drive.is_elastic for drive in robot.drives.values()], bool)
    apart = rigid & (np.abs(motors - links) > ROUNDING * np.maximum(np.abs(links), 1.0))
    if apart.any():
        k = int(apart.argmax())
        rule = f"the drive of {robot.joints[k]!r} is rigid, so its motor moves as its link, {links[k]:g}: give that"
        raise InputError(f"simulate: initial.{name}[{k}] is {motors[k]:g}; {rule}", joint=robot.joints[k])
    return np.where(rigid, links, motors)


def _with_inner_states(robot: Robot, given: State, start: State, commanded: Array) -> State:
    """Currents that hold the arm, or zero without a controller; strains are zero."""
    expected = lengths(robot.machine)
    lagging = [d.drive.has_current_lag for d in robot.machine.drives]
    current = commanded[lagging] if given.current is None else given.current
    strains = np.zeros(expected.strains) if given.strains is None else given.strains
    strains = vector("strains", strains, expected.strains)
    for name, strain, most in zip(robot.strain_names, strains, _farthest(robot), strict=True):
        if abs(strain) > most * (1 + ROUNDING):
            raise InputError(f"simulate: initial strain {name} is {strain:g}, but it slips at {most:g}", name=name)
    return start._replace(current=vector("current", current, expected.current), strains=strains)


def _farthest(robot: Robot) -> list[float]:
    """The strain at which each hysteresis element slips, in the order of `Robot.strain_names`; inf for bristles."""
    reaches = [drive.hysteresis.reach if drive.hysteresis else () for drive in robot.drives.values()]
    bristles = [count(drive) - len(reach) for drive, reach in zip(robot.drives.values(), reaches, strict=True)]
    return gathered([[*[np.inf] * other, *reach] for other, reach in zip(bristles, reaches, strict=True)])

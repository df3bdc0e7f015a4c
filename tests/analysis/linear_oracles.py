"""References for linear models: finite differences of the plant, and one joint with everything known."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutpoint import Coulomb, Drive, LinearSpring, Rotor
from cutpoint.analysis import LinearModel
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import Array, Robot, derivative, frictionless

STEP = 1e-5
"""Of differences of order 8.  The stiffest flexspline hardens over 1/742 rad, friction is smoothed over 0.02 rad/s:
four steps stay well inside both."""


def rates_around(robot: Robot, model: LinearModel, deviation: Array) -> Array:
    """(v, a, theta_dot, theta_ddot) of all motors at the operating point moved by (q, v, theta, theta_dot, torques)."""
    point, nv, nd = model.point, robot.nv, len(robot.drives)
    dq, dv, dtheta, dtheta_dot, du = np.split(deviation, np.cumsum([nv, nv, nd, nd]))
    v, theta_dot = point.v + dv, point.theta_dot + dtheta_dot
    q, theta = robot.integrate(point.q, dq, 1.0), point.theta + dtheta
    found = robot.elastic_forward_dynamics(q, v, theta, theta_dot, point.motor_torque + du)
    return np.concatenate([v, found.a, theta_dot, found.theta_ddot])


def by_differences(robot: Robot, model: LinearModel) -> tuple[Array, Array]:
    """A and B of a model from central differences of the robot itself, friction and all."""
    states = 2 * robot.nv + 2 * len(robot.drives)
    directions = np.eye(states + len(robot.drives))
    columns = [derivative(lambda h, d=d: rates_around(robot, model, h * d), STEP) for d in directions]
    J = np.array(columns).T
    elastic = [drive.is_elastic for drive in robot.drives.values()]
    kept = np.flatnonzero([True] * (2 * robot.nv) + elastic + elastic)
    return J[np.ix_(kept, kept)], J[kept, states:]


def with_springs_of_their_own(robot: Robot) -> Robot:
    """Without friction, damping of springs kept."""
    return robot.with_drives(
        {name: replace(d, link_friction=None, motor_friction=None) for name, d in robot.drives.items()}
    )


def fully_coupled() -> Robot:
    """The paper's arm with rotors of a gear of 3 as bodies, whose coupling is far from small."""
    from cutpoint.robots import xia2019

    arm = frictionless(xia2019())
    return arm.with_drives(
        {
            name: replace(d, ratio=3.0, rotor=Rotor(d.reflected_inertia / 9.0 / 4.0, coupling="full"), damping=2.0)
            for name, d in arm.drives.items()
        }
    )


def wheel(inertia: float = 1.0) -> Robot:
    """A disc on a vertical axis, with a rigid drive: gravity does nothing to it."""
    disc = Link("disc", 1.0, np.zeros(3), inertia * np.eye(3))
    return Robot(build("wheel", [Link("stand"), disc], [Joint("axle", "continuous", "stand", "disc")]))


def sprung(wheel: Robot, J: float, K: float, damping: float | None = None, viscous: float = 0.0) -> Robot:
    """The wheel behind a spring K and a rotor of reflected inertia J; viscous friction on the link."""
    options: dict[str, Any] = {"damping": damping}
    if viscous:
        options["link_friction"] = Coulomb(0.0, viscous, 1.0)
    return wheel.with_drives({"axle": Drive(1.0, Rotor(J), LinearSpring(K), **options)})

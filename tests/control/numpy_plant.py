"""A robot for the NumPy laws: Pinocchio's rigid bodies, and the drives of `numpy_drives`."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy_drives import friction, spring, winding

from cutpoint import Robot
from robot_library import Array
from twins import Twin, pinocchio_of

Path = Callable[[float], Any]
"""Something that changes with time, s, near 0."""


def rates(path: Path, order: int, reach: float = 3e-3) -> list[Array]:
    """The path and its time derivatives at 0, from a polynomial of degree 16 through 17 points within +-reach."""
    x = np.polynomial.chebyshev.chebpts1(17)
    c = np.polynomial.chebyshev.chebfit(x, np.array([path(reach * t) for t in x]), 16)
    chebyshev = np.polynomial.chebyshev
    return [chebyshev.chebval(0.0, chebyshev.chebder(c, k) if k else c) / reach**k for k in range(order + 1)]


def along(*derivatives: Array) -> Path:
    """A polynomial motion with these derivatives at 0."""
    return lambda t: sum(d * t**k / np.prod(np.arange(1.0, k + 1)) for k, d in enumerate(derivatives))


@dataclass(frozen=True)
class Plant:
    """The rigid part with rotors of rigid drives as armature (of all drives with `rigid`); one state at a time.

    believed: drives with other numbers than the robot's.
    """

    robot: Robot
    rigid: bool = False
    believed: Any = None

    @cached_property
    def twin(self) -> Twin:
        return Twin(self.robot, pinocchio_of(self.robot.mechanism))

    @property
    def drives(self) -> list[Any]:
        return self.believed or [*self.robot.drives.values()]

    @property
    def bends(self) -> bool:
        return any(drive.is_elastic for drive in self.drives)

    @cached_property
    def armature(self) -> Array:
        return np.array([0.0 if d.is_elastic and not self.rigid else d.reflected_inertia for d in self.drives])

    def mass(self, q: Array) -> Array:
        return self.twin.mass_matrix(q) + np.diag(self.armature)

    def bias(self, q: Array, v: Array) -> Array:
        return self.twin.bias_forces(q, v)

    def required(self, q: Array, v: Array, v_r: Array, a_r: Array) -> Array:
        """M a_r + C(q, v) v_r + g."""
        t = self.twin
        C = t.ours(t.ours(pin.computeCoriolisMatrix(t.model, t.data, *t.theirs(q, v))).T).T
        return self.mass(q) @ a_r + C @ v_r + t.gravity_forces(q)

    def link_frictions(self, wanted: Array, v: Array) -> Array:
        return np.array([friction(d.link_friction, *x) for d, *x in zip(self.drives, wanted, v, strict=True)])

    def motor_frictions(self, wanted: Array, theta_dot: Array) -> Array:
        return np.array([friction(d.motor_friction, *x) for d, *x in zip(self.drives, wanted, theta_dot, strict=True)])

    def both_frictions(self, wanted: Array, v: Array) -> Array:
        """Of rigid drives: motor and link have one speed."""
        return self.link_frictions(wanted, v) + self.motor_frictions(wanted, v)

    def springs(self, q: Array, v: Array, theta: Array, theta_dot: Array) -> Array:
        """What bending drives exert on their links, N m, with the rate that their springs give it."""
        found = []
        for d, e, e_dot in zip(self.drives, theta - q, theta_dot - v, strict=True):
            tau, slope = spring(d.compliance, e)
            found.append([tau + (d.damping or 0.0) * e_dot, slope * e_dot])
        return np.array(found).T

    def link_motion(self, q: Array, v: Array, theta: Array, theta_dot: Array) -> tuple[Array, Array]:
        """Acceleration and jerk of the links under their drives; friction by value."""
        tau, tau_dot = self.springs(q, v, theta, theta_dot)
        M = self.mass(q)
        a = np.linalg.solve(M, tau - self.link_frictions(v, v) - self.bias(q, v))

        def held(t: float) -> Array:
            q_t, v_t = q + t * v + t * t * a / 2, v + t * a
            return self.mass(q_t) @ a + self.bias(q_t, v_t)

        return a, np.linalg.solve(M, tau_dot - rates(held, 1)[1])

    # bodies, each in its own axes

    def columns_of_bodies(self, q: Array, v: Array) -> list[tuple[Array, Array]]:
        """Each body's Jacobian and its time derivative, (6, n), velocities [linear; angular] of its joint's frame."""
        t = self.twin
        pin.computeJointJacobiansTimeVariation(t.model, t.data, *t.theirs(q, v))
        pin.computeJointJacobians(t.model, t.data, *t.theirs(q))
        ids = [t.model.getJointId(body.joint.name) for body in self.robot.mechanism.bodies]
        local = pin.ReferenceFrame.LOCAL
        return [
            (
                t.ours(pin.getJointJacobian(t.model, t.data, k, local)),
                t.ours(pin.getJointJacobianTimeVariation(t.model, t.data, k, local)),
            )
            for k in ids
        ]

    def ups(self, q: Array) -> list[Array]:
        """Minus gravity in each body's axes."""
        t = self.twin
        pin.forwardKinematics(t.model, t.data, *t.theirs(q))
        ids = [t.model.getJointId(body.joint.name) for body in self.robot.mechanism.bodies]
        return [-t.data.oMi[k].rotation.T @ t.model.gravity.linear for k in ids]

    def wound(self, tau: Any) -> Array:
        """Deflections and their two derivatives, (3, n), that torques and theirs ask; damping bears by value only."""
        found = np.zeros((3, len(self.drives)))
        for k, d in enumerate(self.drives):
            if d.is_elastic:
                found[:, k] = winding(d.compliance, *np.asarray(tau)[:, k])
                borne = tau[0][k] - (d.damping or 0.0) * found[1, k]
                found[0, k] = winding(d.compliance, borne, 0.0, 0.0)[0]
        return found

    def pulls(self, q: Array, v: Array, K: Array, lag: Array) -> Array:
        """Joint torques of K_B (V_r - V) in every body."""
        return sum(J.T @ K_i @ J @ lag for (J, _), K_i in zip(self.columns_of_bodies(q, v), K, strict=True))

    def body_wrenches(self, q: Array, v: Array, v_r: Array, a_r: Array) -> list[tuple[Array, Array]]:
        """Of each body its Jacobian and a (6, 10) matrix W: F*_r = W p, Xia (2019) eqs. (59)-(62), in its own axes."""
        bodies = zip(self.columns_of_bodies(q, v), self.ups(q), strict=True)
        return [(J, unit_wrenches(J @ v, J @ v_r, J @ a_r + J_dot @ v_r, up)) for (J, J_dot), up in bodies]

    def required_regressor(self, q: Array, v: Array, v_r: Array, a_r: Array) -> Array:
        return np.hstack([J.T @ W for J, W in self.body_wrenches(q, v, v_r, a_r)])


def unit_wrenches(V: Array, V_r: Array, V_r_dot: Array, up: Array) -> Array:
    """(6, 10): sum over a cloud of mass of what its points' required accelerations cost, by parameter."""
    omega, omega_r, alpha = V[3:], V_r[3:], V_r_dot[3:]
    a = V_r_dot[:3] + np.cross(omega, V_r[:3]) + up
    found = np.zeros((6, 10))
    for k, p in enumerate(np.eye(10)):
        m, h, I = p[0], p[1:4], np.zeros((3, 3))
        I[np.triu_indices(3)] = p[4:]
        I = I + np.triu(I, 1).T
        S = np.trace(I) / 2 * np.eye(3) - I
        found[:3, k] = m * a + np.cross(alpha, h) + np.cross(omega, np.cross(omega_r, h))
        found[3:, k] = np.cross(h, a) + I @ alpha + np.cross(S @ omega, omega_r)
    return found

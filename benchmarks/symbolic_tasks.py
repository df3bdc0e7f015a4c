"""Tasks derived from the classical algorithms, in CasADi's symbols: by its own differentiation where that is best."""

import casadi as ca
from symbolic import inverse_dynamics
from symbolic_models import SX, Chain, constant, cross


def jacobian(model: Chain, flange: ca.DM) -> SX:
    """6 x n: velocity of a place on the last body, its pose given, along the world's axes."""
    R, p, axes, origins = SX.eye(3), SX(3, 1), [], []
    for b in model.bodies:
        p, R = p + R @ b.p, R @ b.R
        axes.append(R @ b.z)
        origins.append(p)
    tip = p + R @ constant(flange[:3, 3])
    columns = [ca.vertcat(cross(z, tip - o), z) for z, o in zip(axes, origins, strict=True)]
    return ca.horzcat(*columns)


def derivatives(found: SX, *given: SX) -> list[SX]:
    return [ca.jacobian(found, x) for x in given]


def regressor(model: Chain, v: SX, a: SX, p: SX) -> SX:
    """model: with p for its parameters, on which torques depend linearly."""
    return ca.jacobian(inverse_dynamics(model, v, a), p)


def elastic_inverse_dynamics(model: Chain, motion: list[SX], stiffness: float, inertia: float) -> list[SX]:
    """motion: q to snap.  Motor torque, theta, theta', theta'', joint torque; inertia: of the rotors, reflected."""
    q, v, a, jerk, snap = motion
    tau = inverse_dynamics(model, v, a)
    rate = ca.jtimes(tau, ca.vertcat(q, v, a), ca.vertcat(v, a, jerk))
    rate_2 = ca.jtimes(rate, ca.vertcat(q, v, a, jerk), ca.vertcat(v, a, jerk, snap))
    theta_ddot = a + rate_2 / stiffness
    return [inertia * theta_ddot + tau, q + tau / stiffness, v + rate / stiffness, theta_ddot, tau]

"""Acceleration and jerk of the links from their drives' torques, without differencing any encoder."""

from collections.abc import Sequence

from cutpoint.mechanics.drives.harmonic_drive import DriveState, friction_torque, spring_torque_and_rate
from cutpoint.mechanics.factors import factors_of, solve
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics
from cutpoint.mechanics.mass_matrix import mass_matrix
from cutpoint.mechanics.system import Driven, System
from cutpoint.scalars import Jet, Scalar

Scalars = Sequence[Scalar]


def link_motion(system: System, q: Scalars, v: Scalars, tau: Sequence[Jet]) -> tuple[list[Scalar], list[Scalar]]:
    """Acceleration and jerk of the links under torques tau with their rates: M a + bias = tau, and its derivative.

    Two solutions with one mass matrix.  De Luca and Book (2016) section 11.1.4.
    """
    M = factors_of(mass_matrix(system, q))
    bias = inverse_dynamics(system, q, v, [0] * system.nv)
    a = solve(M, [t.derivative(0) - b for t, b in zip(tau, bias, strict=True)])
    # the torques' rates at constant accelerations
    q_moving, v_moving = ([Jet(*x) for x in zip(*pair, strict=True)] for pair in ((q, v), (v, a)))
    held = inverse_dynamics(system, q_moving, v_moving, [Jet(x, 0) for x in a])
    return a, solve(M, [t.derivative(1) - h.derivative(1) for t, h in zip(tau, held, strict=True)])


def torques_on_links(
    system: System,
    drives: Sequence[Driven],
    q: Scalars,
    v: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
) -> list[Jet]:
    """Elastic drives' torques on their links, with rates, N m and N m/s; friction and damping enter by value.

    Xia (2019) eqs. (2)-(3), (21).
    """
    tau = [Jet(0, 0)] * system.nv
    for d, x, w in zip(drives, theta, theta_dot, strict=True):
        tau_f = spring_torque_and_rate(d.drive, DriveState(q[d.q], v[d.v], x, w))
        tau[d.v] = tau_f - friction_torque(d.drive.link_friction, v[d.v])
    return tau

"""Torques for a required motion of a robot that moves otherwise, by the sweeps of `inverse_dynamics`.

Xia (2019) eqs. (13)-(20), (48)-(53): what virtual decomposition control computes.
"""

from collections.abc import Sequence
from dataclasses import replace

from cutpoint.mechanics.bodies.spatial import Motion, Vec3, Wrench
from cutpoint.mechanics.inverse_dynamics import (
    BodyMotion,
    at_rest,
    joint_efforts,
    motions,
    move,
    net_wrenches,
    rotor_efforts,
    transmitted_wrenches,
)
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]
Gain = Sequence[Sequence[Scalar]]


def required_inverse_dynamics(system: System, q: Scalars, v: Scalars, v_r: Scalars, a_r: Scalars) -> list[Scalar]:
    """Joint torques for a required motion of a robot that moves with v: M a_r + C(q, v) v_r + g.

    Xia (2019) eqs. (48)-(53) without their gains K; C is the sum of the bodies' C(omega), eq. (61).
    """
    return [link + rotor for link, rotor in zip(*required_efforts(system, q, v, v_r, a_r), strict=True)]


def required_efforts(
    system: System, q: Scalars, v: Scalars, v_r: Scalars, a_r: Scalars, gains: Sequence[Gain] | None = None
) -> tuple[list[Scalar], list[Scalar]]:
    """Torques for a required motion of a robot that moves with v: see `efforts_between`."""
    return efforts_between(system, *required_motions(system, q, v, v_r, a_r), v_r, a_r, gains)


def efforts_between(
    system: System,
    actual: Sequence[BodyMotion],
    required: Sequence[BodyMotion],
    v_r: Scalars,
    a_r: Scalars,
    gains: Sequence[Gain] | None,
) -> tuple[list[Scalar], list[Scalar]]:
    """Torques for a required motion, N m (N): on the links, and separately for rigidly geared rotors.

    Xia (2019) eqs. (15)-(20), (48)-(53).  gains: K of each body, 6 x 6 in its own axes, for velocity feedback.
    """
    F_r = required_wrenches(system, actual, required, v_r, a_r, gains)
    F_r = transmitted_wrenches(system, [m.X for m in actual], F_r, {})
    return joint_efforts(system, F_r), rotor_efforts(system, required, a_r, actual)


def required_wrenches(
    system: System,
    actual: Sequence[BodyMotion],
    required: Sequence[BodyMotion],
    v_r: Scalars,
    a_r: Scalars,
    gains: Sequence[Gain] | None,
) -> list[Wrench]:
    """Net wrench of each body for its required motion, with velocity feedback.  Xia (2019) eqs. (15)-(17), (50)."""
    F_r = net_wrenches(system, required, v_r, a_r, actual)
    if gains is None:
        return F_r
    bodies = zip(system.segments, F_r, gains, required, actual, strict=True)
    return [F + velocity_feedback(body, K, m_r.V, m.V) for body, F, K, m_r, m in bodies]


def required_motions(
    system: System, q: Scalars, v: Scalars, v_r: Scalars, a_r: Scalars
) -> tuple[list[BodyMotion], list[BodyMotion]]:
    """Every body's motion, without its accelerations, and its required one.  Xia (2019) eqs. (13)-(14), (48)-(49)."""
    actual = motions(system, q, v, [0] * system.nv)
    required: list[BodyMotion] = []
    for body, m in zip(system.segments, actual, strict=True):
        parent = at_rest(system) if body.parent == WORLD else required[body.parent]
        zv, zv_r, za_r = body.motion(v), body.motion(v_r), body.motion(a_r)
        required.append(move(m.X, m.V.angular, zv, parent, zv_r, za_r))
    return actual, required


def velocity_feedback(body: Segment, K: Gain, V_r: Motion, V: Motion) -> Wrench:
    """K (V_r - V), K in the body's own axes.  Xia (2019) eqs. (15)-(17)."""
    lag = [*body.in_own_axes(V_r - V)]
    pulled = [sum((k * x for k, x in zip(row, lag, strict=True)), 0) for row in K]
    R_T = body.to_user_axes.T
    return Wrench(R_T @ Vec3(*pulled[:3]), R_T @ Vec3(*pulled[3:]))


def quasi_rigid(system: System) -> System:
    """The system whose elastic drives' rotors act on their carriers as if their drives were rigid."""
    return replace(system, spins=tuple(replace(spin, elastic=False) for spin in system.spins))

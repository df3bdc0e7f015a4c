"""Joint torques as a linear function of inertial parameters.  Atkeson, An and Hollerbach (1986)."""

from collections.abc import Sequence
from dataclasses import replace

from cutpoint.mechanics.bodies.rigid_body import body_regressor, inertia_of
from cutpoint.mechanics.inverse_dynamics import BodyMotion, motions
from cutpoint.mechanics.kinematics import velocity_columns
from cutpoint.mechanics.required_dynamics import required_inverse_dynamics, required_motions
from cutpoint.mechanics.system import System
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def torque_regressor(system: System, q: Scalars, v: Scalars, a: Scalars) -> list[list[Scalar]]:
    """Y(q, v, a), nv x 10 n, with tau = Y p: ten columns per body, in the order of `body_regressor`.

    p is expressed in the bodies' own frames, as a file gives them; torques due to rotors' spin are not included.
    """
    moved = motions(system, q, v, a)
    return _of_bodies(system, moved, moved)


def required_torque_regressor(system: System, q: Scalars, v: Scalars, v_r: Scalars, a_r: Scalars) -> list[list[Scalar]]:
    """Y(q, v, v_r, a_r), nv x 10 n, with Y p = M a_r + C(q, v) v_r + g.  Slotine and Li (1987)."""
    actual, required = required_motions(system, q, v, v_r, a_r)
    return _of_bodies(system, actual, required)


def required_rotor_torques(system: System, q: Scalars, v: Scalars, v_r: Scalars, a_r: Scalars) -> list[Scalar]:
    """Torques that `required_torque_regressor` leaves out: armature, and with full coupling those of rotors' spins.

    These are the torques of the system with massless bodies.
    """
    nothing = inertia_of([0] * 10)
    weightless = tuple(replace(segment, inertia=nothing) for segment in system.segments)
    return required_inverse_dynamics(replace(system, segments=weightless), q, v, v_r, a_r)


def _of_bodies(system: System, actual: list[BodyMotion], required: list[BodyMotion]) -> list[list[Scalar]]:
    columns = velocity_columns(system, [m.X for m in actual])
    Y: list[list[Scalar]] = [[0] * (10 * len(actual)) for _ in range(system.nv)]
    for i, (segment, m, m_r) in enumerate(zip(system.segments, actual, required, strict=True)):
        omega, omega_r = (segment.to_user_axes @ x.V.angular for x in (m, m_r))
        wrenches = body_regressor(segment.in_own_axes(m_r.A), omega, omega_r)
        # joint torque = power of the wrench at unit speed
        for j, column in columns[i].items():
            own = segment.in_own_axes(column)
            for k, F in enumerate(wrenches):
                Y[j][10 * i + k] = own.power(F)
    return Y

"""Derivatives of what a robot can compute, as functions of its machine and of lists of scalars: see `definitions`.

Derivatives with respect to q are taken along tangent directions, those of `Robot.integrate`.
"""

from collections import namedtuple
from functools import partial
from typing import Any, NamedTuple

from cutpoint import definitions
from cutpoint.definitions import Machine, Scalars, transposed
from cutpoint.kernels import jacobian_of
from cutpoint.mechanics import kinematics, torque_derivatives
from cutpoint.mechanics.elastic import Options
from cutpoint.mechanics.elastic_forward import SLOPES, effort_slopes
from cutpoint.mechanics.forward_dynamics import solve_symmetric
from cutpoint.mechanics.harmonic_drive import DriveState
from cutpoint.mechanics.joints import dot

Matrix = list[Scalars]

DriveSlopes = namedtuple("DriveSlopes", SLOPES)
"""By drive."""


class InverseDynamicsDerivatives(NamedTuple):
    """d torque / d (q, v, a), a row for each torque."""

    d_q: Matrix
    d_v: Matrix
    d_a: Matrix


class ForwardDynamicsDerivatives(NamedTuple):
    """d a / d (q, v, tau), a row for each acceleration."""

    d_q: Matrix
    d_v: Matrix
    d_tau: Matrix


def inverse_dynamics(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> InverseDynamicsDerivatives:
    """By the mechanics' own rules where they take the joints: in seven tenths of the derived operations on Panda, in as
    many on UR10."""
    if torque_derivatives.suits(m.system):
        return InverseDynamicsDerivatives(*torque_derivatives.torque_derivatives(m.system, q, v, a))
    d_q, d_v, d_a = jacobian_of(partial(definitions.inverse_dynamics, m))(q=q, v=v, a=a)
    return InverseDynamicsDerivatives(_along_tangents(m, q, d_q), d_v, d_a)


def forward_dynamics(m: Machine, q: Scalars, v: Scalars, tau: Scalars) -> ForwardDynamicsDerivatives:
    """From M d_a = d_tau - d(inverse dynamics at that a).  Carpentier and Mansard (2018).

    That takes three fifths of the operations of the derived recursion on the paper's arm, four fifths on UR10, and half
    on Panda.
    """
    M, bias = definitions.mass(m, q), definitions.bias_forces(m, q, v)
    a = solve_symmetric(M, [t - b for t, b in zip(tau, bias, strict=True)])
    d_q, d_v, _ = inverse_dynamics(m, q, v, a)
    unit = _unit(m.system.nv)
    return ForwardDynamicsDerivatives(_solved(M, _negated(d_q)), _solved(M, _negated(d_v)), _solved(M, unit))


def elastic_inverse_dynamics(m: Machine, options: Options, q: Scalars, **rates: Scalars) -> Any:
    """d motor_torque / d (q and each of the rates), named d_motor_torque_d_q and so on."""
    function = partial(definitions.elastic_inverse_dynamics, m, options)
    return _with_tangents(m, q, jacobian_of(function, of=["motor_torque"])(q=q, **rates))


def elastic_forward_dynamics(m: Machine, **state: Scalars) -> Any:
    """d (a, theta_ddot) / d (q, v, theta, theta_dot, motor_torque), named d_a_d_q and so on."""
    return _with_tangents(m, state["q"], jacobian_of(partial(definitions.elastic_forward_dynamics, m))(**state))


def drive_slopes(m: Machine, **state: Scalars) -> Any:
    """d (what a drive does to its link, what it leaves its own rotor) / d (each number of its state), by drive."""
    q, v, theta, theta_dot, motor_torque = state.values()
    rows = [
        effort_slopes(d.drive, DriveState(q[d.q], v[d.v], x, w), u)
        for d, x, w, u in zip(m.drives, theta, theta_dot, motor_torque, strict=True)
    ]
    return DriveSlopes(*map(list, zip(*rows, strict=True)))


def _along_tangents(m: Machine, q: Scalars, rows: Matrix) -> Matrix:
    """Derivatives with respect to the coordinates q, as derivatives along the directions of the speeds."""
    directions = [kinematics.coordinate_rates(m.system, q, column) for column in _unit(m.system.nv)]
    return [[dot(direction, row) for direction in directions] for row in rows]


def _with_tangents(m: Machine, q: Scalars, found: Any) -> Any:
    """The same for all that ends in _d_q."""
    names = [name for name in found._fields if name.endswith("_d_q")]
    return found._replace(**{name: _along_tangents(m, q, getattr(found, name)) for name in names})


def _solved(M: Matrix, rows: Matrix) -> Matrix:
    """X with M X = rows."""
    return transposed([solve_symmetric(M, column) for column in transposed(rows)])


def _unit(n: int) -> list[list[int]]:
    return [[int(j == k) for j in range(n)] for k in range(n)]


def _negated(rows: Matrix) -> Matrix:
    return [[0 - x for x in row] for row in rows]

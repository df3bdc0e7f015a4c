"""Derivatives of a robot's functions, as functions of its machine and of lists of scalars: see `definitions`.

Derivatives with respect to q are along the tangent directions of `Robot.integrate`.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any, Generic, NamedTuple, TypeVar

from cutpoint import definitions
from cutpoint.definitions import Machine, Scalars, transposed
from cutpoint.drive_slopes import EffortSlopes, effort_slopes, motor_slopes
from cutpoint.kernels import jacobian_of
from cutpoint.mechanics import kinematics, torque_derivatives
from cutpoint.mechanics.bodies.joints import dot
from cutpoint.mechanics.drives.strains import UNKNOWN
from cutpoint.mechanics.elastic_forward import drive_effort, drive_states
from cutpoint.mechanics.elastic_inverse import Options
from cutpoint.mechanics.factors import Factors, factors_of, solve
from cutpoint.mechanics.torque_derivatives import along_motion
from cutpoint.scalars import Jet, Scalar

Matrix = list[Scalars]
Rows = TypeVar("Rows")


class InverseDynamicsDerivatives(NamedTuple, Generic[Rows]):
    """d torque / d (q, v, a), each (..., nv, nv) with a row for each torque; d_a is the mass matrix."""

    d_q: Rows
    d_v: Rows
    d_a: Rows


class ForwardDynamicsDerivatives(NamedTuple, Generic[Rows]):
    """d a / d (q, v, tau), each (..., nv, nv) with a row for each acceleration; d_tau is the mass matrix' inverse."""

    d_q: Rows
    d_v: Rows
    d_tau: Rows


class MotorTorqueDerivatives(NamedTuple, Generic[Rows]):
    """d motor_torque / d (q, v, a, jerk, snap), each (..., drives, nv), as kernels and exported code name them."""

    d_motor_torque_d_q: Rows
    d_motor_torque_d_v: Rows
    d_motor_torque_d_a: Rows
    d_motor_torque_d_jerk: Rows
    d_motor_torque_d_snap: Rows


class ElasticForwardDynamicsDerivatives(NamedTuple, Generic[Rows]):
    """d (a, theta_ddot) / d (q, v, theta, theta_dot, motor_torque).

    Each (..., rows, columns).  Rows: nv of a, drives of theta_ddot.  Columns: nv of q and v, drives of the others.
    """

    d_a_d_q: Rows
    d_a_d_v: Rows
    d_a_d_theta: Rows
    d_a_d_theta_dot: Rows
    d_a_d_motor_torque: Rows
    d_theta_ddot_d_q: Rows
    d_theta_ddot_d_v: Rows
    d_theta_ddot_d_theta: Rows
    d_theta_ddot_d_theta_dot: Rows
    d_theta_ddot_d_motor_torque: Rows


def inverse_dynamics(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> InverseDynamicsDerivatives[Matrix]:
    """By the analytic rules of the mechanics where they support the joints: in seven tenths of the operations of
    automatic differentiation on Panda, in as many on UR10."""
    if torque_derivatives.suits(m.system):
        return InverseDynamicsDerivatives(*torque_derivatives.torque_derivatives(m.system, q, v, a))
    d_q, d_v, d_a = jacobian_of(partial(definitions.inverse_dynamics, m))(q=q, v=v, a=a)
    return InverseDynamicsDerivatives(_along_tangents(m, q, d_q), d_v, d_a)


def forward_dynamics(m: Machine, q: Scalars, v: Scalars, tau: Scalars) -> ForwardDynamicsDerivatives[Matrix]:
    """From M d_a = d_tau - d(inverse dynamics at that a).  Carpentier and Mansard (2018).

    That takes three fifths of the operations of the differentiated recursion on the paper's arm, four fifths on UR10,
    and half on Panda.
    """
    M, bias = factors_of(definitions.mass_matrix(m, q)), definitions.bias_forces(m, q, v)
    a = solve(M, [t - b for t, b in zip(tau, bias, strict=True)])
    d_q, d_v, _ = inverse_dynamics(m, q, v, a)
    unit = _unit(m.system.nv)
    return ForwardDynamicsDerivatives(_solved(M, _negated(d_q)), _solved(M, _negated(d_v)), _solved(M, unit))


def elastic_inverse_dynamics(m: Machine, q: Scalars, *, options: Options, **rates: Scalars) -> tuple[Matrix, ...]:
    """d motor_torque / d (q and each of the rates), named d_motor_torque_d_q and so on.

    From inverse dynamics' derivatives with their rates along the motion, on Panda in three quarters of the operations
    of the differentiated recursion; by the latter for unsupported joints, or where rotors behind springs feel their
    carriers.
    """
    if torque_derivatives.suits(m.system) and not m.system.has_sprung_rotors:
        return MotorTorqueDerivatives(*_through_springs(m, options, q, *rates.values()))
    function = partial(definitions.elastic_inverse_dynamics, m, options=options)
    return _with_tangents(m, q, jacobian_of(function, of=["motor_torque"])(q=q, **rates))


def _through_springs(m: Machine, options: Options, *motion: Scalars) -> list[Matrix]:
    """A motor's torque depends on its joint's torque with two rates, and on its own joint's motion."""
    q, v, a = ([Jet(*x) for x in zip(*motion[k : k + 3], strict=True)] for k in range(3))
    torques = [_rates(x) for x in definitions.inverse_dynamics(m, q, v, a)]
    by = [[[_rates(x) for x in row] for row in d] for d in torque_derivatives.torque_derivatives(m.system, q, v, a)]
    found: list[Matrix] = [[] for _ in motion]
    for d in m.drives:
        slopes = motor_slopes(d.drive, [*torques[d.v], *(x[d.v] for x in motion)], options)
        for rate, rows in enumerate(found):
            row = [
                sum(h * along_motion(entry, k, rate) for k, h in enumerate(slopes[:3]))
                for entry in zip(*(x[d.v] for x in by), strict=True)
            ]
            row[d.v] = row[d.v] + slopes[3 + rate]
            rows.append(row)
    return found


def _rates(x: Scalar) -> Sequence[Scalar]:
    """A number and its first two time derivatives."""
    return x.derivatives if isinstance(x, Jet) else (x, 0, 0)


def elastic_forward_dynamics(m: Machine, **state: Scalars) -> ElasticForwardDynamicsDerivatives[Matrix]:
    """d (a, theta_ddot) / d (q, v, theta, theta_dot, motor_torque), named d_a_d_q and so on.

    From M d_a = d(drives' efforts on links) - d(inverse dynamics at that a), in three quarters of the operations of the
    differentiated recursion on UR10, and half on Panda; by the latter where rotors behind springs feel their carriers.
    """
    if m.system.has_sprung_rotors:
        found = jacobian_of(partial(definitions.elastic_forward_dynamics, m))(**state)
        return ElasticForwardDynamicsDerivatives(*_with_tangents(m, state["q"], found))
    return ElasticForwardDynamicsDerivatives(*_through_drives(m, *state.values()))


def _through_drives(m: Machine, *state: Scalars) -> list[Matrix]:
    """d a / d (q, v, theta, theta_dot, motor_torque), then those of theta_ddot."""
    (q, v, *motors), nv, n, links = state, m.system.nv, len(m.drives), [d.v for d in m.drives]
    M, tau = factors_of(definitions.mass_matrix(m, q)), [0 - b for b in definitions.bias_forces(m, q, v)]
    for d, at, torque in zip(m.drives, drive_states(m.drives, q, v, *motors[:2]), motors[2], strict=True):
        tau[d.v] = tau[d.v] + drive_effort(d.drive, at, torque, UNKNOWN).on_link
    d_q, d_v, _ = inverse_dynamics(m, q, v, solve(M, tau))
    # column of each drive's q, v, theta, theta_dot and motor_torque, and how many columns there are
    columns = [(links, nv)] * 2 + [([*range(n)], n)] * 3
    forces = [_negated(d_q), _negated(d_v), *([[0] * n for _ in range(nv)] for _ in range(3))]
    slopes = drive_slopes(m, *state)
    for rows, given, (at, _) in zip(forces, slopes[:5], columns, strict=True):
        for link, k, x in zip(links, at, given, strict=True):
            rows[link][k] = rows[link][k] + x
    d_a = [_solved(M, rows) for rows in forces]
    # a rotor depends on its own drive's state; a rigid drive's moves with its link
    alpha = [
        [_row(x, k, width) if d.drive.is_elastic else rows[d.v] for d, k, x in zip(m.drives, at, own, strict=True)]
        for rows, own, (at, width) in zip(d_a, slopes[5:], columns, strict=True)
    ]
    return [*d_a, *alpha]


def drive_slopes(
    m: Machine, q: Scalars, v: Scalars, theta: Scalars, theta_dot: Scalars, motor_torque: Scalars
) -> EffortSlopes[Scalars]:
    """Derivatives of each drive's effort on its link, and of its rotor's acceleration, by each number of its state."""
    pairs = zip(m.drives, drive_states(m.drives, q, v, theta, theta_dot), motor_torque, strict=True)
    rows = [effort_slopes(d.drive, [*at, torque]) for d, at, torque in pairs]
    return EffortSlopes(*([row[k] for row in rows] for k in range(len(EffortSlopes._fields))))


def _along_tangents(m: Machine, q: Scalars, rows: Matrix) -> Matrix:
    """Derivatives with respect to the coordinates q, converted to those along the directions of the speeds."""
    directions = [kinematics.coordinate_rates(m.system, q, column) for column in _unit(m.system.nv)]
    return [[dot(direction, row) for direction in directions] for row in rows]


def _with_tangents(m: Machine, q: Scalars, found: Any) -> Any:
    """The same for all names that end in _d_q."""
    names = [name for name in found._fields if name.endswith("_d_q")]
    return found._replace(**{name: _along_tangents(m, q, getattr(found, name)) for name in names})


def _solved(M: Factors, rows: Matrix) -> Matrix:
    """X with M X = rows, which may be empty."""
    return transposed([solve(M, column) for column in transposed(rows)]) or rows


def _row(x: Scalar, at: int, length: int) -> Scalars:
    """A row of zeros except for one number."""
    return [x if k == at else 0 for k in range(length)]


def _unit(n: int) -> list[list[int]]:
    return [[int(j == k) for j in range(n)] for k in range(n)]


def _negated(rows: Matrix) -> Matrix:
    return [[0 - x for x in row] for row in rows]

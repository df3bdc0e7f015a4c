"""What a robot can compute, as functions of its machine and of lists of scalars: the bodies of its kernels."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from cutpoint.mechanics import drive_regressor as drives
from cutpoint.mechanics import elastic, elastic_forward, kinematics, mass_matrix, power_flow, regressor
from cutpoint.mechanics import forward_dynamics as forward
from cutpoint.mechanics import inverse_dynamics as inverse
from cutpoint.mechanics.drive_regressor import DriveRegressor
from cutpoint.mechanics.elastic import Driven, ElasticMotion, Options
from cutpoint.mechanics.elastic_forward import DriveState, ElasticAccelerations
from cutpoint.mechanics.harmonic_drive import friction_torque, motor_position, spring_torque
from cutpoint.mechanics.spatial import Pose, Vec3, Wrench
from cutpoint.mechanics.strains import Strains, drive_by_drive
from cutpoint.mechanics.system import System

Scalars = list[Any]


class Machine(NamedTuple):
    """What the equations are written on: the system, and its drives with the coordinates they drive."""

    system: System
    drives: list[Driven]


def inverse_dynamics(m: Machine, q: Scalars, v: Scalars, a: Scalars, **wrenches: Scalars) -> Scalars:
    return inverse.inverse_dynamics(m.system, q, v, a, _contact(wrenches))


def forward_dynamics(m: Machine, q: Scalars, v: Scalars, tau: Scalars, **wrenches: Scalars) -> Scalars:
    return forward.forward_dynamics(m.system, q, v, tau, _contact(wrenches))


def bias_forces(m: Machine, q: Scalars, v: Scalars) -> Scalars:
    return inverse.inverse_dynamics(m.system, q, v, [0] * m.system.nv)


def gravity_forces(m: Machine, q: Scalars) -> Scalars:
    still = [0] * m.system.nv
    return inverse.inverse_dynamics(m.system, q, still, still)


def coriolis_matrix(m: Machine, q: Scalars, v: Scalars) -> list[Scalars]:
    still, weight = [0] * m.system.nv, gravity_forces(m, q)
    columns = []
    for k in range(m.system.nv):
        unit = [int(j == k) for j in range(m.system.nv)]
        tau = inverse.required_inverse_dynamics(m.system, q, v, unit, still)
        columns.append([t - g for t, g in zip(tau, weight, strict=True)])
    return transposed(columns)


def mass(m: Machine, q: Scalars) -> list[Scalars]:
    return mass_matrix.mass_matrix(m.system, q)


def kinetic_energy(m: Machine, q: Scalars, v: Scalars) -> Any:
    return mass_matrix.kinetic_energy_of(m.system, q, v)


def potential_energy(m: Machine, q: Scalars) -> Any:
    return mass_matrix.potential_energy_of(m.system, q)


def momentum(m: Machine, q: Scalars, v: Scalars, theta_dot: Scalars | None = None) -> Scalars:
    return [*mass_matrix.momentum_of(m.system, q, v, _rotor_speeds(m, theta_dot))]


def torque_regressor(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> list[Scalars]:
    return regressor.torque_regressor(m.system, q, v, a)


def power_flows(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> Scalars:
    return power_flow.power_flows(m.system, q, v, a)


def integrate(m: Machine, q: Scalars, v: Scalars, dt: Any) -> Scalars:
    return kinematics.integrate(m.system, q, [dt * x for x in v])


def difference(m: Machine, q: Scalars, q_next: Scalars) -> Scalars:
    return kinematics.difference(m.system, q, q_next)


def coordinate_rates(m: Machine, q: Scalars, v: Scalars) -> Scalars:
    return kinematics.coordinate_rates(m.system, q, v)


def elastic_inverse_dynamics(
    m: Machine, options: Options, q: Scalars, strains: Scalars | None = None, **rates: Scalars
) -> ElasticMotion:
    held = _held(m, strains)
    return elastic.elastic_inverse_dynamics(m.system, m.drives, q, *rates.values(), options=options, strains=held)


def elastic_forward_dynamics(m: Machine, strains: Scalars | None = None, **state: Scalars) -> ElasticAccelerations:
    return elastic_forward.elastic_forward_dynamics(m.system, m.drives, **state, strains=_held(m, strains))


def elastic_energy(
    m: Machine,
    q: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
    strains: Scalars | None = None,
    v: Scalars | None = None,
) -> Any:
    own = elastic.elastic_energy(m.drives, q, theta, theta_dot, _held(m, strains))
    return own if v is None else own + mass_matrix.carried_energy_of(m.system, q, v, _rotor_speeds(m, theta_dot))


def drive_torque(m: Machine, theta: Scalars, q: Scalars) -> Scalars:
    """Spring torque of each elastic drive; a rigid one shows none."""
    return [
        spring_torque(d.drive, theta_k, q[d.q]) if d.drive.is_elastic else 0.0
        for d, theta_k in zip(m.drives, theta, strict=True)
    ]


def static_deflection(m: Machine, q: Scalars) -> Scalars:
    """How far each motor leads its link when nothing moves, rad: the spring's answer to gravity."""
    weight = gravity_forces(m, q)
    return [
        motor_position(d.drive, q[d.q] + d.drive.compliance.deflection(weight[d.v])) - q[d.q]
        if d.drive.compliance
        else 0.0
        for d in m.drives
    ]


def friction_torques(m: Machine, v: Scalars) -> Scalars:
    """What link-side friction takes at each speed, N m."""
    xi: Scalars = [0] * m.system.nv
    for d in m.drives:
        xi[d.v] = friction_torque(d.drive.link_friction, v[d.v])
    return xi


def drive_regressor(
    m: Machine, q: Scalars, v: Scalars, theta: Scalars, theta_dot: Scalars, theta_ddot: Scalars
) -> DriveRegressor:
    states = [DriveState(q[d.q], v[d.v], x, w) for d, x, w in zip(m.drives, theta, theta_dot, strict=True)]
    return drives.drive_regressor(m.drives, states, theta_ddot)


def frame_pose(m: Machine, q: Scalars, frame: str) -> list[Scalars]:
    return matrix_of(kinematics.frame_pose(m.system, q, frame))


def jacobian(m: Machine, q: Scalars, frame: str, expressed_in: kinematics.ExpressedIn) -> list[Scalars]:
    return transposed([[*column] for column in kinematics.jacobian(m.system, q, frame, expressed_in)]) or [[]] * 6


def velocity_map(m: Machine, q: Scalars) -> list[Scalars]:
    rows = kinematics.velocity_map(m.system, q)
    return [row for body in rows for row in transposed([[*column] for column in body])]


def _rotor_speeds(m: Machine, theta_dot: Scalars | None) -> dict[int, Any]:
    """Speeds of the drives' rotors over ratio, by the segment that they drive; none where they are not told."""
    return {} if theta_dot is None else {d.segment: w for d, w in zip(m.drives, theta_dot, strict=True)}


def _held(m: Machine, strains: Scalars | None) -> list[Strains] | None:
    return None if strains is None else drive_by_drive([d.drive for d in m.drives], strains)


def matrix_of(X: Pose) -> list[Scalars]:
    """A pose as 4 rows of 4."""
    return [[*row, p] for row, p in zip(X.rotation, X.position, strict=True)] + [[0.0, 0.0, 0.0, 1.0]]


def transposed(columns: list[Scalars]) -> list[Scalars]:
    return [[*row] for row in zip(*columns, strict=True)]


def _contact(wrenches: Mapping[str, Scalars]) -> dict[str, Wrench]:
    """F_e of Xia (2019) eq. (44) is what the robot exerts; users state what is exerted on it."""
    return {name: Wrench(-Vec3(*F[:3]), -Vec3(*F[3:])) for name, F in wrenches.items()}

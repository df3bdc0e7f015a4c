"""A robot's functions, defined on its machine and lists of scalars: the bodies of its kernels.

q (nq), v, a (nv) and torques tau (nv) are of the joints, in the mechanism's order; theta and its rates, motor torques
and strains are of the drives, in the drives' order, all on the joint side.  Units are SI; the corresponding methods of
`Robot` describe each function and cite its source.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from cutpoint.mechanics import drive_regressor as drives
from cutpoint.mechanics import elastic_forward, elastic_inverse, energy, kinematics, power_flow
from cutpoint.mechanics import forward_dynamics as forward
from cutpoint.mechanics import inverse_dynamics as inverse
from cutpoint.mechanics import mass_matrix as mass
from cutpoint.mechanics import regressor as regression
from cutpoint.mechanics.bodies.spatial import Pose, Vec3, Wrench
from cutpoint.mechanics.drive_regressor import DriveRegressor
from cutpoint.mechanics.drives.harmonic_drive import friction_torque, spring_torque, static_lead
from cutpoint.mechanics.drives.strains import Strains, drive_by_drive
from cutpoint.mechanics.elastic_forward import ElasticAccelerations
from cutpoint.mechanics.elastic_inverse import DEFAULT, ElasticTorques, Options
from cutpoint.mechanics.required_dynamics import required_inverse_dynamics
from cutpoint.mechanics.system import Driven, System

Scalars = list[Any]


class Machine(NamedTuple):
    """Argument of all equations: the system, and its drives with the coordinates they drive."""

    system: System
    drives: list[Driven]


def inverse_dynamics(m: Machine, q: Scalars, v: Scalars, a: Scalars, **wrenches: Scalars) -> Scalars:
    """Torques of a motion (nv), N m (N).  wrenches: [f; m] on the robot by frame, in its axes."""
    return inverse.inverse_dynamics(m.system, q, v, a, _contact(wrenches))


def forward_dynamics(m: Machine, q: Scalars, v: Scalars, tau: Scalars, **wrenches: Scalars) -> Scalars:
    """Accelerations under torques (nv), rad/s2 (m/s2).  wrenches: as in `inverse_dynamics`."""
    return forward.forward_dynamics(m.system, q, v, tau, _contact(wrenches))


def bias_forces(m: Machine, q: Scalars, v: Scalars) -> Scalars:
    """Torques that keep the accelerations zero (nv): C v + g."""
    return inverse.inverse_dynamics(m.system, q, v, [0] * m.system.nv)


def gravity_forces(m: Machine, q: Scalars) -> Scalars:
    """Torques that hold the robot at rest (nv): g."""
    still = [0] * m.system.nv
    return inverse.inverse_dynamics(m.system, q, still, still)


def coriolis_matrix(m: Machine, q: Scalars, v: Scalars) -> list[Scalars]:
    """C (nv, nv) of virtual decomposition: dM/dt - 2 C is skew.  Xia (2019) eq. (61)."""
    still, weight = [0] * m.system.nv, gravity_forces(m, q)
    columns: list[Scalars] = []
    for k in range(m.system.nv):
        unit = [int(j == k) for j in range(m.system.nv)]
        tau = required_inverse_dynamics(m.system, q, v, unit, still)
        columns.append([t - g for t, g in zip(tau, weight, strict=True)])
    return transposed(columns)


def mass_matrix(m: Machine, q: Scalars) -> list[Scalars]:
    """M (nv, nv), with rigidly geared rotors."""
    return mass.mass_matrix(m.system, q)


def kinetic_energy(m: Machine, q: Scalars, v: Scalars) -> Any:
    """Kinetic energy of links and rigidly geared rotors, J."""
    return energy.kinetic_energy(m.system, q, v)


def potential_energy(m: Machine, q: Scalars) -> Any:
    """Gravitational potential energy, J."""
    return energy.potential_energy(m.system, q)


def momentum(m: Machine, q: Scalars, v: Scalars, theta_dot: Scalars | None = None) -> Scalars:
    """Linear and angular (6), about the world's origin and along its axes."""
    return [*energy.momentum(m.system, q, v, _rotor_speeds(m, theta_dot))]


def regressor(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> list[Scalars]:
    """Y (nv, 10 bodies): torques are Y times the bodies' inertial parameters."""
    return regression.torque_regressor(m.system, q, v, a)


def power_flows(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> Scalars:
    """Power that passes outward through each cut, W."""
    return power_flow.power_flows(m.system, q, v, a)


def integrate(m: Machine, q: Scalars, v: Scalars, dt: Any) -> Scalars:
    """q after dt at constant v (nq)."""
    return kinematics.integrate(m.system, q, [dt * x for x in v])


def difference(m: Machine, q: Scalars, q_next: Scalars) -> Scalars:
    """The v that leads from q to q_next in 1 s (nv)."""
    return kinematics.difference(m.system, q, q_next)


def coordinate_rates(m: Machine, q: Scalars, v: Scalars) -> Scalars:
    """dq/dt of v (nq)."""
    return kinematics.coordinate_rates(m.system, q, v)


def elastic_inverse_dynamics(
    m: Machine,
    q: Scalars,
    v: Scalars,
    a: Scalars,
    jerk: Scalars,
    snap: Scalars,
    strains: Scalars | None = None,
    *,
    options: Options = DEFAULT,
    **higher: Scalars,
) -> ElasticTorques[Scalars]:
    """Motor torques and motion for a motion, N m (N) and rad (m): see `mechanics.elastic_inverse`.

    higher: derivatives beyond, in rising order.
    """
    rates, held = (v, a, jerk, snap, *higher.values()), _held(m, strains)
    return elastic_inverse.elastic_inverse_dynamics(m.system, m.drives, q, *rates, options=options, strains=held)


def elastic_forward_dynamics(
    m: Machine,
    q: Scalars,
    v: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
    motor_torque: Scalars,
    strains: Scalars | None = None,
) -> ElasticAccelerations[Scalars]:
    """Accelerations of links and motors, rad/s2 (m/s2): see `mechanics.elastic_forward`."""
    state, held = (q, v, theta, theta_dot, motor_torque), _held(m, strains)
    return elastic_forward.elastic_forward_dynamics(m.system, m.drives, *state, strains=held)


def elastic_energy(
    m: Machine,
    q: Scalars,
    theta: Scalars,
    theta_dot: Scalars,
    strains: Scalars | None = None,
    v: Scalars | None = None,
) -> Any:
    """Energy of springs and rotors, J; with v, also that of rotors due to their carriers' motion."""
    own = energy.elastic_energy(m.drives, q, theta, theta_dot, _held(m, strains))
    return own if v is None else own + energy.carried_energy(m.system, q, v, _rotor_speeds(m, theta_dot))


def drive_torque(m: Machine, theta: Scalars, q: Scalars) -> Scalars:
    """Spring torque of each elastic drive; zero for a rigid one."""
    return [
        spring_torque(d.drive, theta_k, q[d.q]) if d.drive.is_elastic else 0.0
        for d, theta_k in zip(m.drives, theta, strict=True)
    ]


def static_deflection(m: Machine, q: Scalars) -> Scalars:
    """How far each motor leads its link at rest under gravity, rad."""
    weight = gravity_forces(m, q)
    return [static_lead(d.drive, q[d.q], weight[d.v]) for d in m.drives]


def friction_torques(m: Machine, v: Scalars) -> Scalars:
    """Link-side friction at each speed, N m."""
    xi: Scalars = [0] * m.system.nv
    for d in m.drives:
        xi[d.v] = friction_torque(d.drive.link_friction, v[d.v])
    return xi


def drive_regressor(
    m: Machine, q: Scalars, v: Scalars, theta: Scalars, theta_dot: Scalars, theta_ddot: Scalars
) -> DriveRegressor:
    """Torques of the drives by their own parameters: see `mechanics.drive_regressor`."""
    states = elastic_forward.drive_states(m.drives, q, v, theta, theta_dot)
    return drives.drive_regressor(m.drives, states, theta_ddot)


def frame_pose(m: Machine, q: Scalars, frame: str) -> list[Scalars]:
    """Pose of a frame in the world (4, 4)."""
    return matrix_of(kinematics.frame_pose(m.system, q, frame))


def jacobian(m: Machine, q: Scalars, frame: str, expressed_in: kinematics.ExpressedIn) -> list[Scalars]:
    """Jacobian of a frame (6, nv), linear above angular."""
    return transposed([[*column] for column in kinematics.jacobian(m.system, q, frame, expressed_in)]) or [[]] * 6


def frame_acceleration(
    m: Machine, q: Scalars, v: Scalars, a: Scalars, frame: str, expressed_in: kinematics.ExpressedIn
) -> Scalars:
    """Time derivative of a frame's velocity (6), linear above angular."""
    return [*kinematics.frame_acceleration(m.system, q, v, a, frame, expressed_in)]


def velocity_map(m: Machine, q: Scalars) -> list[Scalars]:
    """Velocities of all bodies, each in its joint's frame, by the speeds (6 bodies, nv)."""
    rows = kinematics.velocity_map(m.system, q)
    return [row for body in rows for row in transposed([[*column] for column in body])]


def _rotor_speeds(m: Machine, theta_dot: Scalars | None) -> dict[int, Any]:
    """Speeds of the drives' rotors over ratio, by the segment that they drive; empty if not given."""
    return {} if theta_dot is None else {d.segment: w for d, w in zip(m.drives, theta_dot, strict=True)}


def _held(m: Machine, strains: Scalars | None) -> list[Strains] | None:
    return None if strains is None else drive_by_drive([d.drive for d in m.drives], strains)


def matrix_of(X: Pose) -> list[Scalars]:
    """A pose as 4 rows of 4."""
    return [[*row, p] for row, p in zip(X.rotation, X.position, strict=True)] + [[0.0, 0.0, 0.0, 1.0]]


def transposed(columns: list[Scalars]) -> list[Scalars]:
    return [[*row] for row in zip(*columns, strict=True)]


def _contact(wrenches: Mapping[str, Scalars]) -> dict[str, Wrench]:
    """F_e of Xia (2019) eq. (44) is exerted by the robot; users give the wrench exerted on it."""
    return {name: Wrench(-Vec3(*F[:3]), -Vec3(*F[3:])) for name, F in wrenches.items()}

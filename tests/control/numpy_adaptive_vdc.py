"""Adaptive VDC once more, in NumPy: torque of a sample, and what it learns from that."""

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy_drives import coefficients, columns
from numpy_laws import TURN, Filter, joints, sizes_of
from numpy_plant import Plant

from cutpoint import LinearSpring
from robot_library import Array

UPPER = np.triu_indices(3)


def pseudo_inertia(p: Array) -> Array:
    """[sum of r r^T dm, h; h^T, m].  Wensing, Kim and Slotine (2018)."""
    I = np.zeros((3, 3))
    I[UPPER] = p[4:]
    I = I + np.triu(I, 1).T
    return np.block([[np.trace(I) / 2 * np.eye(3) - I, p[1:4, None]], [p[None, 1:4], np.array([[p[0]]])]])


UNITS = np.array([pseudo_inertia(p) for p in np.eye(10)])
DUALS = np.linalg.solve(np.einsum("aij,bij->ab", UNITS, UNITS), UNITS.reshape(10, 16)).reshape(10, 4, 4)
"""tr(DUALS[a] UNITS[b]) is 1 where a = b, else 0."""


def parameters_of(L: Array) -> Array:
    return np.einsum("aij,ij->a", DUALS, L)


def natural(p: Array, s: Array, gain: float) -> Array:
    """L' = rate L S L over a period, gain = rate * period, by the root that the law says it takes."""
    L, S = pseudo_inertia(p), np.einsum("a,aij->ij", s, DUALS)
    half = np.eye(4) + gain * L @ S / 2
    root = (np.eye(4) + half @ half) / 2
    return parameters_of(root @ root @ L)


def turned(p: Array, R: Array) -> Array:
    """A body's parameters in the axes in which R has its own axes as columns."""
    T = np.eye(4)
    T[:3, :3] = R
    return parameters_of(T @ pseudo_inertia(p) @ T.T)


@dataclass
class Memory:
    """bodies (n, 10), each in the frame whose z is its joint's axis, and joints' numbers."""

    bodies: Array
    joints: list[Array]
    filter: Any = field(repr=False)


def numbers_of(drive: Any) -> Array:
    spring = [1 / drive.compliance.stiffness] if isinstance(drive.compliance, LinearSpring) else []
    rotor = [] if drive.rotor is None else [drive.reflected_inertia]
    return np.array([*coefficients(drive.link_friction), *rotor, *spring, *coefficients(drive.motor_friction)])


def with_numbers(drive: Any, x: Array) -> Any:
    def law(own: Any) -> Any:
        nonlocal x
        if own is None:
            return None
        names = own.coefficients
        found, x = replace(own, **dict(zip(names, x, strict=False))), x[len(names) :]
        return found

    drive = replace(drive, link_friction=law(drive.link_friction))
    if drive.rotor is not None:
        drive, x = replace(drive, rotor=replace(drive.rotor, inertia=x[0] / drive.ratio**2)), x[1:]
    if isinstance(drive.compliance, LinearSpring):
        drive, x = replace(drive, compliance=LinearSpring(1 / x[0])), x[1:]
    return replace(drive, motor_friction=law(drive.motor_friction))


def adaptive_vdc(law: Any, plant: Plant, memory: Memory | None, m: Any, r: Any) -> tuple[Any, Array, Array, Array]:
    """Torque and reference by the numbers believed; p' = rate * size^2 * (what power a unit of p misses)."""
    memory = memory or start(law, plant)
    v_r, a_r = r.v + law.position_gain * (r.q - m.q), r.a + law.position_gain * (r.v - m.v)
    lag = v_r - m.v
    tau, bodies = of_bodies(law, plant, memory.bodies, m, v_r, a_r)
    believed = [with_numbers(d, x) for d, x in zip(plant.drives, memory.joints, strict=True)]
    mine = replace(plant, believed=believed)
    tau = tau + mine.armature * a_r + mine.link_frictions(v_r, m.v) + law.speed_gain * lag
    told = joints(mine, law, m, r, [v_r, a_r], np.array([tau, *memory.filter.step(tau, m.period)]))
    learnt = [
        learnt_by(law, plant.drives[k], x, m, JointPowers(lag[k], v_r[k], tau[k], *told[2:, k], m.theta_dot[k]))
        for k, x in enumerate(memory.joints)
    ]
    return Memory(bodies, learnt, memory.filter), *told[:3]


def start(law: Any, plant: Plant) -> Memory:
    own = [numbers_of(d) for d in plant.drives]
    return Memory(nominal_bodies(plant), own, Filter(TURN * law.filter_bandwidth[0]))


def turns_of(plant: Plant) -> list[Array]:
    """Of each body, R with p in its joint's frame = turned(p in its own, R)."""
    return [np.array([[*row] for row in segment.to_user_axes]).T for segment in plant.robot.machine.system.segments]


def nominal_bodies(plant: Plant) -> Array:
    own = plant.robot.inertial_parameters.reshape(-1, 10)
    return np.array([turned(p, R) for p, R in zip(own, turns_of(plant), strict=True)])


def of_bodies(law: Any, plant: Plant, bodies: Array, m: Any, v_r: Array, a_r: Array) -> tuple[Array, Array]:
    """Joint torques of all bodies' required wrenches, and what each body has learnt."""
    tau, learnt, lag = np.zeros(len(v_r)), [], v_r - m.v
    wrenches = plant.body_wrenches(m.q, m.v, v_r, a_r)
    bodies_known = zip(wrenches, turns_of(plant), bodies, nominal_bodies(plant), strict=True)
    for k, ((J, W), R, p, nominal) in enumerate(bodies_known):
        F = W @ turned(p, R.T)
        if law.body_gain is not None:
            F = F + law.body_gain[k] @ J @ lag
        tau += J.T @ F
        learnt.append(updated(law, p, nominal, power_of(W.T @ J @ lag, R), m.period))
    return tau, np.array(learnt)


def updated(law: Any, p: Array, nominal: Array, s: Array, period: float) -> Array:
    gain, reach = law.body_rate[0] * period, law.uncertainty[0] * sizes_of(nominal)
    if law.update == "natural":
        return natural(p, s, gain)
    return np.clip(p + gain * sizes_of(nominal) ** 2 * s, nominal - reach, nominal + reach)


def power_of(s: Array, R: Array) -> Array:
    """What s^T p is a gradient of, in the axes in which p is `turned` by R: s^T p stays what it was."""
    return np.array([s @ turned(unit, R.T) for unit in np.eye(10)])


class JointPowers(NamedTuple):
    """Of one joint: v_r - v, v_r, tau_r, and the motor's required speed and acceleration, and speed."""

    lag: float
    v_r: float
    tau_r: float
    speed: float
    acceleration: float
    theta_dot: float


def learnt_by(law: Any, drive: Any, x: Array, m: Any, p: JointPowers) -> Array:
    """A joint's numbers a period later, each in its share of the nominal ones."""
    motor_lag = p.speed - p.theta_dot if drive.is_elastic else p.lag
    s = [y * p.lag for y in columns(drive.link_friction, p.v_r, p.v_r)]
    if drive.rotor is not None:
        s.append(p.acceleration * motor_lag)
    if isinstance(drive.compliance, LinearSpring):
        s.append(drive.compliance.stiffness * p.tau_r * (p.lag - motor_lag))
    s += [y * motor_lag for y in columns(drive.motor_friction, p.speed, p.speed)]
    x_0, share = numbers_of(drive), law.uncertainty[0]
    return np.clip(x + law.joint_rate[0] * m.period * x_0**2 * s, (1 - share) * x_0, (1 + share) * x_0)

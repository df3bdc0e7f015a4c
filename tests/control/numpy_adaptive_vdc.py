"""Adaptive VDC once more, in NumPy: torque of a sample, and what it learns from that."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from cutpoint import LinearSpring
from numpy_laws import TURN, Filter, joints, sizes_of
from numpy_plant import Plant, coefficients, columns
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
    """L' = rate L S L over a period, gain = rate * period, by the root of its exponential that the law says it takes."""
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
    """Torque and reference by the numbers believed; p' = rate * size^2 * (power that a unit of p misses), or natural."""
    turns = [np.array([[*row] for row in segment.turn]).T for segment in plant.robot.machine.system.segments]
    nominal = [turned(p, R) for p, R in zip(plant.robot.inertial_parameters.reshape(-1, 10), turns, strict=True)]
    own = [numbers_of(d) for d in plant.drives]
    memory = memory or Memory(np.array(nominal), own, Filter(TURN * law.filter_bandwidth[0]))
    v_r, a_r = r.v + law.position_gain * (r.q - m.q), r.a + law.position_gain * (r.v - m.v)
    lag, period = v_r - m.v, m.period
    believed = [with_numbers(d, x) for d, x in zip(plant.drives, memory.joints, strict=True)]
    tau, bodies = np.zeros(len(own)), []
    # bodies
    for k, (J, W) in enumerate(plant.body_wrenches(m.q, m.v, v_r, a_r)):
        R = turns[k]
        F = W @ turned(memory.bodies[k], R.T)
        if law.body_gain is not None:
            F = F + law.body_gain[k] @ J @ lag
        tau += J.T @ F
        s = power_of(W.T @ J @ lag, R)
        size, share = sizes_of(nominal[k]), law.uncertainty[0]
        if law.update == "natural":
            bodies.append(natural(memory.bodies[k], s, law.body_rate[0] * period))
        else:
            learnt = memory.bodies[k] + law.body_rate[0] * period * size**2 * s
            bodies.append(np.clip(learnt, nominal[k] - share * size, nominal[k] + share * size))
    # joints, by the drives believed in
    mine = SimpleNamespace(robot=plant.robot, drives=believed, wound=lambda x: Plant.wound(SimpleNamespace(drives=believed), x))
    rotors = np.array([0.0 if d.is_elastic else d.reflected_inertia for d in believed])
    tau = tau + rotors * a_r + Plant.link_frictions(mine, v_r) + law.speed_gain * lag
    told = joints(mine, law, m, r, [v_r, a_r], np.array([tau, *memory.filter.step(tau, period)]))
    learnt = []
    for k, drive in enumerate(plant.drives):
        elastic = drive.is_elastic
        motor_lag = told[2, k] - m.theta_dot[k] if elastic else lag[k]
        s = [x * lag[k] for x in columns(drive.link_friction, v_r[k])]
        if drive.rotor is not None:
            s.append(told[3, k] * motor_lag)
        if isinstance(drive.compliance, LinearSpring):
            s.append(drive.compliance.stiffness * tau[k] * (lag[k] - motor_lag))
        s += [x * motor_lag for x in columns(drive.motor_friction, told[2, k])]
        x, x_0, share = memory.joints[k], own[k], law.uncertainty[0]
        learnt.append(np.clip(x + law.joint_rate[0] * period * x_0**2 * s, (1 - share) * x_0, (1 + share) * x_0))
    return Memory(np.array(bodies), learnt, memory.filter), *told[:3]


def power_of(s: Array, R: Array) -> Array:
    """What s^T p is a gradient of, in the axes in which p is `turned` by R: s^T p stays what it was."""
    return np.array([s @ turned(unit, R.T) for unit in np.eye(10)])

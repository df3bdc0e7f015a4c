"""Each law once more, from its equations, in plain NumPy on `Plant`: torque and memory of one sample.

A law here takes the law of the package for its gains, a Plant, its own memory (None at the start), a measurement and a
reference; it returns its memory after and the torque, and (VDC) the motor's reference.
"""

from typing import Any

import numpy as np
from numpy_plant import Plant, along, rates
from scipy.linalg import expm

from robot_library import Array

Told = tuple[Any, Array]
TURN = 2 * np.pi


def sides(law: Any, m: Any, r: Any) -> tuple[Array, Array, Array, Array]:
    return (m.theta, m.theta_dot, r.theta, r.theta_dot) if law.side == "motor" else (m.q, m.v, r.q, r.v)


def pd(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    q, v, q_d, v_d = sides(law, m, r)
    return None, law.kp * (q_d - q) + law.kd * (v_d - v)


def pid(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    q, v, q_d, v_d = sides(law, m, r)
    integral = np.zeros(law.size) if memory is None else memory
    asked = law.kp * (q_d - q) + law.kd * (v_d - v) + integral
    held = np.clip(asked, -law.limit, law.limit)
    winding_up = (asked > law.limit) & (q_d > q) | (asked < -law.limit) & (q_d < q)
    return np.where(winding_up, integral, integral + law.ki * (q_d - q) * m.period), held


def computed_torque(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    q, v, q_d, v_d = sides(law, m, r)
    a = r.a + law.kd * (v_d - v) + law.kp * (q_d - q)
    return None, plant.mass(q) @ a + plant.bias(q, v) + plant.both_frictions(r.v, v)


def required(law: Any, plant: Plant, m: Any, r: Any) -> tuple[Array, Array]:
    """s, and M a_r + C v_r + g + friction(v_r, v)."""
    q, v, q_d, v_d = sides(law, m, r)
    v_r, a_r = v_d + law.position_gain * (q_d - q), r.a + law.position_gain * (v_d - v)
    return v_r - v, plant.required(q, v, v_r, a_r) + plant.both_frictions(v_r, v)


def robust(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    s, tau = required(law, plant, m, r)
    return None, tau + law.speed_gain * s + law.bound * s / (abs(s) + law.width)


def super_twisting(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    w = np.zeros(law.size) if memory is None else memory
    s, tau = required(law, plant, m, r)
    torque = tau + law.speed_gain * s + law.root_gain * np.sqrt(abs(s)) * np.sign(s) + w
    return w + m.period * law.twist * np.sign(s), torque


def slotine_li(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    p = plant.robot.inertial_parameters if memory is None else memory
    q, v, q_d, v_d = sides(law, m, r)
    v_r, a_r = v_d + law.position_gain * (q_d - q), r.a + law.position_gain * (v_d - v)
    Y = plant.required_regressor(q, v, v_r, a_r)
    torque = Y @ p + plant.armature * a_r + plant.both_frictions(v_r, v) + law.speed_gain * (v_r - v)
    nominal = plant.robot.inertial_parameters.reshape(-1, 10)
    sizes = np.concatenate([sizes_of(x) for x in nominal])
    return p + m.period * law.rate[0] * sizes**2 * (Y.T @ (v_r - v)), torque


def sizes_of(p: Array) -> Array:
    """Mass; that times radius of gyration; that times its square: 1, 3 and 6 numbers."""
    radius = np.sqrt((p[4] + p[7] + p[9]) / 2 / p[0]) if p[0] else 0.0
    return p[0] * np.repeat([1, radius, radius**2], [1, 3, 6])


def disturbance_observer(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    """With no inner memory: z in rad/s, z' = -(the model's acceleration under the inner law's torque)."""
    _, command = law.law.step(law.law.start(), m, r)
    q, v, _, _ = sides(law, m, r)
    z = -v if memory is None else memory
    u = np.asarray(command.torque, float)
    a = np.linalg.solve(plant.mass(q), u - plant.both_frictions(v, v) - plant.bias(q, v))
    return z - m.period * a, u - law.gain * (z + v)


def elastic_computed_torque(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    """Motor torque J theta'' + tau_f + friction of a motion with the wanted snap, theta = q + delta(tau_f)."""
    a, jerk = plant.link_motion(*m[2:])
    w = law.bandwidth
    snap = r.snap + 4 * w * (r.jerk - jerk) + 6 * w**2 * (r.a - a) + 4 * w**3 * (r.v - m.v) + w**4 * (r.q - m.q)
    q = along(m.q, m.v, a, jerk, snap)
    v, acceleration = along(m.v, a, jerk, snap), along(a, jerk, snap)
    held = plant.link_frictions(m.v, m.v)

    def tau(t: float) -> Array:
        return plant.mass(q(t)) @ acceleration(t) + plant.bias(q(t), v(t)) + held

    theta = np.array([m.q, m.v, a]) + plant.wound(rates(tau, 2))
    reflected = np.array([d.reflected_inertia for d in plant.drives])
    return None, reflected * theta[2] + tau(0.0) + plant.motor_frictions(theta[1], theta[1])


def full_state_feedback(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> Told:
    u = plant.robot.elastic_inverse_dynamics(*r[:5])
    feedback = law.kp * (u.theta - m.theta) + law.kd * (u.theta_dot - m.theta_dot)
    (now, now_dot), (then, then_dot) = plant.springs(*m[2:]), plant.springs(r.q, r.v, u.theta, u.theta_dot)
    excess = now - then + law.lead * (now_dot - then_dot)
    return None, u.motor_torque + feedback / law.shaping + (1 - 1 / law.shaping) * excess


class Filter:
    """z'' = w^2 (u - z) - 2 w z', u held over each period, by the matrix exponential; starts at rest at the first u."""

    def __init__(self, omega: float) -> None:
        self.omega, self.state, self.before = omega, None, None

    def step(self, u: Array, period: float) -> Array:
        """z', z'' at the sample's beginning."""
        w = self.omega
        self.before = x = np.array([u, 0 * u]) if self.state is None else self.state
        ahead = expm(np.array([[0.0, 1.0], [-w * w, -2 * w]]) * period)
        self.state = np.array([u, 0 * u]) + ahead @ (x - [u, 0 * u])
        return np.array([x[1], w * w * (u - x[0]) - 2 * w * x[1]])


def vdc(law: Any, plant: Plant, memory: Any, m: Any, r: Any) -> tuple[Any, Array, Array, Array]:
    """Xia (2019) eqs. (12)-(28) in their corrected reading, friction by value."""
    if plant.bends and law.derivatives == "model":
        a, jerk = plant.link_motion(*m[2:])
        actual = (m.q, m.v, a, jerk)
    else:
        actual = (m.q, m.v)
    v_r = [d_next + law.position_gain * (d - x) for d, d_next, x in zip(r, r[1:5], actual, strict=False)]
    rub = plant.link_frictions(v_r[0], m.v)
    K_B = law.body_gain

    def tau_r(t: float) -> Array:
        q, v, w, w_dot = along(*actual)(t), along(*actual[1:])(t), along(*v_r)(t), along(*v_r[1:])(t)
        pulled = plant.pulls(q, v, K_B, w - v) if K_B is not None else 0
        return plant.required(q, v, w, w_dot) + rub + law.speed_gain * (w - v) + pulled

    if not plant.bends:
        tau = np.array([tau_r(0.0), 0 * m.q, 0 * m.q])
    elif law.derivatives == "model":
        tau = np.array(rates(tau_r, 2))
    else:
        memory = memory or Filter(TURN * law.filter_bandwidth[0])
        value = tau_r(0.0)
        tau = np.array([value, *memory.step(value, m.period)])
    return memory, *joints(plant, law, m, r, v_r, tau)[:3]


def joints(plant: Plant, law: Any, m: Any, r: Any, v_r: list[Array], tau: Array) -> Array:
    """Motor torque, reference, its speed and its acceleration: kappa_r' = v_r + delta_r' + beta (delta_r - delta)."""
    bent, bent_dot = m.theta - m.q, m.theta_dot - m.v
    d, d_dot, d_ddot = plant.wound(tau)
    elastic = np.array([drive.is_elastic for drive in plant.drives])
    speed = v_r[0] + np.where(elastic, d_dot + law.spring_gain * (d - bent), 0.0)
    acceleration = v_r[1] + np.where(elastic, d_ddot + law.spring_gain * (d_dot - bent_dot), 0.0)
    turning = np.where(elastic, m.theta_dot, m.v)
    reflected = np.array([drive.reflected_inertia for drive in plant.drives]) * elastic
    rub = plant.motor_frictions(speed, turning)
    torque = reflected * acceleration + tau[0] + rub + law.motor_gain * (speed - turning)
    return np.array([torque, r.q + d, speed, acceleration])

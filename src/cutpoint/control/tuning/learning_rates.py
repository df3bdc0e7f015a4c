"""Adaptation rates that preserve the loop's damping, from the robot's inertia, its load and the loop's bandwidth.

With s = v_r - v, a model that learns p by p' = Gamma Y^T s adds G = Y Gamma Y^T (N m/rad) to the loop

    (M + J) s' + K s + G (integral of s) = 0,   K >= omega D,   D = diag(M + J).

A mode of shape x has the damping x'Kx / (2 sqrt(x'(M + J)x x'Gx)) >= omega / (2 sqrt(mu g)), mu and g being the largest
eigenvalues of D^-1/2 (M + J) D^-1/2 and D^-1/2 G D^-1/2: so g = omega^2 / (4 zeta^2 mu) leaves zeta to all
modes, at least.
A spring's compliance c, learnt by rate c^2 K tau (lag - motor_lag), decays as y' = -gamma beta y with gamma = rate
tau^2 c and beta the spring's gain; the proof of stability needs gamma < 1.
"""

from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.laws.adaptation import power_matrix
from cutpoint.control.tuning.design import Design
from cutpoint.joint_units import are_prismatic
from cutpoint.mechanics.bodies.pseudo_inertia import nominal_sizes, pseudo_inertia
from cutpoint.mechanics.drives.compliance import LinearSpring
from cutpoint.mechanics.drives.presliding import sliding_of
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot

DAMPING = 0.5
"""That is left to modes of learning: half of g is for bodies, half for joints."""

SLOWER = 0.25
"""Of the bandwidth: how fast a compliance is learnt."""

SWING, STROKE = 1.0, 0.1
"""rad, m: of a motion as fast as the bandwidth."""

PERIODS = 4.0
"""Of the bandwidth, that such a motion takes while the law learns."""


class Motion(NamedTuple):
    """Peak speeds and accelerations of a cycloid of each joint alone (n,), rad/s and rad/s2 (m/s, m/s2)."""

    speed: Array
    acceleration: Array


def body_rate(w: Design, *, natural: bool = False) -> float:
    """1/J.  natural: for `AdaptiveVDC(update="natural")`; else relative to nominal sizes, as in `SlotineLi`."""
    Y, p = _regressors(w.robot, w.q, _motion(w)), w.robot.inertial_parameters
    scale = 1.0 / np.sqrt(w.inertia)
    g = max(float(np.linalg.eigvalsh(scale[:, None] * _gain(each, p, natural) * scale)[-1]) for each in Y)
    return _most(w) / g if g > 0.0 else 1.0


def joint_rate(w: Design, spring_gain: float) -> float:
    """1/J.  spring_gain: beta, rad/s."""
    motion, most = _motion(w), _most(w)
    torque = np.abs(_regressors(w.robot, w.q, motion) @ w.robot.inertial_parameters).max(axis=0)
    found: list[float] = []
    for k, drive in enumerate(w.robot.drives.values()):
        fed = sum(x * x for x in _learnt_torques(drive, motion.speed[k], motion.acceleration[k]))
        found += [most * w.inertia[k] / fed] if fed > 0.0 else []
        if isinstance(drive.compliance, LinearSpring) and torque[k] > 0.0:
            found.append(SLOWER * w.omega / spring_gain * float(drive.compliance.stiffness) / torque[k] ** 2)
    return min(found, default=1.0)


def _most(w: Design) -> float:
    """The largest g that bodies, or joints, may add, 1/s2: half of the total each."""
    at, scale = [d.v for d in w.robot.machine.drives], 1.0 / np.sqrt(w.inertia)
    M = w.robot.mass_matrix(w.q)[np.ix_(at, at)]
    M = M + np.diag(w.inertia - np.diag(M))
    mu = float(np.linalg.eigvalsh(scale[:, None] * M * scale)[-1])
    return w.omega**2 / (4.0 * DAMPING**2 * mu) / 2.0


def _motion(w: Design) -> Motion:
    """The fastest motion that drives and robot allow."""
    frequency = w.omega / (2.0 * np.pi * PERIODS)
    size = np.where(are_prismatic(w.robot), STROKE, SWING)
    fastest = np.array([limits.velocity for limits in w.robot.limits.values()])
    strongest = w.robot.effort_limits / w.inertia
    speed, acceleration = 2.0 * size * frequency, 2.0 * np.pi * size * frequency**2
    return Motion(np.minimum(speed, fastest), np.minimum(acceleration, strongest))


def _regressors(robot: Robot, q: Array, motion: Motion) -> Array:
    """(m, n, 10 bodies): at rest, while each joint accelerates or brakes, and at rest with each turned away."""
    at = [d.v for d in robot.machine.drives]
    a = np.zeros((2 * len(at) + 1, robot.nv))
    a[1:, at] = np.concatenate([np.diag(motion.acceleration), -np.diag(motion.acceleration)])
    turned = _turned(robot, q)
    poses = np.concatenate([np.broadcast_to(q, (len(a), robot.nq)), turned])
    a = np.pad(a, ((0, len(turned)), (0, 0)))
    return robot.regressor(poses, np.zeros_like(a), a)[:, at]


def _turned(robot: Robot, q: Array) -> Array:
    """(m, nq): each joint a quarter turn away to either side, within its limits, for gravity may be least at q."""
    found = list[Array]()
    for driven, (name, own) in zip(robot.machine.drives, robot.limits.items(), strict=True):
        for turn in () if name in robot.mechanism.sliding else (-0.5 * np.pi, 0.5 * np.pi):
            pose = np.array(q, float)
            pose[driven.q] = min(max(pose[driven.q] + turn, own.lower), own.upper)
            found.append(pose)
    return np.reshape(found, (-1, robot.nq))


def _gain(Y: Array, p: Array, natural: bool) -> Array:
    """G at unit rate, (n, n)."""
    bodies = p.reshape(-1, 10)
    if not natural:
        sizes = np.concatenate([np.array(nominal_sizes([*own]), float) for own in bodies])
        return (Y * sizes**2) @ Y.T
    G = np.zeros((len(Y), len(Y)))
    for own, columns in zip(bodies, np.split(Y, len(bodies), axis=1), strict=True):
        L = np.array(pseudo_inertia([*own]), float)
        fed = np.array([np.array(power_matrix([*row]), float) @ L for row in columns])
        G += np.einsum("iab,jba->ij", fed, fed)
    return G


def _learnt_torques(drive: Drive, speed: float, acceleration: float) -> list[float]:
    """Torque due to each friction and rotor parameter, N m."""
    laws = [law for law in (sliding_of(drive.link_friction), sliding_of(drive.motor_friction)) if law is not None]
    found = [
        float(getattr(law, name) * x)
        for law in laws
        for name, x in zip(law.coefficients, law.columns(speed), strict=True)
    ]
    return [*found, float(drive.reflected_inertia * acceleration)]

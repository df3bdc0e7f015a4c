"""Information about a robot's parameters in the torques of a motion: the regressor, two criteria, their gradients.

Swevers et al. (1997), section III; Gautier and Khalil (1992), Int. J. Robotics Research 11(4).
"""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, eigvalsh, get_lapack_funcs

from cutpoint import definitions
from cutpoint.arrays import Array
from cutpoint.identification.excitation.bounds import Bounds
from cutpoint.identification.excitation.kernels import pullback
from cutpoint.identification.rigid.base_parameters import base_parameters
from cutpoint.robot import Robot

Criterion = Literal["determinant", "condition"]

CROSSING = 0.02
"""Smoothing of dry friction's sign change, as a share of the largest speed."""

FRICTION = 0.05
"""Nominal dry friction, and viscous friction at the largest speed, as a share of the torque scale."""

LIGHTEST, THINNEST = 0.01, 0.1
"""Least mass and radius of gyration assumed for a body, as shares of the bodies' means."""

UNLIMITED = 1e3
"""Times the largest torque of random motions: limits beyond that are what files state for joints without one."""

BLIND = 1e6
"""Times a combination of parameters must be told less than the best told one to count as not told: noise is larger."""

TINY = 1e-14
"""Share of the trace of W^T W added to its diagonal, so that an uninformative motion has a finite criterion."""


class Information:
    """The regressor of a motion, rows over the torque's scale, columns times the parameters' nominal sizes.

    Columns: base parameters with rotors, dry and viscous friction of each joint.
    """

    def __init__(self, robot: Robot, bounds: Bounds) -> None:
        self.base, self._torque = base_parameters(robot, rotors=True), _torque_scale(robot, bounds)
        self._crossing = CROSSING * bounds.speed
        inertial = self.base.independent < 10 * len(robot.mechanism.bodies)
        chosen = self.base.independent[inertial]
        self._inertial, self._rotors = np.flatnonzero(inertial), np.flatnonzero(~inertial)
        self._rotor_joints = self.base.independent[~inertial] - 10 * len(robot.mechanism.bodies)
        self._gradient = pullback(robot, lambda m, **x: _columns(m, chosen, **x), (robot.nv, chosen.size), 2)
        sizes = np.abs(self.base.matrix) @ _sizes(robot, bounds)
        self._sizes = np.concatenate([sizes, FRICTION * self._torque, FRICTION * self._torque / bounds.speed])

    @property
    def parameters(self) -> int:
        """Number of identifiable parameters."""
        return self._sizes.size

    def regressor(self, motion: Array) -> Array:
        """W of a motion (5, N, n): (N, n, columns), dimensionless."""
        v = motion[1]
        W = np.zeros((*v.shape, self.parameters))
        b, n = self.base.independent.size, v.shape[1]
        joints = np.arange(n)
        W[..., :b] = self.base.regressor(*motion[:3])
        W[:, joints, b + joints] = np.tanh(v / self._crossing)
        W[:, joints, b + n + joints] = v
        return W * self._sizes / self._torque[:, None]

    def gradient(self, motion: Array, weights: Array) -> Array:
        """(5, N, n): gradient of the sum of weights times W, both (N, n, columns)."""
        weights = weights * self._sizes / self._torque[:, None]
        b, n = self.base.independent.size, motion.shape[-1]
        joints = np.arange(n)
        found = self._gradient(motion, np.ascontiguousarray(weights[..., self._inertial]))
        found[2][:, self._rotor_joints] += weights[:, self._rotor_joints, self._rotors]
        dry = weights[:, joints, b + joints] * (1.0 - np.tanh(motion[1] / self._crossing) ** 2) / self._crossing
        found[1] += dry + weights[:, joints, b + n + joints]
        return found

    def untold(self, W: Array) -> tuple[str, ...]:
        """The parameters about which W (N, n, columns) tells next to nothing, those told least first."""
        size, shares = eigh(_gram(W))
        is_blind, joints = size < size[-1] / BLIND**2, self.base.robot.joints
        friction = [f"{kind} friction of {joint}" for kind in ("dry", "viscous") for joint in joints]
        names = [*self.base.names, *friction]
        return tuple(dict.fromkeys(names[k] for k in np.abs(shares[:, is_blind]).argmax(axis=0)))


def judged(W: Array, criterion: Criterion) -> tuple[float, Array]:
    """The cost of W (N, n, columns), to be minimised, and its gradient.

    Of A = W^T W / N: - log det A per column, or the logarithm of W's condition number.
    """
    A = _gram(W)
    A += TINY * A.trace() * np.eye(len(A))
    if criterion == "determinant":
        half = cholesky(A, lower=True)
        invert: Any = get_lapack_funcs("trtri", (half,))
        inverse = invert(half, lower=1)[0]
        cost, slope = -2.0 * float(np.log(np.diag(half)).mean()), -(inverse.T @ inverse) / len(A)
    else:
        size, vectors = eigh(A)
        low, high = vectors[:, 0] / np.sqrt(size[0]), vectors[:, -1] / np.sqrt(size[-1])
        cost = 0.5 * float(np.log(size[-1] / size[0]))
        slope = 0.5 * (np.outer(high, high) - np.outer(low, low))
    return cost, W @ slope * (2.0 / len(W))


def log_determinant(W: Array) -> float:
    """log det(W^T W / N)."""
    return float(np.linalg.slogdet(_gram(W))[1])


def condition_number(W: Array) -> float:
    """The largest singular value over the smallest, good to four digits up to 1e6, and 1e7 at most."""
    size = eigvalsh(_gram(W))
    return float(np.sqrt(size[-1] / max(size[0], TINY * size[-1])))


def _gram(W: Array) -> Array:
    """W^T W / N, sample by sample: products this small stay in one thread; on a busy machine others are slow."""
    return (W.transpose(0, 2, 1) @ W).mean(axis=0)


def _columns(m: definitions.Machine, chosen: NDArray[np.intp], **motion: Any) -> list[list[Any]]:
    return [[row[k] for k in chosen] for row in definitions.regressor(m, **motion)]


def _torque_scale(robot: Robot, bounds: Bounds) -> Array:
    """(n,), N m (N): torque limits, or the RMS of random motions."""
    rng, count = np.random.default_rng(0), 200
    q = rng.uniform(bounds.low, bounds.high, (count, robot.nv))
    v, a = rng.uniform(-1.0, 1.0, (2, count, robot.nv)) * bounds.speed
    typical = np.sqrt(np.mean(robot.inverse_dynamics(q, v, a) ** 2, axis=0))
    typical = np.maximum(typical, 1e-3 * typical.max(initial=0.0) or 1.0)
    is_limited = bounds.torque < UNLIMITED * typical.max(initial=0.0)
    return np.where(is_limited, bounds.torque, typical)


def _sizes(robot: Robot, bounds: Bounds) -> Array:
    """Nominal sizes of all parameters: m, m r and m r^2 of each body, r its radius of gyration; rotors' inertias.

    A rotor that is not stated is taken to resist its joint as much as what that carries.
    """
    p = robot.inertial_parameters.reshape(-1, 10)
    mass, turning = p[:, 0], p[:, [4, 7, 9]].sum(axis=1) / 2.0
    m = np.maximum(mass, LIGHTEST * mass.mean() or 1.0)
    mean = np.sqrt(turning.sum() / m.sum()) or 1.0
    r = np.maximum(np.sqrt(turning / m), THINNEST * mean)
    q = np.random.default_rng(0).uniform(bounds.low, bounds.high, (20, robot.nv))
    carried = robot.mass_matrix(q).diagonal(axis1=1, axis2=2).mean(axis=0)
    rotors = [float(d.reflected_inertia) or x for d, x in zip(robot.drives.values(), carried, strict=True)]
    return np.concatenate([(m[:, None] * r[:, None] ** [0, 1, 1, 1, 2, 2, 2, 2, 2, 2]).ravel(), rotors])

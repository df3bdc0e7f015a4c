"""Fixed-step integration between two control samples, and how fine its steps must be."""

import warnings

import numpy as np
from numpy.typing import NDArray

from cutpoint.robot import Robot
from cutpoint.scalars import Scalar

Array = NDArray[np.float64]

TABLEAU = np.array([[1 / 2, 1 / 6], [1 / 2, 1 / 3], [1.0, 1 / 3], [0.0, 1 / 6]])
"""Classical Runge-Kutta of order 4, a row a stage: how far to go for the next stage, and this stage's weight."""

SETTINGS = {"standard": (0.25, 2.0, 2.5e-4), "fine": (0.1, 0.25, 6.25e-5)}
"""Largest step: times the fastest drive mode (rad/s), times the fastest friction decay (1/s), and in s."""

MOST_SUBSTEPS = 400


class StiffnessWarning(UserWarning):
    """The fixed-step integrator cannot follow the plant's fastest part."""


def stage(
    k: list[Scalar], origin: list[Scalar], total: list[Scalar], row: list[Scalar], h: Scalar
) -> tuple[list[Scalar], list[Scalar]]:
    """The next stage's state, and the step's result so far, from the rates k.  Hairer et al. (1993) section II.1."""
    ahead, weight = row[0] * h, row[1] * h
    y = [x + ahead * r for x, r in zip(origin, k, strict=True)]
    return y, [x + weight * r for x, r in zip(total, k, strict=True)]


def substeps_for(robot: Robot, accuracy: str, period: float, poses: Array) -> int:
    """Steps a control period so that every drive mode and friction law is followed at these poses (m, nq)."""
    mode_steps, decay_steps, longest = SETTINGS[accuracy]
    mode, decay = fastest(robot, poses)
    step = min(longest, mode_steps / max(mode, 1e-9), decay_steps / max(decay, 1e-9))
    wanted = int(np.ceil(period / step - 1e-9))
    if wanted > MOST_SUBSTEPS:
        warnings.warn(
            f"{wanted} steps a control period would follow the fastest drive mode ({mode / 2 / np.pi:.0f} Hz) and "
            f"friction decay ({decay:.0f} 1/s); {MOST_SUBSTEPS} are taken. Raise the friction's smoothing, "
            "or give substeps=",
            StiffnessWarning,
            stacklevel=3,
        )
    return max(1, min(wanted, MOST_SUBSTEPS))


def fastest(robot: Robot, poses: Array) -> tuple[float, float]:
    """Highest angular frequency of the drive modes (rad/s) and fastest decay by friction and damping (1/s)."""
    drives = [*robot.drives.values()]
    elastic = np.array([d.is_elastic for d in drives], bool)
    driven = np.array([d.v for d in robot.machine.drives], int)
    mode = decay = 0.0
    for q in poses:
        M_inverse = np.linalg.inv(robot.mass_matrix(q))[np.ix_(driven, driven)]
        lead = robot.static_deflection(q)
        K = np.array([d.compliance.tangent(x) if d.compliance else 0.0 for d, x in zip(drives, lead, strict=True)])
        J_inverse = np.array([1 / d.reflected_inertia if d.is_elastic else 0.0 for d in drives])
        # links and rotors on springs: relative motion delta'' = -(M^-1 + J^-1) K delta
        if elastic.any():
            squares = np.linalg.eigvals((M_inverse + np.diag(J_inverse)) * K)
            mode = max(mode, float(np.sqrt(np.abs(squares).max())))
        on_link = [d.damping or 0.0 if d.is_elastic else _slope(d.motor_friction) for d in drives]
        slopes = np.array([_slope(d.link_friction) for d in drives]) + on_link
        rotor = np.array([_slope(d.motor_friction) + (d.damping or 0.0) for d in drives]) * J_inverse
        links = np.linalg.eigvals(M_inverse * slopes) if len(drives) else np.zeros(1)
        decay = max(decay, float(np.abs(links).max()), float(rotor.max(initial=0.0)))
    return mode, decay


def _slope(law: object) -> float:
    """d torque / d speed of a friction law at rest, where it is steepest."""
    if law is None:
        return 0.0
    small = 1e-6
    return float((law.torque(small) - law.torque(-small)) / (2 * small))  # type: ignore[attr-defined]

"""Whether a PD loop around bending joints is stable, to first order: poles of the arm at q = 0, drives undamped."""

from typing import Literal

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.compliance import Flexspline
from cutpoint.studies.paper.bench import KD, KP, Bench


def fastest_growth(bench: Bench, side: Literal["motor", "link"], scale: float) -> float:
    """Largest real part of the poles, 1/s, with the bench's gains times scale on this side; positive grows.

    The links' mass matrix, the rotors' reflected inertias and the drives' stiffness at rest, without gravity, friction
    and sampling: M v' = K (theta - q), I theta'' = -K (theta - q) - K_p x - K_v x', x = theta or q by side.
    """
    drives = [*bench.robot.drives.values()]
    n, none = len(drives), np.zeros((len(drives), len(drives)))
    K = np.diag([d.compliance.stiffness for d in drives if isinstance(d.compliance, Flexspline)])
    inertias = np.diag([d.reflected_inertia for d in drives])
    P, D = np.diag(scale * KP), np.diag(scale * KD)
    on_q, on_theta, on_v, on_omega = (P, none, D, none) if side == "link" else (none, P, none, D)
    from_links = np.hstack([-K, K, none, none])
    from_motors = np.hstack([K - on_q, -K - on_theta, -on_v, -on_omega])
    M = bench.robot.mass_matrix(np.zeros(n))
    accelerations = np.vstack([np.linalg.solve(M, from_links), np.linalg.solve(inertias, from_motors)])
    rates = np.hstack([np.zeros((2 * n, 2 * n)), np.eye(2 * n)])
    return float(np.linalg.eigvals(np.vstack([rates, accelerations])).real.max())


def growth_rates(bench: Bench, side: Literal["motor", "link"], scales: Array) -> Array:
    return np.array([fastest_growth(bench, side, scale) for scale in scales])

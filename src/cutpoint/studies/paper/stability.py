"""Whether a PD loop around bending joints is stable, to first order: poles of the arm at q = 0, drives undamped."""

from typing import Literal

import numpy as np

from cutpoint.studies.paper.bench import KD, KP, Bench


def fastest_growth(bench: Bench, side: Literal["motor", "link"], scale: float) -> float:
    """Largest real part of the poles, 1/s, with the bench's gains times scale on this side; positive grows.

    x' = A x + B u without gravity, friction and sampling, and u = -K_p y - K_d y', y = theta or q by side.
    """
    model = bench.weightless
    q, v, theta, theta_dot = np.split(model.C, 4)
    y, rate = (q, v) if side == "link" else (theta, theta_dot)
    feedback = scale * (np.diag(KP) @ y + np.diag(KD) @ rate)
    return float(np.linalg.eigvals(model.A - model.B @ feedback).real.max())

"""Number of integration steps per control period, and what requires it."""

from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.robot import Robot
from cutpoint.simulation.steps.fastest import (
    fastest_decay,
    fastest_growth,
    fastest_mode,
    fastest_reversal,
    fastest_stop,
    fastest_wave,
    posture,
)


class Longest(NamedTuple):
    """Bounds on the step of an accuracy: on the step times each kind of rate, and on the step itself, s.

    mode: of the fastest drive mode, rad.  decay: of the fastest decay that is not integrated implicitly.  reversal: of
    that by reversing bristles; 6 never limits.  growth: of the fastest growth where friction falls with speed.
    wave: of the fastest wave of ripple, cogging or kinematic error, rad; a step of 2 pi would not see it at all.
    stop: of the fastest stop by friction where it winds a spring by `slip`, rad, see `fastest.fastest_stop`.
    turn: of the fastest free turning, rad.
    """

    mode: float
    decay: float
    reversal: float
    growth: float
    wave: float
    stop: float
    slip: float
    turn: float
    seconds: float


SETTINGS = {
    "standard": Longest(
        mode=1.0, decay=2.0, reversal=2.0, growth=2.0, wave=2.0, stop=1.0, slip=5e-4, turn=0.15, seconds=2.5e-4
    ),
    "fine": Longest(
        mode=0.2, decay=0.25, reversal=1.0, growth=0.5, wave=1.0, stop=0.5, slip=5e-6, turn=0.05, seconds=6.25e-5
    ),
}
"""By accuracy."""

LONGEST_STEP = "the longest step of this accuracy"

MOST_SUBSTEPS = 400


class StiffnessWarning(UserWarning):
    """The fixed-step integrator cannot resolve the plant's fastest dynamics."""


class Steps(NamedTuple):
    """Integration steps per control period, and what requires them."""

    number: int
    cause: str


def substeps_for(robot: Robot, accuracy: str, period: float, poses: Array, speeds: Array | None = None) -> Steps:
    """Steps per control period that resolve drive modes, current loops, slipping and waves.

    poses: (m, nq), where stiffness is judged.  speeds: (n,) rad/s, largest speeds of the drives; zero by default.
    """
    postures = [posture(robot, q) for q in poses]
    longest, mode = SETTINGS[accuracy], fastest_mode(robot, postures)
    bounds = [
        (longest.mode, mode),
        (longest.decay, fastest_decay(robot)),
        (longest.reversal, fastest_reversal(robot, postures)),
        (longest.growth, fastest_growth(robot, postures)),
        (longest.stop, fastest_stop(robot, postures, longest.slip)),
        (longest.wave, fastest_wave(robot, np.zeros(len(robot.drives)) if speeds is None else speeds)),
    ]
    steps = [(share / max(limit.rate, 1e-9), limit.cause) for share, limit in bounds]
    step, cause = min([(longest.seconds, LONGEST_STEP), *steps])
    wanted = int(np.ceil(period / step - 1e-9))
    if wanted > MOST_SUBSTEPS:
        parts = "distance, stiffness, bandwidth, Stribeck velocity, smoothing, order of a wave"
        remedy = "Shorten the control_period" if cause == LONGEST_STEP else f"Soften it ({parts})"
        told = f"{cause} would take {wanted:.6g} integration steps per control period"
        fastest = f"(the drives' fastest mode is {mode.rate / 2 / np.pi:.4g} Hz)"
        words = f"{told} {fastest}; {MOST_SUBSTEPS} are taken. {remedy}, or give substeps="
        warn(words, StiffnessWarning)
    return Steps(max(1, min(wanted, MOST_SUBSTEPS)), cause)

"""Full-state feedback at rest is passive at the links' port, as nearly as its samples are close together."""

from itertools import pairwise

import numpy as np
import pytest
from law_library import at_rest, elbow

from cutpoint import Log, simulate
from cutpoint.control import FullStateFeedback, tune
from cutpoint.simulation import State
from robot_library import Array

POSE = np.array([0.5, -0.8])
HOLD = 1e-3
"""s for which a push lasts, the same at every control period."""


def pushes(seed: int, seconds: float) -> Array:
    """(N, 2) N m: noise at every frequency that such pushes can have, and slow waves."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds / HOLD) + 1)[:, None] * HOLD
    waves = sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 6, 2)) for f in (1.0, 5.0, 29.0, 73.0))
    return 2.0 * rng.normal(size=(len(t), 2)) + waves


def stored(law: FullStateFeedback, log: Log) -> Array:
    """J: in links, their weight, springs, and rotors of `shaping` times their inertia on springs of kp."""
    robot = elbow()
    rest, theta_d = at_rest(POSE)
    J, K = np.array([(d.reflected_inertia, d.compliance.stiffness) for d in robot.drives.values()]).T
    q, v, theta, w = (log[name] for name in ("q", "v", "theta", "theta_dot"))
    turned, tau_d = theta - theta_d, K * (theta_d - rest)
    motors = law.shaping * J * w**2 / 2 + law.kp * turned**2 / 2 - tau_d * turned
    springs = K * ((theta - q) ** 2 - (theta_d - rest) ** 2) / 2
    weight = robot.potential_energy(q) - robot.potential_energy(rest)
    return robot.kinetic_energy(q, v) + weight + (motors + springs).sum(axis=1)


def made_of_nothing(law: FullStateFeedback, period: float, seed: int, seconds: float = 1.0) -> tuple[float, float]:
    """The most energy (J) by which storage grows beyond what the pushes bring in, over any stretch of time; and most
    that was ever stored."""
    torque = pushes(seed, seconds)
    rest, theta_d = at_rest(POSE)

    def push(times: Array) -> Array:
        return torque[np.floor(times / HOLD + 1e-6).astype(int)]

    start = State(rest, np.zeros(2), theta_d, np.zeros(2))
    log = simulate(
        elbow(), law, duration=seconds, control_period=period, initial=start, disturbances=push, accuracy="fine"
    )
    brought = (push(log.time)[:-1] * np.diff(log["q"], axis=0)).sum(axis=1)  # the push is constant over each period
    S = stored(law, log)
    lost = np.concatenate([[0.0], np.cumsum(brought)]) - (S - S[0])
    # what is lost must never be had back
    return float((np.maximum.accumulate(lost) - lost).max()), float(S.max())


@pytest.mark.parametrize("lead", [0.0, 0.5])
@pytest.mark.parametrize("seed", range(2))
def test_what_full_state_feedback_makes_of_nothing_shrinks_with_the_control_period(seed, lead):
    """No bound is promised, only that nothing is left in continuous time; the integrator leaves 1e-7 of the energy."""
    periods, found = (1e-3, 5e-4, 2.5e-4), []
    for period in periods:
        law = tune(elbow(), 3.0, FullStateFeedback, q=POSE, control_period=period, lead=lead * period)
        found.append(made_of_nothing(law, period, seed))
    told = ", ".join(f"{x:.2g} of {most:.2g} J at {1e3 * p:g} ms" for (x, most), p in zip(found, periods, strict=True))
    for (before, most), (after, _) in pairwise(found):
        assert after <= max(before / 2, 1e-7 * most), told

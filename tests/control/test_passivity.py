"""Full-state feedback at rest is passive at the links' port, as nearly as its samples are close together."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from law_library import at_rest, elbow

from cutpoint import Log, simulate, simulate_many
from cutpoint.control import FullStateFeedback, Measurement, Reference, tune
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


def test_in_continuous_time_storage_grows_by_what_comes_in_less_what_damping_takes():
    """At 1000 random states and pushes: S' = v tau - kd theta_dot^2, S' by central differences along the motion."""
    robot, rng, count = elbow(), np.random.default_rng(0), 1000
    law = tune(robot, 3.0, FullStateFeedback, q=POSE, lead=0.0)
    rest, _ = at_rest(POSE)
    K = np.array([d.compliance.stiffness for d in robot.drives.values()])
    q = rest + rng.normal(size=(count, 2))
    theta, v, w = q + 5.0 / K * rng.normal(size=(count, 2)), *rng.normal(size=(2, count, 2))
    pushed, nothing = 5.0 * rng.normal(size=(count, 2)), np.zeros(2)
    u = np.array([
        law.step(law.start(), Measurement(0.0, 1e-3, *x), Reference(rest, *[nothing] * 4, rest, nothing))[1].torque
        for x in zip(q, v, theta, w, strict=True)
    ])  # fmt: skip
    _, alpha = robot.elastic_forward_dynamics(q, v, theta, w, u)
    # links also feel the push, which the public function does not take
    a = robot.forward_dynamics(q, v, K * (theta - q) + pushed)
    step = 5e-7

    def moved(h: float) -> Array:
        at = (q + h * v + h * h / 2 * a, v + h * a, theta + h * w + h * h / 2 * alpha, w + h * alpha)
        return stored(law, dict(zip(("q", "v", "theta", "theta_dot"), at, strict=True)))  # type: ignore[arg-type]

    rate = (moved(step) - moved(-step)) / (2 * step)
    expected = (v * pushed).sum(axis=1) - (law.kd * w**2).sum(axis=1)
    scale = np.abs(v * pushed).sum(axis=1) + np.abs(w * u).sum(axis=1) + np.abs(K * (theta - q) * (w - v)).sum(axis=1)
    assert (np.abs(rate - expected) / scale).max() < 1e-6


def test_over_a_thousand_sampled_runs_little_is_made_of_nothing():
    """At 1 ms and without lead, of what is stored: less than what a period of the spring's fastest swing brings in."""
    robot, seconds, period = elbow(), 0.1, 1e-3
    law = tune(robot, 3.0, FullStateFeedback, q=POSE, control_period=period, lead=0.0)
    rest, theta_d = at_rest(POSE)
    torques = [pushes(seed, seconds) for seed in range(1000)]

    def push(torque: Array) -> Any:
        return lambda times: torque[np.floor(times / HOLD + 1e-6).astype(int)]

    start = State(rest, np.zeros(2), theta_d, np.zeros(2))
    runs = simulate_many(robot, law, None, seconds, period, start, disturbances=[*map(push, torques)])
    worst = 0.0
    for torque, log in zip(torques, runs, strict=True):
        brought = (torque[: len(log.time) - 1] * np.diff(log["q"], axis=0)).sum(axis=1)
        S = stored(law, log)
        lost = np.concatenate([[0.0], np.cumsum(brought)]) - (S - S[0])
        worst = max(worst, float((np.maximum.accumulate(lost) - lost).max() / S.max()))
    fastest = 2 * np.pi * robot.modes(POSE).frequencies.max() / np.sqrt(law.shaping.min())
    assert 0 < worst < (fastest * period) ** 2, f"{worst:.2g} of what is stored is made of nothing"

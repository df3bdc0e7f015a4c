"""The paper's arm under control, with its friction: simulated seconds a second, alone and many at once, and how true.

python benchmarks/simulations.py

What is true is the RMS of the position error over the move, against that of many more steps: under stick-slip two runs
drift apart whatever the integrator, their scores do not.  Many at once differ in static friction and encoder noise,
and the error's RMS is what is kept of each.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from time import perf_counter

import numpy as np

import cutpoint
from cutpoint.control import PD, Feedforward
from cutpoint.simulation import simulate_many
from cutpoint.trajectories import cycloid

DURATION, RUNS = 10.0, 64
"""s of the reference move; runs side by side."""

SUBSTEPS, EXACT = (1, 2, 3, 4, 8), 200
"""Integration steps a millisecond, and how many count as exact."""

PASSES = 3
"""Over all calls, in turns; the least of each counts."""

KP, KD = [2000.0, 2000, 1000, 500, 300, 200], [60.0, 60, 35, 20, 12, 10]
KEPT = ("position_error",)
"""What is logged."""

GOAL = np.deg2rad([90.0, 60.0, 60.0, 90.0, 60.0, 90.0])


def plants(arm: cutpoint.Robot) -> list[cutpoint.Robot]:
    """The arm with other static frictions, 10 % up or down."""

    def rubbing(share: float) -> cutpoint.Robot:
        laws = {name: replace(d.link_friction, static=d.link_friction.static * share) for name, d in arm.drives.items()}
        return arm.with_drives({name: replace(d, link_friction=laws[name]) for name, d in arm.drives.items()})

    return [rubbing(share) for share in np.linspace(0.9, 1.1, RUNS)]


def score(log: cutpoint.Log) -> np.ndarray:
    return log.rms("position_error")


def seconds(call: Callable[[], object]) -> float:
    """Of the second of two calls: the first fills the caches that others have emptied."""
    call()
    start = perf_counter()
    call()
    return perf_counter() - start


def loops(threads: int = 1) -> list[dict]:
    """A row for each number of steps."""
    arm, move = cutpoint.robots.xia2019(), cycloid(GOAL, DURATION)
    law = PD(KP, KD, side="motor") + Feedforward(arm)
    alone = partial(cutpoint.simulate, arm, law, move, channels=KEPT)
    noise = [cutpoint.Sensors(motor_noise=1e-6, seed=k) for k in range(RUNS)]
    many = partial(simulate_many, plants(arm), law, move, sensors=noise, channels=KEPT, each=score, threads=threads)
    calls: dict[tuple[str, int], Callable[[], object]] = {("alone", n): partial(alone, substeps=n) for n in SUBSTEPS}
    calls |= {("many", n): partial(many, substeps=n) for n in SUBSTEPS}
    passes = [{key: seconds(call) for key, call in calls.items()} for _ in range(PASSES)]
    least, truth = {key: min(times[key] for times in passes) for key in calls}, np.array([*many(substeps=EXACT)])
    return [
        {
            "substeps": n,
            "alone": DURATION / least["alone", n],
            "many": RUNS * DURATION / least["many", n],
            "score_error": float(np.abs(np.array([*many(substeps=n)]) - truth).max()),
        }
        for n in SUBSTEPS
    ]


if __name__ == "__main__":
    for row in loops():
        speeds = f"{row['alone']:.0f} s/s alone, {row['many']:.0f} s/s of {RUNS}"
        print(f"{row['substeps']} steps a ms: {speeds}; scores off by {row['score_error']:.1e} rad")

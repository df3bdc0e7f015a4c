"""Inverse dynamics of a million configurations, more than any cache holds."""

import sys
import time

import numpy as np
import ours
from cases import ROBOTS, case
from tasks import numbers

CONFIGURATIONS, ROUNDS = 1_000_000, 7


def from_memory() -> list[dict]:
    """Seconds of the quickest of some rounds, in turns, and bytes read and written: rows, and blocks."""
    found = []
    for name in ROBOTS:
        print(f"{name}: from memory", file=sys.stderr)
        given, rng = case(name), np.random.default_rng(0)
        inputs = [rng.uniform(-2, 2, (CONFIGURATIONS, given.robot.nv)) for _ in range(3)]
        kernel = ours.kernel_of(given, "inverse dynamics", inputs)
        calls = {"rows": ours.rows(kernel, inputs).call, "lanes": ours.lanes(kernel, inputs).call}
        seconds: dict[str, list[float]] = {kind: [] for kind in calls}
        for _ in range(ROUNDS):
            for kind, call in calls.items():
                start = time.perf_counter()
                call()
                seconds[kind].append(time.perf_counter() - start)
        total = CONFIGURATIONS * numbers(kernel)["bytes"]
        found.append({"robot": name, "bytes": total, "seconds": {kind: min(x) for kind, x in seconds.items()}})
    return found

"""Calls timed in turns, so that other work on the machine affects all equally."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from timeit import timeit

import numpy as np

_ROUNDS = 21
_BLOCK = 2e-3
"""Each round repeats a call for about this long, s."""


@dataclass(frozen=True)
class Timing:
    """Nanoseconds: median and least over the rounds."""

    median: float
    least: float


def in_turns(calls: Mapping[str, Callable[[], object]], items: int = 1) -> dict[str, Timing]:
    """Time for one of the items that each call works through.

    Each turn begins with an untimed call: other turns have emptied the caches.
    """
    repeats = {key: max(1, round(_BLOCK / max(timeit(call, number=3) / 3, 1e-7))) for key, call in calls.items()}
    found: dict[str, list[float]] = {key: [] for key in calls}
    for _ in range(_ROUNDS):
        for key, call in calls.items():
            call()
            found[key].append(1e9 * timeit(call, number=repeats[key]) / (repeats[key] * items))
    return {key: Timing(float(np.median(times)), min(times)) for key, times in found.items()}

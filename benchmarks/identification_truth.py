"""Whether `identify` keeps its promises on arms with known parameters.

OPENBLAS_NUM_THREADS=1 PYTHONPATH=tests:tests/identification python benchmarks/identification_truth.py --arms 100

Random arms of two and three joints and what becomes of their logs: see `judged_arms`.
"""

import argparse
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np
from judged_arms import NOISE, Case, case
from rich.progress import track


def told(cases: list[Case]) -> str:
    """A report, a line for each kind of number."""
    hits: dict[str, list[bool]] = {}
    for each in cases:
        for kind, own in each.hits.items():
            hits.setdefault(kind, []).extend(own)
    ratio = np.concatenate([each.ratio for each in cases])
    linear = [hit for each in cases for hit in each.linear]
    worst = max(range(len(cases)), key=lambda k: cases[k].ratio.max())
    return "\n".join(
        [
            *(_covered(hits)),
            f"springs found to be linear, as they are: {sum(linear)} of {len(linear)}",
            f"physical: {sum(each.physical for each in cases)} of {len(cases)}",
            f"held-out error over the true model's: median {np.median(ratio):.2f}, 95 % {np.quantile(ratio, 0.95):.2f},"
            f" worst {ratio.max():.2f} (arm {worst}), above 2: {(ratio > 2.0).sum()} of {ratio.size} joints",
        ]
    )


def _covered(hits: Mapping[str, list[bool]]) -> list[str]:
    return [f"{kind:16} {100.0 * np.mean(own):5.1f} % of {len(own)} intervals of 95 %" for kind, own in hits.items()]


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="number of the first arm")
    parser.add_argument("--noise", type=float, default=NOISE, help="of the torques, N m RMS")
    asked = parser.parse_args()
    with ProcessPoolExecutor(2) as pool:
        seeds = range(asked.first, asked.first + asked.arms)
        cases = pool.map(partial(case, noise=asked.noise), seeds)
        print(told([*track(cases, "arms", total=asked.arms)]))

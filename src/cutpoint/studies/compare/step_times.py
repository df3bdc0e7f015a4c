"""What a step of each law takes, called from Python one at a time."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from cutpoint.simulation.control_kernel import MEASURED, REFERENCE, law_kernel, law_memory, law_parameters
from cutpoint.studies.compare.bench import USUAL, Bench
from cutpoint.studies.compare.matching import Match
from cutpoint.studies.cost.timing import in_turns


def step_times(bench: Bench, matches: Mapping[str, Match]) -> dict[str, float]:
    """Median nanoseconds by contender, laws in turns on one core."""
    calls = {key: _call(bench, match) for key, match in matches.items() if match.law is not None}
    return {key: timing.median for key, timing in in_turns(calls).items()}


def _call(bench: Bench, match: Match) -> Callable[[], object]:
    """A step on the way."""
    sample = bench.move(USUAL)(0.3 * USUAL)
    measured = dict(zip(MEASURED, (sample.q, sample.q + 1e-3, sample.v, sample.v), strict=True))
    wanted = dict(zip(REFERENCE, sample, strict=True))
    given = [np.ascontiguousarray(x) for x in (*measured.values(), *wanted.values())]
    parameters = law_parameters(bench.robot, match.law, bench.control_period)
    kernel = law_kernel(bench.robot, match.law)
    return partial(kernel.call, *given, 0.3 * USUAL, law_memory(match.law), parameters)

"""Time of a step of each law, called from Python one at a time."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Wrapper
from cutpoint.simulation.control_kernel import law_kernel, law_memory
from cutpoint.simulation.loop.parameters import law_parameters
from cutpoint.studies.compare.bench import USUAL, Bench
from cutpoint.studies.compare.matching import Match
from cutpoint.studies.cost.timing import in_turns


def step_times(bench: Bench, matches: Mapping[str, Match]) -> dict[str, float]:
    """Nanoseconds by contender, laws in turns on one core: the fastest round, which other work disturbs least."""
    calls = {key: _call(bench, match) for key, match in matches.items() if match.law is not None}
    return {key: timing.least for key, timing in in_turns(calls).items()}


def _call(bench: Bench, match: Match) -> Callable[[], object]:
    """A step on the way."""
    sample = bench.move(USUAL)(0.3 * USUAL)
    measured = sample.q, sample.v, sample.q + 1e-3, sample.v
    given = [np.ascontiguousarray(x) for x in (*measured, *sample)]
    law = _Remembering(match.law)
    parameters = law_parameters(law, bench.control_period)
    return partial(law_kernel(bench.robot, law).call, *given, 0.3 * USUAL, law_memory(law), parameters)


@dataclass(frozen=True, eq=False)
class _Remembering(Wrapper):
    """A law with one more number in its state: only calls without empty arrays are fast."""

    law: Any

    def start(self) -> Any:
        return 0.0, self.inner_start()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        after, command = self.inner_step(memory[1], measurement, reference)
        return (memory[0], after), command

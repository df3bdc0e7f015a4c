"""Every law in every scenario: the score of each run, and the worst of a scenario."""

import warnings
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from cutpoint.control.laws.model_law import with_models
from cutpoint.errors import SimulationError
from cutpoint.simulation import StiffnessWarning, simulate
from cutpoint.studies.compare.bench import Bench
from cutpoint.studies.compare.scenarios import Case


class Score(NamedTuple):
    """Of one run: RMS over times and joints and peak of the links' errors, 1e-3 deg; RMS of what motor torques are off
    the ideal, N m.  All infinite where the run diverged."""

    rms: float
    peak: float
    torque: float


DIVERGED = Score(np.inf, np.inf, np.inf)


class Outcome(NamedTuple):
    """All runs of a law in a scenario."""

    scores: tuple[Score, ...]

    @property
    def worst(self) -> Score:
        """The largest of each; infinite if one diverged."""
        return Score(*map(max, zip(*self.scores, strict=True)))

    @property
    def diverged(self) -> int:
        """The number of runs that diverged."""
        return self.scores.count(DIVERGED)


def outcome(bench: Bench, law: Any, cases: Iterable[Case], heard: Callable[[], Any]) -> Outcome:
    """`heard` is called after each run."""
    scores: list[Score] = []
    for case in cases:
        scores.append(score(bench, law, case))
        heard()
    return Outcome(tuple(scores))


def score(bench: Bench, law: Any, case: Case) -> Score:
    """Raises KeyboardInterrupt if the run was interrupted."""
    told = with_models(law, lambda _: case.model)
    try:
        with warnings.catch_warnings():  # a law that deflects springs this far has failed anyway
            warnings.simplefilter("ignore", StiffnessWarning)
            log = simulate(case.plant, told, case.move, control_period=bench.control_period, sensors=case.sensors)
    except SimulationError as stopped:
        if not stopped.evidence["diverged"]:
            raise KeyboardInterrupt from stopped
        return DIVERGED
    error = 1e3 * np.rad2deg(log["position_error"])
    return Score(_rms(error), float(np.abs(error).max()), _rms(log["motor_torque"] - case.ideal))


def _rms(x: Any) -> float:
    return float(np.sqrt(np.mean(np.square(x))))

"""Results of the study so far."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from cutpoint.studies.compare.matching import Match
from cutpoint.studies.compare.runs import Outcome


@dataclass
class Results:
    """Matches by contender, outcomes by scenario and contender, as far as the study has come; ns of a step."""

    matches: dict[str, Match] = field(default_factory=dict[str, Match])
    outcomes: dict[str, dict[str, Outcome]] = field(default_factory=dict[str, dict[str, Outcome]])
    nanoseconds: dict[str, float] = field(default_factory=dict[str, float])
    complete: bool = False

    def worst(self, scenario: str, law: str) -> float:
        """RMS error, 1e-3 deg; NaN where it has not run."""
        outcome = self.outcomes.get(scenario, {}).get(law)
        return outcome.worst.rms if outcome else np.nan

    def best(self, scenario: str, among: Iterable[str] | None = None) -> str | None:
        """The law at equal stiffness with the least worst RMS error, of these or of all; None if all diverged."""
        found = {key: self.worst(scenario, key) for key in (self.matches if among is None else among)}
        kept = {key: x for key, x in found.items() if np.isfinite(x) and self.matches[key].equal}
        return min(kept, key=lambda key: kept[key]) if kept else None

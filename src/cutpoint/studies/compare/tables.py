"""The comparison as tables, and as numbers for the results file."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cutpoint.reporting.page import Table, number
from cutpoint.studies.compare.contenders import CONTENDERS
from cutpoint.studies.compare.matching import Match
from cutpoint.studies.compare.results import Results
from cutpoint.studies.compare.runs import Outcome
from cutpoint.studies.compare.scenarios import SCENARIOS, Scenario

BEST = "•"
"""Marks the best of a column."""

UNEQUAL = "*"
"""Marks a law that does not hold at equal stiffness and runs at another bandwidth."""

MODEL_SIDE = ("nominal", "masses_5", "masses_20", "stiffness", "friction", "slow", "fast")
"""Scenarios in the first of two tables."""


def law_name(results: Results, key: str) -> str:
    match = results.matches[key]
    return match.contender.name + ("" if match.equal else f" {UNEQUAL}")


def tuning_table(results: Results) -> Table:
    pd = results.matches[CONTENDERS[0].key]
    rows = [
        (law_name(results, key), *_tuning_row(match, pd, results.nanoseconds.get(key)))
        for key, match in results.matches.items()
    ]
    caption = (
        "Laws at the stiffness of the PD, critically damped: sides with encoders, and the model in it; bandwidth that "
        "`tune` is asked for; stiffness and damping beside the PD's, geometric mean over the joints, and from the "
        "least joint to the most; a step's time, one call from Python on one core" + _marks(results) + "."
    )
    columns = ("", "needs", "Hz", "stiffness", "joints", "damping", "joints", "ns")
    return Table("Table K1", caption, columns, tuple(rows))


def _tuning_row(match: Match, pd: Match, nanoseconds: float | None) -> tuple[str, ...]:
    shares = [_shares(x) for x in (match.stiffness / pd.stiffness, match.damping / pd.damping)]
    took = "–" if nanoseconds is None else number(nanoseconds, 0)
    return match.contender.needs, _number(match.bandwidth, 2), *shares[0], *shares[1], took


def _shares(ratios: Any) -> tuple[str, str]:
    if not (np.asarray(ratios) > 0).all():
        return "–", "–"
    return number(float(np.exp(np.mean(np.log(ratios)))), 3), f"{number(min(ratios), 2)}–{number(max(ratios), 2)}"


def error_tables(results: Results) -> tuple[Table, ...]:
    """Worst RMS errors, in two tables."""
    what = "Worst RMS error of the links, 10^{−3} degrees"
    return _halves(results, ("Table K2", "Table K3"), what, lambda outcome: outcome.worst.rms, True)


def further_tables(results: Results) -> tuple[Table, ...]:
    """Worst peaks and torques, in two tables each."""
    peak, torque = "Worst peak error of a link, 10^{−3} degrees", "RMS of what motor torques are off the ideal, N m"
    return (
        *_halves(results, ("Table K4", "Table K5"), peak, lambda outcome: outcome.worst.peak, False),
        *_halves(results, ("Table K6", "Table K7"), f"Worst {torque}", lambda outcome: outcome.worst.torque, False),
    )


def _halves(
    results: Results, labels: Sequence[str], what: str, of: Callable[[Outcome], float], marked: bool
) -> tuple[Table, ...]:
    ran = [scenario for scenario in SCENARIOS if scenario.key in results.outcomes]
    first = [scenario for scenario in ran if scenario.key in MODEL_SIDE]
    second = [scenario for scenario in ran if scenario.key not in MODEL_SIDE]
    mark = (f"; {BEST} is the best at equal stiffness" if marked else "") + _marks(results)
    mark += "; ∞: of how many runs how many diverged"
    notes = zip(labels, (first, second), strict=True)
    return tuple(_table(results, label, f"{what}{mark}.", half, of, marked) for label, half in notes if half)


def _marks(results: Results) -> str:
    """The end of a caption, if names of laws are marked."""
    is_marked = not all(match.equal for match in results.matches.values())
    return f"; {UNEQUAL} does not hold at equal stiffness" if is_marked else ""


def _table(results: Results, label: str, caption: str, scenarios: Sequence[Scenario], of: Any, marked: bool) -> Table:
    rows = []
    best = {s.key: results.best(s.key) if marked else None for s in scenarios}
    for key in results.matches:
        cells = [_cell(results.outcomes[s.key].get(key), of, key == best[s.key]) for s in scenarios]
        rows.append((law_name(results, key), *cells))
    return Table(label, caption, ("", *(scenario.name for scenario in scenarios)), tuple(rows))


def _cell(outcome: Outcome | None, of: Callable[[Outcome], float], best: bool) -> str:
    if outcome is None:
        return "–"
    if outcome.diverged:
        return f"∞ {outcome.diverged}/{len(outcome.scores)}"
    x = of(outcome)
    return number(x, 0 if x >= 100 else 1 if x >= 10 else 2) + (f" {BEST}" if best else "")


def refusals(results: Results) -> tuple[str, ...]:
    """A sentence for each law that does not run at equal stiffness."""
    return tuple(_refusal(match) for match in results.matches.values() if not match.equal)


def _refusal(match: Match) -> str:
    at = (
        f"it runs at {number(match.bandwidth, 2)} Hz, {number(match.share, 2)} of the PD's stiffness, and is not ranked"
    )
    # without a bandwidth at which it is as stiff, none beside that was tried
    tried = "no bandwidth within a factor of four serves, and " if np.isfinite(match.bandwidth) else ""
    outcome = at if match.law is not None else f"{tried}it does not run"
    return f"{match.contender.name} is refused at equal stiffness: {match.refused}; {outcome}."


def numbers(results: Results) -> dict[str, Any]:
    """All numbers for the results file; not finite for divergences and unknown ones."""
    return {
        "laws": {key: _law(match, results.nanoseconds.get(key)) for key, match in results.matches.items()},
        "scenarios": {s.key: _scenario(s, results) for s in SCENARIOS if s.key in results.outcomes},
    }


def _law(match: Match, nanoseconds: float | None) -> dict[str, Any]:
    plain = {name: getattr(match, name) for name in ("bandwidth", "share", "stiffness", "damping")}
    told = {"name": match.contender.name, "needs": match.contender.needs, "refused": match.refused}
    return {**told, **plain, "runs": match.law is not None, "nanoseconds": nanoseconds}


def _scenario(scenario: Scenario, results: Results) -> dict[str, Any]:
    found = results.outcomes[scenario.key]
    laws = {
        key: {
            "worst": outcome.worst._asdict(),
            "diverged": outcome.diverged,
            "runs": [score._asdict() for score in outcome.scores],
        }
        for key, outcome in found.items()
    }
    return {"name": scenario.name, "what": scenario.what, "best": results.best(scenario.key), "laws": laws}


def _number(x: float, digits: int) -> str:
    return number(x, digits) if np.isfinite(x) else "–"

"""Findings in sentences, made only from the numbers."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from cutpoint.reporting.page import number
from cutpoint.studies.compare.contenders import CONTENDERS, OURS
from cutpoint.studies.compare.results import Results
from cutpoint.studies.compare.scenarios import SCENARIOS

NAMES = {contender.key: contender.name for contender in CONTENDERS}
COLUMNS = {scenario.key: scenario.name for scenario in SCENARIOS}
FIXED = ("vdc", "vdc_filter")
"""Our laws without adaptation."""


def findings(results: Results) -> tuple[str, ...]:
    """Those that rank laws are of what ran at equal stiffness, divergences and times of all that ran; where nothing can
    be said there is none."""
    found = (
        leaders(results), ours(results, OURS, "virtual decomposition control"),
        ours(results, FIXED, "virtual decomposition control that does not learn"), against_feedforward(results),
        divergences(results), sensors(results), times(results),
    )  # fmt: skip
    return tuple(sentence for sentence in found if sentence)


def leaders(results: Results) -> str:
    """The best law of each scenario."""
    columns: dict[str, list[str]] = {}
    for scenario in results.outcomes:
        if (best := results.best(scenario)) is not None:
            columns.setdefault(best, []).append(f"{COLUMNS[scenario]} ({_milli(results.worst(scenario, best))})")
    ranked = sorted(columns, key=lambda key: -len(columns[key]))
    told = "; ".join(f"{NAMES[key]} in {len(columns[key])}: {', '.join(columns[key])}" for key in ranked)
    none = [COLUMNS[s] for s in results.outcomes if results.best(s) is None]
    lost = f" No law at equal stiffness gets through all runs of {_listed(none)}." if none else ""
    return f"The least worst RMS error, in 10^{{−3}} degrees, is that of {told}.{lost}" if told else lost.strip()


def ours(results: Results, keys: Sequence[str], what: str) -> str:
    """Where the best of some laws leads and where it loses against the best of all others, and by how much."""
    equal = [key for key, match in results.matches.items() if match.equal]
    own, others = [key for key in equal if key in keys], [key for key in equal if key not in OURS]
    if not (own and others):
        return ""
    won, lost = dict[str, float](), dict[str, float]()
    for scenario in results.outcomes:
        ratio = _least(results, scenario, own) / _least(results, scenario, others)
        if ratio <= 1:
            by = f"{number(1 / ratio, 2)} times less" if ratio else "no other gets through"
            won[f"{COLUMNS[scenario]} ({by})"] = ratio
        elif ratio > 1:  # not where all diverge
            rival = NAMES[results.best(scenario, others) or ""]
            by = f"{number(ratio, 2)} times the error" if np.isfinite(ratio) else "none gets through"
            lost[f"{COLUMNS[scenario]} ({by}; ahead is {rival})"] = ratio
    if not (won or lost):
        return ""
    defeats = sorted(lost, key=lambda words: -lost[words])
    return f"The best {what} leads all other laws in {_listed(won) or 'no column'}; it loses {_defeats(defeats)}."


def _defeats(words: Sequence[str]) -> str:
    return f"in {_listed(words)}" if words else "nowhere"


def _least(results: Results, scenario: str, among: Iterable[str]) -> float:
    """Worst RMS error of the best at equal stiffness; infinite where none gets through."""
    best = results.best(scenario, among)
    return results.worst(scenario, best) if best else np.inf


def against_feedforward(results: Results) -> str:
    """The two laws most like each other: the same model, fed forward or required of what is measured."""
    if not {"feedforward", *FIXED} <= results.matches.keys():
        return ""
    ratios = {}
    for scenario in results.outcomes:
        best = results.best(scenario, FIXED)
        reference = _least(results, scenario, ["feedforward"])
        if best and np.isfinite(reference):
            ratios[scenario] = results.worst(scenario, best) / reference
    told = _listed([f"{COLUMNS[scenario]} {number(ratio, 2)}" for scenario, ratio in ratios.items()])
    return f"The better VDC that does not learn has, of the error of PD + feedforward: {told}." if told else ""


def divergences(results: Results) -> str:
    """Which laws diverged where, except where all did."""
    ran = [key for key, match in results.matches.items() if match.law is not None]
    fell = {
        scenario: [key for key, outcome in laws.items() if outcome.diverged]
        for scenario, laws in results.outcomes.items()
    }
    lost = [scenario for scenario, keys in fell.items() if keys and len(keys) == len(results.outcomes[scenario])]
    where = {key: [COLUMNS[s] for s, keys in fell.items() if key in keys and s not in lost] for key in ran}
    held = [NAMES[key] for key, columns in where.items() if not columns]
    told = "; ".join(f"{NAMES[key]} in {', '.join(columns)}" for key, columns in where.items() if columns)
    sentences = [
        f"Under every law at least one run of {_listed([COLUMNS[s] for s in lost])} diverged." if lost else "",
        f"{'Apart from that, at' if lost else 'At'} least one run diverged of {told}." if told else "",
        f"None did of {_listed(held)}." if told and held else "No other run diverged." if lost else "",
    ]
    return " ".join(x for x in sentences if x) or ("No run diverged." if any(results.outcomes.values()) else "")


def sensors(results: Results) -> str:
    """The laws whose errors grow most with real sensors."""
    if not {"nominal", "sensors"} <= results.outcomes.keys():
        return ""
    growth: Mapping[str, float] = {
        key: results.worst("sensors", key) / results.worst("nominal", key)
        for key in results.outcomes["sensors"]
        if results.matches[key].equal
    }
    finite = {key: x for key, x in growth.items() if np.isfinite(x)}
    if not finite:
        return "No law at equal stiffness gets through all runs with steps, noise and differenced speeds."
    most, least = max(finite, key=lambda key: finite[key]), min(finite, key=lambda key: finite[key])
    return (
        f"Steps, noise and differenced speeds multiply the error of {NAMES[most]} by {number(finite[most], 2)}, the "
        f"most among those that do not diverge, and that of {NAMES[least]} by {number(finite[least], 2)}, the least."
    )


def times(results: Results) -> str:
    """Times of a step."""
    took = results.nanoseconds
    if not took:
        return ""
    fast, slow = min(took, key=lambda key: took[key]), max(took, key=lambda key: took[key])
    return (
        f"A step takes from {number(took[fast], 0)} ns ({NAMES[fast]}) to {number(took[slow], 0)} ns ({NAMES[slow]}), "
        f"{number(took[slow] / 1e4, 2)} % of a period of 1 ms: time does not decide between them."
        if took[slow] < 1e5
        else f"A step takes from {number(took[fast], 0)} ns ({NAMES[fast]}) to {number(took[slow], 0)} ns."
    )


def _milli(x: float) -> str:
    return number(x, 0 if x >= 100 else 1)


def _listed(words: Iterable[str]) -> str:
    found = [*words]
    return found[0] if len(found) == 1 else f"{', '.join(found[:-1])} and {found[-1]}" if found else ""

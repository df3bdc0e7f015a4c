"""The comparison: laws matched, run scenario by scenario, and the report written."""

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rich.progress import Progress

from cutpoint.errors import unknown_name
from cutpoint.reporting.folder import checked_folder, write
from cutpoint.reporting.html import Heading
from cutpoint.reporting.standing import Standing
from cutpoint.reporting.style import styled
from cutpoint.reporting.terminal import say, show
from cutpoint.robots import xia2019
from cutpoint.studies.compare.bench import Bench, bench_of
from cutpoint.studies.compare.contenders import CONTENDERS, Contender
from cutpoint.studies.compare.matching import matched
from cutpoint.studies.compare.page import pages_of, summary
from cutpoint.studies.compare.results import Results
from cutpoint.studies.compare.runs import Outcome, outcome
from cutpoint.studies.compare.scenarios import SCENARIOS, Scenario
from cutpoint.studies.compare.step_times import step_times

SEEDS, QUICK_SEEDS = 64, 4


def run(
    output: Path,
    bench: Bench | None = None,
    *,
    seeds: int = SEEDS,
    quick: bool = False,
    laws: Iterable[str] | None = None,
    scenarios: Iterable[str] | None = None,
    progress: bool = True,
) -> dict[str, Any]:
    """Compares control laws: writes output/index.html, output/figures/*.png and output/results.json.

    bench: the paper's arm if not given, see `bench_of`.  seeds: runs of a scenario in which chance has a part.
    quick: QUICK_SEEDS at most, and no slow move, unless scenarios are named.
    laws, scenarios: keys of those that are run, all if not given; the PD is always there, others are matched to it.
    progress: show a bar while it runs, and tables and findings at its end.  Ctrl-C writes what there is, marked
    incomplete.  Returns what results.json holds.

    Raises:
        InputError: output is no folder, cannot be written, or holds a report by others; a law or scenario is not
            known.
    """
    output, bench = checked_folder(output, "results.json", "compare"), bench or bench_of(xia2019())
    chosen = _chosen("law", CONTENDERS, None if laws is None else {CONTENDERS[0].key, *laws})
    plans = _chosen("scenario", SCENARIOS, scenarios)
    if quick:
        seeds = min(seeds, QUICK_SEEDS)
        plans = [plan for plan in plans if plan.key != "slow" or scenarios is not None]
    results = Results()
    with styled(), Standing(shown=progress) as bar:
        try:
            compare(bench, results, chosen, plans, seeds, bar)
        except KeyboardInterrupt:
            told = f"interrupted; results so far go to {output / 'index.html'}"
            bar.console.print(told, markup=False, highlight=False, soft_wrap=True)
        done = sum(len(laws) for laws in results.outcomes.values()), len(chosen) * len(plans)
        heading = Heading(f"Control laws compared on {bench.robot.name}", "cutpoint compare", summary(results, done))
        pages = pages_of(bench, results, seeds) if results.matches else []
        found = write(output, heading, pages, _settings(bench, results, seeds), "results.json", "compare")
    if progress and pages:
        show(pages[:2])
        say(pages[1])
        print(f"report: {output / 'index.html'}")
    return found


def compare(
    bench: Bench, results: Results, laws: Sequence[Contender], scenarios: Sequence[Scenario], seeds: int, bar: Progress
) -> None:
    """Fills the results, so that an interruption keeps those so far."""
    task = bar.add_task("", total=len(laws) * (1 + len(scenarios)))
    for contender in laws:
        bar.update(task, description=f"tuning {contender.name}")
        results.matches[contender.key] = matched(bench, contender)
        bar.advance(task)
    results.nanoseconds.update(step_times(bench, results.matches))
    for scenario in scenarios:
        cases, found = [*scenario.cases(bench, seeds)], dict[str, Outcome]()
        results.outcomes[scenario.key] = found
        for key, match in results.matches.items():
            bar.update(task, description=f"{scenario.name}: {match.contender.name}")
            if match.law is None:
                bar.advance(task)
                continue
            found[key] = outcome(bench, match.law, cases, partial(bar.advance, task, 1 / len(cases)))
    results.complete = True


def _chosen(kind: str, known: Sequence[Any], keys: Iterable[str] | None) -> list[Any]:
    """Those of these keys, in order; all without."""
    if keys is None:
        return [*known]
    names, wanted = [x.key for x in known], set(keys)
    for key in sorted(wanted - {*names}):
        raise unknown_name(kind, key, names)
    return [x for x in known if x.key in wanted]


def _settings(bench: Bench, results: Results, seeds: int) -> dict[str, Any]:
    return {
        "robot": bench.robot.name, "home": bench.home, "goal": bench.goal, "frame": bench.frame,
        "payload": bench.payload, "gears": bench.gears, "bandwidth": bench.bandwidth,
        "control_period": bench.control_period, "seeds": seeds, "complete": results.complete,
        "units": {**dict.fromkeys(("rms", "peak"), "1e-3 deg"), "torque": "N m", "stiffness": "N m/rad",
                  "damping": "N m s/rad"},
    }  # fmt: skip

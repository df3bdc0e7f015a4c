"""The comparison as figures: errors of all laws in all scenarios, some as bars, and times of a step."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from cutpoint.reporting.style import INK, LINK, MOTOR, WIDTH
from cutpoint.studies.compare.contenders import OURS
from cutpoint.studies.compare.results import Results
from cutpoint.studies.compare.scenarios import SCENARIOS
from cutpoint.studies.compare.tables import law_name

WORST = 100.0
"""Times the best of a column, from which on the shade is darkest."""

DARK = 0.85
"""Shade from which on words are white."""

IN_BARS = ("nominal", "friction", "sensors", "payload_1", "fast", "drives")


def heat_map(results: Results) -> Figure:
    """Worst RMS errors; shades by how many times the best of the column, which is bold."""
    scenarios = [s for s in SCENARIOS if s.key in results.outcomes]
    laws = [*results.matches]
    errors = np.array([[results.worst(s.key, key) for s in scenarios] for key in laws])
    figure = Figure(figsize=(WIDTH, 1.6 + 0.36 * len(laws)), layout="constrained")
    axes = figure.subplots()
    ranked = [results.best(s.key) for s in scenarios]
    best = np.array([results.worst(s.key, key) if key else 1.0 for s, key in zip(scenarios, ranked, strict=True)])
    shade = np.log(np.clip(np.where(np.isfinite(errors), errors / best, WORST), 1, WORST)) / np.log(WORST)
    axes.imshow(np.where(np.isnan(errors), np.nan, shade), cmap="Oranges", vmin=0, vmax=1.25, aspect="auto")
    for i, key in enumerate(laws):
        for j, scenario in enumerate(scenarios):
            weight = "bold" if key == ranked[j] else "normal"
            words, ink = _entry(results, scenario.key, key), "white" if shade[i, j] > DARK else INK
            axes.text(j, i, words, ha="center", va="center", fontsize=9, weight=weight, color=ink)
    _framed(axes, results, [s.name for s in scenarios])
    return figure


def _framed(axes: Axes, results: Results, columns: list[str]) -> None:
    axes.set_xticks(range(len(columns)), columns, rotation=35, ha="left", rotation_mode="anchor")
    axes.set_yticks(range(len(results.matches)), [law_name(results, key) for key in results.matches])
    axes.xaxis.tick_top()
    axes.grid(visible=False)
    axes.tick_params(length=0)
    for label, key in zip(axes.get_yticklabels(), results.matches, strict=True):
        label.set_color(LINK if key in OURS else INK)


def _entry(results: Results, scenario: str, key: str) -> str:
    outcome = results.outcomes[scenario].get(key)
    if outcome is None:
        return "–"
    return "∞" if outcome.diverged else _short(outcome.worst.rms)


def bars(results: Results) -> Figure:
    """A panel per scenario; ours in another colour."""
    chosen = [s for s in SCENARIOS if s.key in results.outcomes and s.key in IN_BARS]
    down = max(1, -(-len(chosen) // 3))
    figure = Figure(figsize=(WIDTH, 0.6 + down * (0.9 + 0.2 * len(results.matches))), layout="constrained")
    panels: Any = figure.subplots(down, 3, sharey=True, squeeze=False)
    for axes, scenario in zip(panels.flat, chosen, strict=False):
        _bars(axes, results, {key: results.worst(scenario.key, key) for key in results.matches})
        axes.set_title(scenario.name)
    for axes in panels.flat[len(chosen) :]:
        axes.set_axis_off()
    figure.supxlabel("worst RMS error of the links [$10^{-3}$ deg]", fontsize=12)
    return figure


def step_bars(results: Results) -> Figure:
    figure = Figure(figsize=(WIDTH, 1.0 + 0.22 * len(results.matches)), layout="constrained")
    axes = figure.subplots()
    _bars(axes, results, {key: results.nanoseconds.get(key, np.nan) for key in results.matches})
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("a step [ns]")
    return figure


def _bars(axes: Axes, results: Results, values: dict[str, float]) -> None:
    """On a logarithmic axis, the best at the top of its list's order; what diverged has a sign and no bar."""
    finite = [x for x in values.values() if np.isfinite(x)]
    low, high = (0.5 * min(finite), 4 * max(finite)) if finite else (0.1, 10.0)
    for k, (key, x) in enumerate(values.items()):
        if np.isfinite(x):
            axes.barh(k, x - low, left=low, height=0.72, color=LINK if key in OURS else MOTOR)
        words = _short(x) if np.isfinite(x) else "–" if np.isnan(x) else "diverged"
        at = (x if np.isfinite(x) else low, k)
        axes.annotate(words, at, (3, 0), textcoords="offset points", va="center", fontsize=9)
    axes.set(xscale="log", xlim=(low, high))
    axes.set_yticks(range(len(values)), [law_name(results, key) for key in values])
    axes.set_ylim(len(values) - 0.4, -0.6)
    axes.set_axisbelow(True)
    axes.minorticks_off()
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)


def _short(x: float) -> str:
    """Three digits."""
    return f"{float(f'{x:.3g}'):g}"

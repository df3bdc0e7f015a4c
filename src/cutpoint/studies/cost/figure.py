"""Operations and nanoseconds against the number of joints, on logarithmic axes."""

from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, NullLocator, ScalarFormatter

from cutpoint.reporting.style import FAINT, FORCE, LINK, MOTOR, SPRING, WIDTH
from cutpoint.studies.cost.contenders import CHRISTOFFEL, CONTENDERS, EXPLICIT, JETS, LAGRANGE, NE, VD, Contender
from cutpoint.studies.cost.measure import Cost

_LOOKS = {
    VD: (MOTOR, "-", "o"), NE: (LINK, "-", "s"), JETS: (MOTOR, "--", "o"), EXPLICIT: (LINK, "--", "s"),
    CHRISTOFFEL: (SPRING, "-", "^"), LAGRANGE: (FORCE, "-", "D"),
}  # fmt: skip


def figure_of(costs: Mapping[str, Cost]) -> Figure:
    figure = Figure(figsize=(WIDTH, 5.2), layout="constrained")
    operations, time = figure.subplots(1, 2, sharex=True)
    for contender in CONTENDERS:
        cost = costs[contender.key]
        _line(operations, contender, cost.operations)
        _line(time, contender, {n: timing.median for n, timing in cost.batched.items()})
    sizes = [*costs[VD.key].operations]
    operations.set(title="(a) operations", xlabel="joints")
    time.set(title="(b) time [ns], one of a batch", xlabel="joints")
    for axes in (operations, time):
        _logarithmic(axes, sizes)
    _guides(operations, max(sizes))
    figure.legend(*operations.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _line(axes: Axes, contender: Contender, values: Mapping[int, float]) -> None:
    colour, dashes, marker = _LOOKS[contender]
    axes.plot([*values], [*values.values()], dashes, color=colour, marker=marker, ms=4.5, label=contender.name)


def _logarithmic(axes: Axes, sizes: list[int]) -> None:
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    axes.set_xticks([n for n in sizes if n & (n - 1) == 0 or n in (6, max(sizes))])
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_formatter(NullFormatter())


def _guides(axes: Axes, largest: int) -> None:
    """Slopes to compare with, beside the curves."""
    for power, n, until, start in ((1, 8, 64, 800.0), (3, 8, 16, 4000.0), (4, 4, 8, 8000.0)):
        if until <= largest:
            end = start * (until / n) ** power
            axes.plot([n, until], [start, end], ":", color=FAINT, lw=1.2)
            axes.text(until, end, f" $n^{power}$" if power > 1 else " $n$", color=FAINT, va="center")

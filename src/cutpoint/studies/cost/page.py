"""The page of the study: figure, tables, and what they say of the paper's claim."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from cutpoint.reporting.page import Page, Picture, Table, number
from cutpoint.studies.cost.contenders import CONTENDERS
from cutpoint.studies.cost.figure import figure_of
from cutpoint.studies.cost.growth import exponent, polynomial
from cutpoint.studies.cost.measure import AGREEMENT, BATCH, COMPILE_LIMIT, STUDY_LIMIT, Cost
from cutpoint.studies.cost.verdict import verdict

_METHOD = (
    "Every formulation is written in plain Python on scalars of any kind, traced for one random chain of revolute "
    "joints (no parameter is zero, so that nothing folds away by luck), simplified and compiled by the same emitter, "
    f"and must give the torques of virtual decomposition to {AGREEMENT:g} of the largest before it is timed. Rivals "
    "are arranged as their sources do it. Operations are multiplications, additions, subtractions and "
    "divisions once constants are folded and common terms shared; a sine and a cosine a joint, the same for all, come "
    "on top.",
    f"Times are medians of turns taken one after another, one thread, {BATCH} random motions in one call of a batch; a "
    "single call from Python adds what NumPy takes to call anything. They move from machine to machine: only ratios "
    "are claims. Ratios of times in the findings are of the least of each. A contender leaves when its code would take "
    f"more than {COMPILE_LIMIT:g} s to compile, or when the study has taken {STUDY_LIMIT:g} s; six joints are always "
    "timed.",
)


def page_of(costs: Mapping[str, Cost]) -> Page:
    caption = "One inverse dynamics of a random chain: (a) operations, (b) nanoseconds, against the number of joints."
    blocks = (*_METHOD, Picture("Figure C1", caption, figure_of(costs)), _growth(costs), _times(costs))
    return Page("cost", "Against the number of joints", blocks, {"contenders": results(costs)})


def verdict_page(costs: Mapping[str, Cost]) -> Page:
    return Page("claim", "What is and what is not true of the paper's claim", verdict(costs))


def _growth(costs: Mapping[str, Cost]) -> Table:
    columns = ("", "operations", "exponent, operations", "exponent, time", "largest timed")
    rows = []
    for contender in CONTENDERS:
        cost = costs[contender.key]
        exponents = [exponent(cost.operations), exponent(cost.least_times())]
        cells = ["–" if x is None else number(x, 2) for x in exponents]
        rows.append((contender.name, _leading(cost), *cells, str(max(cost.batched))))
    caption = (
        "Growth: the lowest polynomial in n that tells the operations to 1 %, and exponents fitted over n ≥ 4, of "
        "times to the least of each n. With few joints a lower degree than the formulation's may tell them; exponents "
        "stay below the degree where lower powers still weigh."
    )
    return Table("Table C1", caption, columns, tuple(rows))


def _leading(cost: Cost) -> str:
    coefficients = polynomial(cost.operations)
    if coefficients is None:
        return "too few n to tell"
    degree = len(coefficients) - 1
    power = f"n^{{{degree}}}" if degree > 1 else "n"
    return f"{number(coefficients[0], 1)} {power} + …"


def _times(costs: Mapping[str, Cost]) -> Table:
    timed = costs["vd"].batched
    sizes = [n for n in timed if n in (1, 2, 4, 6, 8, 16, 32, max(timed))]
    rows = []
    for contender in CONTENDERS:
        cost = costs[contender.key]
        timings = [cost.batched.get(n) for n in sizes]
        rows.append((contender.name, *("–" if t is None else number(t.median, 0) for t in timings)))
    columns = ("", *(f"n = {n}" for n in sizes))
    return Table("Table C2", "Nanoseconds for one inverse dynamics of a batch: medians.", columns, tuple(rows))


def results(costs: Mapping[str, Cost]) -> dict[str, Any]:
    """Everything measured, by contender; the degree and the coefficients, highest power first, of `polynomial`."""
    found = {}
    for contender in CONTENDERS:
        cost, coefficients = costs[contender.key], polynomial(costs[contender.key].operations)
        found[contender.key] = {
            "name": contender.name,
            **asdict(cost),
            "polynomial": coefficients,
            "exponent_operations": exponent(cost.operations),
            "exponent_time": exponent(cost.least_times()),
        }
    return found

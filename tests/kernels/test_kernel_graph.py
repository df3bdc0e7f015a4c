"""Graphs: fingerprints, lowering, fusion, depth."""

import gc
import time
from collections import namedtuple
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from exact_primitives import evaluate
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st

from cutpoint.kernels import compile, graph_of
from cutpoint.kernels.graphs.graph import reach
from cutpoint.kernels.graphs.nodes import ELEMENTARY, PRIMITIVES, Node
from cutpoint.kernels.lowering.lower import lower
from cutpoint.scalars import cos, exp, sin

recipes = st.lists(steps, min_size=1, max_size=25)
FINITE = st.floats(-3, 3)


def graph(recipe: list[Step]) -> Any:
    return graph_of(lambda x: cook(recipe, x), x=3)


@given(recipes)
@settings(deadline=None)
def test_tracing_is_deterministic(recipe: list[Step]) -> None:
    first, second = graph(recipe), graph(recipe)
    assert [n.op for n in first.nodes] == [n.op for n in second.nodes]
    assert first.fingerprint() == second.fingerprint()


def test_fingerprints_tell_expressions_apart_and_ignore_how_they_were_built() -> None:
    def built(order: int) -> Any:
        def function(a: Any, b: Any) -> Any:
            first, second = (a * b, a + b) if order else (a + b, a * b)[::-1]
            return {0: first + second, 1: second + first, 2: first - second, 3: first * 1.5 + second}[order]

        return graph_of(function, a=(), b=()).fingerprint()

    assert built(0) == built(1)
    assert len({built(k) for k in range(4)}) == 3


def test_a_fingerprint_of_one_output_ignores_the_others_and_new_inputs() -> None:
    pair = namedtuple("pair", "torque power")
    one = graph_of(lambda q, k: pair(sin(q) * k[0], q * k[0]), q=(), k=1)
    two = graph_of(lambda extra, q, k: pair(k[0] * sin(q), cos(q) + extra), extra=(), q=(), k=1)
    assert one.fingerprint("torque") == two.fingerprint("torque")
    assert one.fingerprint("power") != two.fingerprint("power")
    assert one.fingerprint() != two.fingerprint()


@given(recipes)
@settings(deadline=None)
def test_lowering_leaves_only_primitives(recipe: list[Step]) -> None:
    assert set(lower(graph(recipe)).operations) <= set(PRIMITIVES) - set(ELEMENTARY)


@given(recipes)
@settings(deadline=None)
def test_lowered_nodes_are_those_that_results_need_operands_before_users(recipe: list[Step]) -> None:
    lowered = lower(graph(recipe))
    seen: set[int] = set()
    for x in lowered.nodes:
        assert {y.serial for y in x.args if isinstance(y, Node)} <= seen and x.serial not in seen
        seen.add(x.serial)
    assert seen == {x.serial for x in reach(lowered.results)}


def test_chains_that_do_not_wait_for_each_other_take_turns() -> None:
    def power(x: Any) -> Any:
        for _ in range(10):
            x = x * x
        return x

    lowered = lower(graph_of(lambda a, b: [power(a), power(b)], a=(), b=()))
    products = [x for x in lowered.nodes if x.op == "mul"]
    assert all(later.args[0] is not earlier for earlier, later in pairwise(products))


def test_a_product_used_once_in_a_sum_is_fused_and_no_other() -> None:
    mixed = graph_of(lambda a, b, c: [a * b + c, a * b * c - b, c - a * c], a=(), b=(), c=())
    assert lower(mixed).operations == {"mul": 1, "add": 1, "fms": 1, "fnma": 1}  # a * b is used twice
    assert lower(graph_of(lambda a, b, c: a * b + c, a=(), b=(), c=())).operations == {"fma": 1}
    assert lower(graph_of(lambda a, b, c: [a * b + c, a * b], a=(), b=(), c=())).operations == {"mul": 1, "add": 1}


def test_products_join_what_their_sum_is_added_to() -> None:
    def operations(function: Callable[..., Any]) -> dict[str, int]:
        return lower(graph_of(function, a=(), b=(), c=(), x=(), y=())).operations

    assert operations(lambda a, b, c, x, y: c + (a * x + b * y)) == {"fma": 2}
    assert operations(lambda a, b, c, x, y: c - (a * x - b * y)) == {"fnma": 1, "fma": 1}
    assert operations(lambda a, b, c, x, y: (a * x + b * y) + (b * c + x * y)) == {"add": 2, "mul": 1, "fma": 1}
    assert operations(lambda a, b, c, x, y: (a * x + b * y) + (c * c + y * y)) == {"add": 1, "mul": 1, "fma": 2}
    assert operations(lambda a, b, c, x, y: a * x - a * y) == {"sub": 1, "mul": 1}


def test_a_difference_and_its_negative_are_one_operation() -> None:
    def both(x: Any) -> list[Any]:
        return [(x[0] * x[1] - x[2]) * x[3], (x[2] - x[0] * x[1]) * x[4], x[5] - (x[2] - x[1] * x[0])]

    assert lower(graph_of(both, x=6)).operations == {"fms": 1, "mul": 2, "neg": 1, "add": 1}
    kernel, x = compile(both, x=6), np.arange(1.0, 7.0)
    assert kernel(x).tolist() == [-4.0, 5.0, 5.0]


def test_halves_of_doubles_vanish() -> None:
    assert graph_of(lambda x, y: (x * y + y * x) * 0.5, x=(), y=()).operations == {"mul": 1}


def test_numbers_that_are_no_products_keep_their_places() -> None:
    big = 1.5 * 2.0**52
    whole = compile(lambda x, k: (x * k + big) - big, x=(), k=(), backend="llvm")
    assert [float(whole(x, 2.0)) for x in (0.7, 1.3, -2.6, 1e6 + 0.2)] == [1.0, 3.0, -5.0, 2e6]

    def error_of_sum(x: Any, y: Any) -> Any:  # Knuth's, exact
        total = x + y
        given = total - x
        return (x - (total - given)) + (y - given)

    assert float(compile(error_of_sum, x=(), y=(), backend="llvm")(1.0, 2.0**-60)) == 2.0**-60


SUMS = st.recursive(
    st.tuples(st.integers(0, 4), st.integers(0, 4)) | st.integers(0, 4),
    lambda parts: st.tuples(st.sampled_from("+-"), parts, parts),
    max_leaves=12,
)
"""Sums, with their signs, of sums, of products of two of five numbers, and of the numbers."""


def total(plan: Any, x: Any) -> Any:
    match plan:
        case (str(sign), one, other):
            return total(one, x) + total(other, x) if sign == "+" else total(one, x) - total(other, x)
        case (int(j), int(k)):
            return x[j] * x[k]
        case k:
            return x[k]


def size(plan: Any, x: Any) -> Any:
    """The same with all signs positive."""
    match plan:
        case (str(), one, other):
            return size(one, x) + size(other, x)
        case _:
            return abs(total(plan, x))


@given(SUMS, st.lists(st.integers(-(2**20), 2**20), min_size=5, max_size=5))
@settings(deadline=None)
def test_sums_of_products_are_rounded_as_often_as_they_have_operations_at_most(plan: Any, numbers: list[int]) -> None:
    x = [Fraction(n, 3) for n in numbers]
    rounded = [Fraction(float(y)) for y in x]
    graph = lower(graph_of(lambda x: total(plan, x), x=5))
    (found,) = evaluate(graph, [float(y) for y in x])
    allowed = (len(graph.nodes) + 1) * Fraction(2) ** -53 * size(plan, rounded)
    assert abs(Fraction(found) - total(plan, rounded)) <= allowed * (1 + Fraction(1, 2**40))


@given(recipes, st.tuples(FINITE, FINITE, FINITE))
@settings(deadline=None, max_examples=60)
def test_machine_code_does_exactly_what_the_graph_says(recipe: list[Step], x: tuple[float, ...]) -> None:
    kernel = compile(lambda x: cook(recipe, x), x=3, backend="llvm")
    exact = evaluate(lower(kernel.graph), [*x])
    assert kernel([*x]).tobytes() == np.array(exact).tobytes()


def test_deep_graphs_need_no_recursion() -> None:
    def deep(x: Any) -> Any:
        for _ in range(20_000):
            x = x * x - 1
        return exp(x)

    chain = graph_of(deep, x=())
    assert len(lower(chain).nodes) > 20_000 and chain.fingerprint()
    del chain
    gc.collect()


def test_a_thousand_operations_compile_at_once() -> None:
    def function(x: Any) -> Any:
        values = [*x]
        for k in range(650):
            values.append(values[-1] * x[k % 6] + values[-2])
        return values[-6:]

    seconds = []
    for _ in range(3):
        start = time.process_time()
        assert sum(compile(function, x=6, backend="llvm").operations.values()) == 1300
        seconds.append(time.process_time() - start)
    assert min(seconds) < 0.15

"""Graphs: fingerprints, lowering, fusion, depth."""

import gc
import time
from collections import namedtuple
from itertools import pairwise
from typing import Any

import numpy as np
from exact_primitives import evaluate
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st

from cutpoint.kernels import compile, graph_of
from cutpoint.kernels.graph import reach
from cutpoint.kernels.lowering import lower
from cutpoint.kernels.nodes import ELEMENTARY, PRIMITIVES, Node
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

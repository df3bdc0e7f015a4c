"""Orders in which few numbers are held: whole, operands first, and no more held than is said."""

from typing import Any

import pytest
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st

from cutpoint.kernels import graph_of
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.lowering import few_held
from cutpoint.kernels.lowering.few_held import fewest_held, numbers_held
from cutpoint.kernels.lowering.lower import lower


def at_the_end(order: list[Node]) -> list[tuple[int, Node]]:
    return []


def held_by_hand(order: list[Node], reads: list[tuple[int, Node]]) -> list[int]:
    """Numbers that are there after an operation or while it reads, and that it or a later one reads."""
    found = []
    for k in range(len(order)):
        later = {y.serial for z in order[k:] for y in z.args if isinstance(y, Node)}
        later |= {y.serial for at, y in reads if at >= k}
        found.append(sum(y.serial in later for y in order[:k]) + 1)
    return found


@given(st.lists(steps, min_size=1, max_size=25))
@settings(deadline=None)
def test_every_order_is_one_and_holds_what_it_says(recipe: list[Step]) -> None:
    graph = lower(graph_of(lambda x: cook(recipe, x), x=3))
    results = [x for x in graph.results if isinstance(x, Node)]
    for order in few_held._candidates(graph):
        places = {x.serial: k for k, x in enumerate(order)}
        assert len(places) == len(order) == len(graph.nodes)
        assert all(places[y.serial] < places[x.serial] for x in order for y in x.args if isinstance(y, Node))
        reads = [(len(order) - 1, x) for x in results[:1]]
        assert numbers_held(order, reads) == held_by_hand(order, reads)


def halves(x: list[Any]) -> Any:
    """A balanced tree of products of sums: neighbours are read once."""
    while len(x) > 1:
        x = [(a + 1.0) * b for a, b in zip(x[::2], x[1::2], strict=True)]
    return x[0]


@pytest.mark.parametrize("depth", [2, 4, 6])
def test_a_tree_needs_as_many_registers_as_it_is_deep(depth: int) -> None:
    graph = graph_of(lambda x: halves(list(x)), x=2**depth)
    order = fewest_held(graph, at_the_end, 0)
    assert max(numbers_held(order, [])) == depth + 2  # the operands of an operation are there until its result is
    by_level = sorted(graph.nodes, key=lambda x: x.op != "input")
    assert max(numbers_held(by_level, [])) > 2**depth


def test_broad_graphs_are_ordered_in_time_that_grows_with_them() -> None:
    """A choice among all that could come next would take minutes."""
    graph = graph_of(lambda x: [x[0] * (1.0 + i) + x[1] for i in range(15_000)], x=2)
    order = fewest_held(graph, at_the_end, 0)
    assert 30_000 < len(order) <= few_held._MOST_NODES and max(numbers_held(order, [])) < 10


def test_longer_graphs_are_ordered_too() -> None:
    graph = graph_of(lambda x: [sum((x[i] * x[i + 1] for i in range(12_000)), 0.0)], x=12_001)
    assert len(graph.nodes) > few_held._MOST_NODES
    assert max(numbers_held(fewest_held(graph, at_the_end, 0), [])) < 10

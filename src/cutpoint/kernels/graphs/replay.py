"""Replay: a graph evaluated again on other scalars, such as SymPy's or those of another trace."""

import operator
from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from cutpoint import scalars
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import ELEMENTARY, Node
from cutpoint.kernels.graphs.ports import flatten, nest

OPERATORS: dict[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv, "neg": operator.neg,
    "lt": operator.lt, "le": operator.le, "and": operator.and_, "or": operator.or_,
    "not": lambda x: not x if isinstance(x, bool) else ~x, "select": scalars.where,
    **{op: getattr(scalars, op) for op in ("sqrt", *ELEMENTARY)},
}  # fmt: skip
"""What the operations do that a graph holds before it is lowered, on scalars; some may be floats and truths."""


def replay(
    graph: Graph,
    numbers: Sequence[Any],
    constant: Callable[[float], Any] = float,
    operators: Mapping[str, Callable[..., Any]] | None = None,
    taken: Callable[[Node, Any], Any] = lambda x, value: value,
) -> list[Any]:
    """The graph's results for a scalar in each input slot.

    constant: converts a float.  operators: implementations of operations, where Python's own are unsuitable.
    taken: converts a node's value before it is used further.
    """
    values: dict[int, Any] = {}
    apply = {**OPERATORS, **(operators or {})}

    def value(x: Any) -> Any:
        return values[x.serial] if isinstance(x, Node) else constant(x)

    for x in graph.nodes:
        found = numbers[x.args[0]] if x.op == "input" else apply[x.op](*map(value, x.args))
        values[x.serial] = taken(x, found)
    return [value(x) for x in graph.results]


def as_function(graph: Graph) -> Callable[..., Any]:
    """The graph as a function of scalars by keyword, which can be traced again; it returns a NamedTuple of outputs."""
    record = namedtuple("Outputs", [p.name for p in graph.outputs])

    def replayed(**inputs: Any) -> Any:
        numbers = [x for p in graph.inputs for x in flatten(inputs[p.name])[1]]
        results = iter(replay(graph, numbers))
        return record(*(nest(results, p.shape) for p in graph.outputs))

    return replayed

"""A graph as SymPy expressions, to read."""

import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import sympy

from cutpoint.errors import InputError
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import CONDITIONS, Node
from cutpoint.kernels.graphs.ports import Port, Shape
from cutpoint.kernels.graphs.replay import replay

Steps = list[tuple[Any, Any]]
"""Symbols and what they stand for, in terms of inputs and of symbols before them."""

# not evaluated, since SymPy would try to prove them
_OPERATORS: dict[str, Callable[..., Any]] = {
    "lt": lambda x, y: sympy.Lt(x, y, evaluate=False), "le": lambda x, y: sympy.Le(x, y, evaluate=False),
    "and": lambda x, y: sympy.And(x, y, evaluate=False),  # pyright: ignore[reportCallIssue]
    "or": lambda x, y: sympy.Or(x, y, evaluate=False),  # pyright: ignore[reportCallIssue]
    "not": lambda x: sympy.Not(x, evaluate=False),
    "select": lambda condition, yes, no: sympy.Piecewise((yes, condition), (no, True), evaluate=False),
}  # fmt: skip


def expressions(graph: Graph, name: str, in_steps: bool) -> tuple[Steps, list[Any]]:
    """Every output as an expression, a Matrix (a vector is a column), or an Array of more axes.

    in_steps: in terms of symbols s_0, s_1, ... for common subexpressions, and around every choice.
    Raises InputError if two numbers would have one symbol.
    """
    symbols, steps = _symbols(graph.inputs, name), []
    fresh, worth_a_name = _fresh(symbols), _worth_a_name(graph) if in_steps else set()

    def named(x: Node, value: Any) -> Any:
        if x.serial not in worth_a_name or value.is_Atom:
            return value
        steps.append((next(fresh), value))
        return steps[-1][0]

    return steps, _shaped(graph, replay(graph, symbols, _constant, _OPERATORS, named))


def _worth_a_name(graph: Graph) -> set[int]:
    """Nodes used more than once; also, since SymPy is slow on nested ones, choices and operands of comparisons."""
    pairs = [(x, y) for x in graph.nodes for y in x.args if isinstance(y, Node) and y.op not in CONDITIONS]
    uses = Counter(y.serial for _, y in pairs)
    near_a_choice = {y.serial for x, y in pairs if y.op == "select" or x.op in ("lt", "le")}
    return near_a_choice | {serial for serial, count in uses.items() if count > 1}


def _fresh(taken: Sequence[Any]) -> Iterator[Any]:
    numbered = (sympy.Symbol(f"s_{k}") for k in itertools.count())
    return (symbol for symbol in numbered if symbol not in taken)


def _symbols(ports: Sequence[Port], name: str) -> list[Any]:
    names = ["_".join(map(str, (p.name, *index))) for p in ports for index in np.ndindex(p.shape)]
    twice = [symbol for symbol, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(f"{name}: {twice[0]!r} would be the symbol for two inputs: rename one", name=twice[0])
    return [sympy.Symbol(symbol) for symbol in names]


def _constant(x: float) -> Any:
    """The float, exactly; integers and simple fractions in their usual form."""
    if not np.isfinite(x):
        return sympy.nan if np.isnan(x) else sympy.oo * int(np.sign(x))
    numerator, denominator = x.as_integer_ratio()
    return sympy.Rational(numerator, denominator) if denominator <= 64 and abs(x) < 2**20 else sympy.Float(x)


def _shaped(graph: Graph, results: Sequence[Any]) -> list[Any]:
    rest = iter(results)
    return [_array([next(rest) for _ in range(p.size)], p.shape) for p in graph.outputs]


def _array(results: list[Any], shape: Shape) -> Any:
    if not shape:
        return results[0]
    if len(shape) > 2:
        return sympy.ImmutableDenseNDimArray(results, shape)
    rows, columns = (*shape, 1)[:2]
    return sympy.Matrix(rows, columns, results)

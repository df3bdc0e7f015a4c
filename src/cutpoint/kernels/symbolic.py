"""A graph as SymPy expressions, to read."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
import sympy

from cutpoint.errors import InputError
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.ports import Port, Shape
from cutpoint.kernels.replay import replay

from sympy.functions.elementary.piecewise import ExprCondPair
def _p(c,y,n):
    mk=lambda e,c: sympy.Tuple.__new__(ExprCondPair,e,c)
    return sympy.Basic.__new__(sympy.Piecewise, mk(sympy.sympify(y),sympy.sympify(c)), mk(sympy.sympify(n),sympy.true))
# SymPy would look for proofs of what holds, which takes minutes where choices are nested
_OPERATORS: dict[str, Any] = {
    "lt": lambda x, y: sympy.Lt(x, y, evaluate=False), "le": lambda x, y: sympy.Le(x, y, evaluate=False),
    "and": lambda x, y: sympy.And(x, y, evaluate=False), "or": lambda x, y: sympy.Or(x, y, evaluate=False),
    "not": lambda x: sympy.Not(x, evaluate=False),
    "select": lambda condition, yes, no: _p(condition,yes,no),
}  # fmt: skip


def expressions(graph: Graph, name: str) -> list[Any]:
    """Every output as an expression, a Matrix (a vector is a column), or an Array of more axes.

    Raises InputError if two numbers would have one symbol.
    """
    results = replay(graph, _symbols(graph.inputs, name), _constant, _OPERATORS)
    shaped, start = [], 0
    for port in graph.outputs:
        shaped.append(_shaped(results[start : start + port.size], port.shape))
        start += port.size
    return shaped


def _symbols(ports: Sequence[Port], name: str) -> list[Any]:
    names = ["_".join(map(str, (p.name, *index))) for p in ports for index in np.ndindex(p.shape)]
    twice = [symbol for symbol, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(f"{name}: {twice[0]!r} would be the symbol of two inputs: rename one", name=twice[0])
    return [sympy.Symbol(symbol) for symbol in names]


def _constant(x: float) -> Any:
    """The float, exactly; whole numbers and simple fractions as such, as one would write them."""
    if not np.isfinite(x):
        return sympy.nan if np.isnan(x) else sympy.oo * int(np.sign(x))
    numerator, denominator = x.as_integer_ratio()
    return sympy.Rational(numerator, denominator) if denominator <= 64 and abs(x) < 2**20 else sympy.Float(x)


def _shaped(results: list[Any], shape: Shape) -> Any:
    if not shape:
        return results[0]
    if len(shape) > 2:
        return sympy.ImmutableDenseNDimArray(results, shape)
    rows, columns = (*shape, 1)[:2]
    return sympy.Matrix(rows, columns, results)

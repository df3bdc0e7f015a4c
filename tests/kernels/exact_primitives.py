"""The primitives in plain Python floats, bit by bit as documented: what machine code must equal exactly."""

import math
import operator
import struct
from fractions import Fraction
from typing import Any

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node


def bits(x: float) -> int:
    return struct.unpack("<Q", struct.pack("<d", x))[0]


def real(pattern: int) -> float:
    return struct.unpack("<d", struct.pack("<Q", pattern))[0]


def fma(a: float, b: float, c: float) -> float:
    exact = Fraction(a) * Fraction(b) + Fraction(c)
    return float(exact) if exact else a * b + c  # the sign of zero is the sum's


FORMS = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv, "neg": operator.neg,
    "sqrt": math.sqrt, "fma": fma, "lt": operator.lt, "le": operator.le,
    "fms": lambda a, b, c: fma(a, b, -c), "fnma": lambda a, b, c: fma(-a, b, c),
    "and": lambda a, b: a and b, "or": lambda a, b: a or b, "not": operator.not_,
    "select": lambda condition, yes, no: yes if condition else no,
    "flip": lambda a, k, x: -x if bits(a) >> k & 1 else x,
    "pick": lambda a, k, yes, no: yes if bits(a) >> k & 1 else no,
    "pow2": lambda n: math.ldexp(1.0, int(n)),
    "exponent": lambda a: float(math.frexp(a)[1] - 1),
    "significand": lambda a: 2 * math.frexp(a)[0],
}  # fmt: skip


def evaluate(graph: Graph, inputs: list[float]) -> list[float]:
    values: dict[int, Any] = {}

    def value(x: Any) -> Any:
        return values[x.serial] if isinstance(x, Node) else x

    for x in graph.nodes:
        values[x.serial] = inputs[x.args[0]] if x.op == "input" else FORMS[x.op](*map(value, x.args))
    return [value(x) for x in graph.results]

"""Exact simplification rules: the result of + - * / on operands, at least one of them a node.

Zeros and ones vanish, signs move outward until an addition absorbs them, constant factors are combined, and the
operands of + and * are put in canonical order, so that equal expressions written differently share a node.
"""

from typing import Any

import numpy as np

from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.refusals import refuse

_LEAST, _LARGEST = float(np.finfo(np.float32).tiny), float(np.finfo(np.float32).max)

Operand = Any
"""A node, or a float where the value is known."""


def neg(x: Operand) -> Operand:
    if not isinstance(x, Node):
        return -x
    if x.op == "neg":
        return x.args[0]
    if x.op == "sub":
        return sub(x.args[1], x.args[0])
    return x.trace.node("neg", x)


def add(x: Operand, y: Operand) -> Operand:
    if not isinstance(x, Node):
        x, y = y, x
    if isinstance(y, float) and y == 0:
        return x
    if x.op == "neg":
        return sub(y, x.args[0])
    if not isinstance(y, Node):
        return x.trace.node("add", x, y)
    return sub(x, y.args[0]) if y.op == "neg" else x.trace.node("add", *_ordered(x, y))


def sub(x: Operand, y: Operand) -> Operand:
    if not isinstance(y, Node):
        return add(x, -y)
    if y.op == "neg":
        return add(x, y.args[0])
    if not isinstance(x, Node):
        return neg(y) if x == 0 else y.trace.node("sub", x, y)
    if x is y:
        return 0.0
    return neg(add(x.args[0], y)) if x.op == "neg" else x.trace.node("sub", x, y)


def mul(x: Operand, y: Operand) -> Operand:
    if not isinstance(x, Node):
        x, y = y, x
    if x.op == "neg":
        return neg(mul(x.args[0], y))
    if not isinstance(y, Node):
        return _scaled(x, y)
    return neg(mul(x, y.args[0])) if y.op == "neg" else x.trace.node("mul", *_ordered(x, y))


def _scaled(x: Node, factor: float) -> Operand:
    if factor == 0:
        return 0.0
    if factor < 0:
        return neg(_scaled(x, -factor))
    if factor == 1:
        return x
    if x.op == "add" and x.args[0] is x.args[1] and _is_normal(2 * factor):
        return _scaled(x.args[0], 2 * factor)
    if x.op == "mul" and isinstance(x.args[1], float) and _is_normal(x.args[1] * factor):
        return _scaled(x.args[0], x.args[1] * factor)
    return x.trace.node("mul", x, factor)


def div(x: Operand, y: Operand) -> Operand:
    if not isinstance(y, Node):
        return _divided(x, y)
    if y.op == "neg":
        return neg(div(x, y.args[0]))
    if not isinstance(x, Node):
        return 0.0 if x == 0 else neg(div(-x, y)) if x < 0 else y.trace.node("div", x, y)
    if x is y:
        return 1.0
    return neg(div(x.args[0], y)) if x.op == "neg" else x.trace.node("div", x, y)


def _divided(x: Node, divisor: float) -> Operand:
    if divisor == 0:
        refuse("a traced number is divided by the constant zero")
    reciprocal = 1 / divisor
    # a subnormal or infinite reciprocal has lost digits
    return mul(x, reciprocal) if _is_normal(reciprocal) else x.trace.node("div", x, divisor)


def power(x: Node, exponent: float) -> Operand:
    """x to a constant integer exponent, by repeated squaring, or its square root."""
    if exponent == 0.5:
        return x.trace.node("sqrt", x)
    if not exponent.is_integer():
        refuse(f"a traced number to the power {exponent!r}: only whole exponents and 0.5 are compiled; use exp and log")
    square, result, n = x, 1.0, abs(int(exponent))
    while n:
        result = mul(square, result) if n & 1 else result
        n >>= 1
        square = mul(square, square) if n else square
    return div(1.0, result) if exponent < 0 else result


def _ordered(x: Node, y: Node) -> tuple[Node, Node]:
    return (x, y) if x.serial <= y.serial else (y, x)


def _is_normal(x: float) -> bool:
    """Whether x is normal in every precision: one graph serves them all."""
    return _LEAST <= abs(x) <= _LARGEST

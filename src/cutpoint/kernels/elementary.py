"""Elementary functions in graph arithmetic, so that every target computes the same bits.

All are branch-free and read only +, -, *, /, fma, comparisons, select and the bits of a number.  Accuracies were measured
against 40 digits; NaN gives NaN.  Coefficients of sin, cos and log: fdlibm (Sun Microsystems, 1993); of atan: the
Cephes library (S. L. Moshier); exp and tanh use Taylor's, which are exact enough at degree 13.
"""

from typing import Any

from cutpoint.kernels.algebra import Operand
from cutpoint.kernels.graph import Graph, rewrite
from cutpoint.kernels.nodes import Node

MAGIC = 1.5 * 2.0**52
"""Added to a number of at most 2**51 it rounds it to a whole one, which the lowest bits of the sum hold."""

_TWO_OVER_PI = 0.6366197723675814
_HALF_PI = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33)  # sums to pi/2 within 1e-49
_SIN = (
    1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06,
    -1.98412698298579493134e-04, 8.33333333332248946124e-03, -1.66666666666666324348e-01,
)  # fmt: skip
_COS = (
    -1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07,
    2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02,
)  # fmt: skip


def fma(x: Any, y: Any, z: Any) -> Any:
    """x * y + z rounded once; at least one of them is traced."""
    trace = next(a.trace for a in (x, y, z) if isinstance(a, Node))
    return trace.node("fma", x, y, z)


def _polynomial(x: Any, coefficients: tuple[float, ...]) -> Any:
    """Horner's scheme, highest power first."""
    total = fma(coefficients[0], x, coefficients[1])
    for c in coefficients[2:]:
        total = fma(total, x, c)
    return total


def _select(condition: Any, yes: Operand, no: Operand) -> Any:
    return condition.trace.node("select", condition, yes, no)
def sin_cos(x: Any) -> tuple[Any, Any]:
    y = fma(x, _TWO_OVER_PI, MAGIC)
    n = y - MAGIC
    r = x
    for part in _HALF_PI:
        r = fma(n, -part, r)
    z = r * r
    s = fma(r * z, _polynomial(z, _SIN), r)
    c = fma(z * z, _polynomial(z, _COS), fma(z, -0.5, 1.0))
    odd = x.trace.node("bit", y, 0)
    sin, cos = _select(odd, c, s), _select(odd, s, c)
    return _flip(y, sin), _flip(y + 1, cos)
def _flip(y, x):
    return _select(x.trace.node("bit", y, 1), x.trace.node("neg", x), x)

def lower(graph: Graph) -> Graph:
    def rule(x, args, new, trace):
        if x.op == "sin": return sin_cos(args[0])[0]
        if x.op == "cos": return sin_cos(args[0])[1]
        return trace.node(x.op, *args)
    return rewrite(graph, rule)

"""Elementary functions in graph arithmetic, so that every target computes the same bits.

All are branch-free, with fused multiply-adds explicit.  NaN gives NaN, infinities give the limits, and odd functions of
-0.0 give -0.0.
`c` is the table of coefficients of a precision.  Error bounds hold in both precisions unless they name one; errors in
single precision were measured at every float32 of the range.
"""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from cutpoint.kernels.lowering.coefficients import Coefficients


def sin(x: Any, c: Coefficients) -> Any:
    """Within 1.9 ulp for |x| <= 1e5; NaN beyond 1.77e15.  Single: within 3.2 ulp for |x| <= 3.2e6, NaN beyond 3.3e6."""
    return _sin_cos(x, c, _by_steps)[0]


def cos(x: Any, c: Coefficients) -> Any:
    """Within 1.9 ulp for |x| <= 1e5; NaN beyond 1.77e15.  Single: within 3.2 ulp for |x| <= 3.2e6, NaN beyond 3.3e6."""
    return _sin_cos(x, c, _by_steps)[1]


def tan(x: Any, c: Coefficients) -> Any:
    """Within 4 ulp for |x| <= 1e5; NaN beyond 1.77e15.  Single: within 4.9 ulp for |x| <= 3.2e6, NaN beyond 3.3e6."""
    sine, cosine = _sin_cos(x, c, _polynomial)  # the errors of both add up, so it uses the more accurate polynomial
    return sine / cosine


def _sin_cos(x: Any, c: Coefficients, polynomial: Callable[[Any, tuple[float, ...]], Any]) -> tuple[Any, Any]:
    """Both at once: Cody and Waite's reduction by multiples of pi/2, a polynomial each, then the quadrant."""
    y, n, r = _reduced(x, 2 / math.pi, c.half_pi, c)
    z = _select(_turned_with(n, n, c) < 2.0 ** (c.precision.fraction - 2), r * r, math.nan)  # beyond, n is no integer
    node = x.trace.node
    cube = _fma(r, z, 0.0)  # not r * z: for r = -0.0 this is 0.0, so that the sum below keeps the sign of r
    sine = node("flip", y, 1, _fma(cube, polynomial(z, c.sin), r))
    cosine = node("flip", y, 1, _fma(z * z, polynomial(z, c.cos), _fma(z, -0.5, 1.0)))
    return node("pick", y, 0, cosine, sine), node("pick", y, 0, -sine, cosine)


def exp(x: Any, c: Coefficients) -> Any:
    """Within 1 ulp, 1.1 ulp in single precision; 0 on underflow and infinity on overflow."""
    bounded = _select(x < c.exp_least, c.exp_least, _select(x > c.exp_most, c.exp_most, x))
    _, n, r = _reduced(bounded, 1 / c.ln2[0], c.ln2, c)
    # in two steps, since 2**n may be subnormal or infinite where the result is not
    half = _fma(n, 0.5, c.precision.magic) - c.precision.magic
    return (_expm1_near_zero(r, c) + 1) * _pow2(half) * _pow2(n - half)


def tanh(x: Any, c: Coefficients) -> Any:
    """Within 3 ulp, and odd: e / (e + 2) with e = exp(2 |x|) - 1."""
    size = _turned_with(x, x, c)
    _, n, r = _reduced(2 * _select(size > c.tanh_most, c.tanh_most, size), 1 / c.ln2[0], c.ln2, c)
    scale = _pow2(n)
    e = _fma(scale, _expm1_near_zero(r, c), scale - 1)
    return _turned_with(x, e / (e + 2), c)


def _expm1_near_zero(r: Any, c: Coefficients) -> Any:
    return _fma(r * r, _polynomial_in_halves(r, c.exp), r)


def log(x: Any, c: Coefficients) -> Any:
    """Within 1 ulp; NaN below zero, -infinity at zero.  fdlibm's method: x = 2**n (1 + f) with 1 + f about 1."""
    shift = c.precision.fraction + 2
    subnormal = x < 2.0 ** (1 - c.precision.bias)
    normal = _select(subnormal, x * 2.0**shift, x)
    m, n = (x.trace.node(op, normal) for op in ("significand", "exponent"))
    upper = m > math.sqrt(2)
    f = _select(upper, m / 2, m) - 1
    n = _select(upper, n + 1, n) - _select(subnormal, float(shift), 0.0)
    s, half_square = f / (f + 2), f * f / 2
    z = s * s
    tail = half_square - _fma(n, c.ln2_short[1], s * _fma(z, _polynomial(z, c.log), half_square))
    value = x.trace.node("fms", n, c.ln2_short[0], tail - f)
    finite = _select(x < math.inf, value, x)
    return _select(x > 0, finite, _select(x < 0, math.nan, _select(x <= 0, -math.inf, x)))


def atan(x: Any, c: Coefficients) -> Any:
    """Within 1 ulp, 2.3 ulp in single precision, and odd.

    Cephes' method: the argument is reduced below 0.66, below 0.42 in single, by atan(a) = constant + atan(t).
    """
    size = _turned_with(x, x, c)
    steep, middle = size > 2.41421356237309504880, size > c.atan_middle

    def by_range(least: Any, mid: Any, most: Any) -> Any:
        return _select(steep, most, _select(middle, mid, least))

    t = by_range(size, size - 1, -1.0) / by_range(1.0, size + 1, size)
    z = t * t
    t = _fma(t, z * _polynomial(z, c.atan_over) / _polynomial(z, c.atan_under), t)
    rest = by_range(0.0, c.half_pi[1] / 2, c.half_pi[1])
    return _turned_with(x, by_range(0.0, c.half_pi[0] / 2, c.half_pi[0]) + (t + rest), c)


def _reduced(x: Any, per_unit: float, unit: tuple[float, ...], c: Coefficients) -> tuple[Any, Any, Any]:
    """n + magic, whose low bits are n; the integer n; and r = x - n unit, at most half a unit (given in parts)."""
    y = _fma(x, per_unit, c.precision.magic)
    n = y - c.precision.magic
    r = x
    for part in unit:
        r = _fma(n, -part, r)
    return y, n, r


def _fma(x: Any, y: Any, z: Any) -> Any:
    """x * y + z rounded once; x is traced."""
    return x.trace.node("fma", x, y, z)


def _polynomial(x: Any, coefficients: tuple[float, ...]) -> Any:
    """Horner's scheme by pairs, the highest power first: one product more, half the latency."""
    odd = len(coefficients) % 2
    pairs = zip(coefficients[odd::2], coefficients[odd + 1 :: 2], strict=True)
    terms = [*coefficients[:odd], *(_fma(x, high, low) for high, low in pairs)]
    square, total = x * x, terms[0]
    for term in terms[1:]:
        total = _fma(square, total, term)
    return total


def _by_steps(x: Any, coefficients: tuple[float, ...]) -> Any:
    """Degree five by p <- p (x**2 + a) + b, twice: one product a step where Horner's scheme takes two.

    Eve, The evaluation of polynomials (Numerische Mathematik 6, 1964): -a are the roots of the odd part.  The larger a
    comes first: this minimises cancellation in the steps.
    """
    if len(coefficients) != 6:
        return _polynomial(x, coefficients)
    c5, c4, c3, c2, c1, c0 = coefficients
    a = (c3 + math.copysign(math.sqrt(c3 * c3 - 4 * c1 * c5), c3)) / (2 * c5)
    d = c1 / (c5 * a)
    b = c2 - c4 * (a + d)
    e = float(Fraction(c0) - Fraction(d) * (Fraction(c4) * Fraction(a) + Fraction(b)))  # far less than its terms
    square = x * x
    return _fma(_fma(_fma(x, c5, c4), square + a, b), square + d, e)


def _polynomial_in_halves(x: Any, coefficients: tuple[float, ...]) -> Any:
    """Estrin's scheme, the highest power first: no less accurate here than Horner's, at a third of the latency."""
    terms = [*reversed(coefficients)]
    while len(terms) > 1:
        pairs = [_fma(x, high, low) for low, high in zip(terms[::2], terms[1::2], strict=False)]
        terms, x = pairs + terms[len(terms) - len(terms) % 2 :], x * x
    return terms[0]


def _select(condition: Any, yes: Any, no: Any) -> Any:
    return condition.where(condition, yes, no)


def _pow2(n: Any) -> Any:
    return n.trace.node("pow2", n)


def _turned_with(x: Any, y: Any, c: Coefficients) -> Any:
    """y, with its sign flipped where x is negative or -0.0: |x| for y = x."""
    return x.trace.node("flip", x, c.precision.bits - 1, y)

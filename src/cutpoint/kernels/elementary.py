"""Elementary functions in graph arithmetic, so that every target computes the same bits.

All are branch-free.  NaN gives NaN, infinities give the limits.  Coefficients of sin, cos and log are those of fdlibm
(Sun Microsystems, 1993), those of atan of the Cephes library (S. L. Moshier); exp and tanh use Taylor's series, whose
remainder at degree 13 is 2 % of an ulp for |r| <= log(2) / 2.
"""

import math
from typing import Any

MAGIC = 1.5 * 2.0**52
"""Added to a number of at most 2**50 it rounds it to a whole one, whose lowest bits are those of the sum."""

_HALF_PI = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33)  # parts that sum to pi/2 within 2**-160
_LN2 = (0.6931471805599453, 2.3190468138462996e-17)  # parts that sum to log(2)
_LN2_SHORT = (6.93147180369123816490e-01, 1.90821492927058770002e-10)  # the first times any exponent is exact
_SIN = (
    1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06,
    -1.98412698298579493134e-04, 8.33333333332248946124e-03, -1.66666666666666324348e-01,
)  # fmt: skip
_COS = (
    -1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07,
    2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02,
)  # fmt: skip
_LOG = (
    1.479819860511658591e-01, 1.531383769920937332e-01, 1.818357216161805012e-01, 2.222219843214978396e-01,
    2.857142874366239149e-01, 3.999999999940941908e-01, 6.666666666666735130e-01,
)  # fmt: skip
_ATAN_OVER = (
    -8.750608600031904122785e-1, -1.615753718733365076637e1, -7.500855792314704667340e1,
    -1.228866684490136173410e2, -6.485021904942025371773e1,
)  # fmt: skip
_ATAN_UNDER = (
    1.0, 2.485846490142306297962e1, 1.650270098316988542046e2, 4.328810604912902668951e2,
    4.853903996359136964868e2, 1.945506571482613964425e2,
)  # fmt: skip
_EXP = tuple(1 / math.factorial(k) for k in range(13, 1, -1))


def sin(x: Any) -> Any:
    """Within 1.6 ulp for |x| <= 1e5; NaN beyond 1e15."""
    return _sin_cos(x)[0]


def cos(x: Any) -> Any:
    """Within 1.6 ulp for |x| <= 1e5; NaN beyond 1e15."""
    return _sin_cos(x)[1]


def tan(x: Any) -> Any:
    """Within 4 ulp for |x| <= 1e5; NaN beyond 1e15."""
    s, c = _sin_cos(x)
    return s / c


def _sin_cos(x: Any) -> tuple[Any, Any]:
    """Both at once: Cody and Waite's reduction by multiples of pi/2, a polynomial each, then the quadrant."""
    y, n, r = _reduced(x, 2 / math.pi, _HALF_PI)
    z = _select(n * n < 2.0**100, r * r, math.nan)  # beyond, n is not whole
    s = _fma(r * z, _polynomial(z, _SIN), r)
    c = _fma(z * z, _polynomial(z, _COS), _fma(z, -0.5, 1.0))
    node = x.trace.node
    return node("flip", y, 1, node("pick", y, 0, c, s)), node("flip", y + 1, 1, node("pick", y, 0, s, c))


def exp(x: Any) -> Any:
    """Within 1 ulp; 0 and infinity where the result is beyond all floats."""
    bounded = _select(x < -746, -746.0, _select(x > 710, 710.0, x))
    _, n, r = _reduced(bounded, 1 / _LN2[0], _LN2)
    half = _fma(n, 0.5, MAGIC) - MAGIC  # two steps, since 2**n may be subnormal or infinite where the result is not
    return (_expm1_near_zero(r) + 1) * _pow2(half) * _pow2(n - half)


def tanh(x: Any) -> Any:
    """Within 3 ulp, and odd: e / (e + 2) with e = exp(2 |x|) - 1."""
    size = _size(x)
    _, n, r = _reduced(2 * _select(size > 22, 22.0, size), 1 / _LN2[0], _LN2)
    scale = _pow2(n)
    e = _fma(scale, _expm1_near_zero(r), scale - 1)
    return _with_sign_of(x, e / (e + 2))


def _expm1_near_zero(r: Any) -> Any:
    return _fma(r * r, _polynomial_in_halves(r, _EXP), r)


def log(x: Any) -> Any:
    """Within 1 ulp; NaN below zero, -infinity at zero.  fdlibm's method: x = 2**n (1 + f) with 1 + f about 1."""
    subnormal = x < 2.0**-1022
    normal = _select(subnormal, x * 2.0**54, x)
    m, n = (x.trace.node(op, normal) for op in ("significand", "exponent"))
    upper = m > math.sqrt(2)
    f = _select(upper, m / 2, m) - 1
    n = _select(upper, n + 1, n) - _select(subnormal, 54.0, 0.0)
    s, half_square = f / (f + 2), f * f / 2
    z = s * s
    tail = half_square - (s * _fma(z, _polynomial(z, _LOG), half_square) + n * _LN2_SHORT[1])
    value = n * _LN2_SHORT[0] - (tail - f)
    finite = _select(x < math.inf, value, x)
    return _select(x > 0, finite, _select(x < 0, math.nan, _select(x <= 0, -math.inf, x)))


def atan(x: Any) -> Any:
    """Within 1 ulp, and odd.  Cephes' method: the argument is brought below 0.66 by atan(a) = c + atan(t)."""
    size = _size(x)
    steep, middle = size > 2.41421356237309504880, size > 0.66

    def by_range(least: Any, mid: Any, most: Any) -> Any:
        return _select(steep, most, _select(middle, mid, least))

    t = by_range(size, size - 1, -1.0) / by_range(1.0, size + 1, size)
    z = t * t
    t = _fma(t, z * _polynomial(z, _ATAN_OVER) / _polynomial(z, _ATAN_UNDER), t)
    rest = by_range(0.0, _HALF_PI[1] / 2, _HALF_PI[1])
    return _with_sign_of(x, by_range(0.0, _HALF_PI[0] / 2, _HALF_PI[0]) + (t + rest))


def _reduced(x: Any, per_unit: float, unit: tuple[float, ...]) -> tuple[Any, Any, Any]:
    """n + MAGIC, which shows the bits of n; n, whole; and r = x - n unit, at most half a unit (given in parts)."""
    y = _fma(x, per_unit, MAGIC)
    n = y - MAGIC
    r = x
    for part in unit:
        r = _fma(n, -part, r)
    return y, n, r


def _fma(x: Any, y: Any, z: Any) -> Any:
    """x * y + z rounded once; x is traced."""
    return x.trace.node("fma", x, y, z)


def _polynomial(x: Any, coefficients: tuple[float, ...]) -> Any:
    """Horner's scheme, the highest power first."""
    total = _fma(x, coefficients[0], coefficients[1])
    for c in coefficients[2:]:
        total = _fma(total, x, c)
    return total


def _polynomial_in_halves(x: Any, coefficients: tuple[float, ...]) -> Any:
    """Estrin's scheme, the highest power first: no less exact here than Horner's, and a third as long to wait for."""
    terms = [*reversed(coefficients)]
    while len(terms) > 1:
        pairs = [_fma(x, high, low) for low, high in zip(terms[::2], terms[1::2], strict=False)]
        terms, x = pairs + terms[len(terms) - len(terms) % 2 :], x * x
    return terms[0]


def _select(condition: Any, yes: Any, no: Any) -> Any:
    return condition.where(condition, yes, no)


def _pow2(n: Any) -> Any:
    return n.trace.node("pow2", n)


def _size(x: Any) -> Any:
    return _select(x < 0, -x, x)


def _with_sign_of(x: Any, size: Any) -> Any:
    return _select(x < 0, -size, size)

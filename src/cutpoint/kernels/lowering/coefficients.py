"""Coefficients of the elementary functions, for each precision.

Double precision: sin, cos and log have the coefficients of fdlibm (Sun Microsystems, 1993), atan those of the Cephes
library (S. L. Moshier).  Single precision: sin, cos and atan have those of Cephes' sinf.c and atanf.c, log those of
e_logf.c, fdlibm's in single precision (I. L. Taylor, Cygnus, 1993).  exp and tanh use Taylor's series, whose remainder
for |r| <= log(2) / 2 is 2 % of an ulp of 1 at degree 13, and 4 % at degree 7.
"""

import math
from typing import NamedTuple

from cutpoint.kernels.graphs.precision import FLOAT32, FLOAT64, Precision


class Coefficients(NamedTuple):
    """Polynomials are given with the highest power first.  Numbers not yet rounded are rounded where they are used.

    Attributes:
        half_pi: positive parts that sum to pi / 2; with a negative part, -0.0 - 0 * part would be 0.0.
        ln2: parts that sum to log(2).
        ln2_short: the same, the first short enough for its product with any exponent to be exact.
        sin: (sin(r) / r - 1) / r**2 by r**2; cos: (cos(r) - 1 + r**2 / 2) / r**4 by r**2.
        exp: (exp(r) - 1 - r) / r**2.
        exp_least, exp_most: below and above these exp is 0 and infinite.
        tanh_most: from here on tanh is 1.
        log: log((1 + s) / (1 - s)) / s - 2 by s**2, times s**2.
        atan_over, atan_under: (atan(t) / t - 1) / t**2 by t**2, as a quotient of polynomials.
        atan_middle: up to here atan uses its argument unreduced.
    """

    precision: Precision
    half_pi: tuple[float, ...]
    ln2: tuple[float, ...]
    ln2_short: tuple[float, ...]
    sin: tuple[float, ...]
    cos: tuple[float, ...]
    exp: tuple[float, ...]
    exp_least: float
    exp_most: float
    tanh_most: float
    log: tuple[float, ...]
    atan_over: tuple[float, ...]
    atan_under: tuple[float, ...]
    atan_middle: float


def _taylor(degree: int) -> tuple[float, ...]:
    return tuple(1 / math.factorial(k) for k in range(degree, 1, -1))


_DOUBLE = Coefficients(
    precision=FLOAT64,
    half_pi=(1.5707963267948966, 6.123233995736765e-17, 1.082856673921914e-32),  # within 2**-160
    ln2=(0.6931471805599453, 2.3190468138462996e-17),
    ln2_short=(6.93147180369123816490e-01, 1.90821492927058770002e-10),
    sin=(
        1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06,
        -1.98412698298579493134e-04, 8.33333333332248946124e-03, -1.66666666666666324348e-01,
    ),
    cos=(
        -1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07,
        2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02,
    ),
    exp=_taylor(13),
    exp_least=-746.0,
    exp_most=710.0,
    tanh_most=22.0,
    log=(
        1.479819860511658591e-01, 1.531383769920937332e-01, 1.818357216161805012e-01, 2.222219843214978396e-01,
        2.857142874366239149e-01, 3.999999999940941908e-01, 6.666666666666735130e-01,
    ),
    atan_over=(
        -8.750608600031904122785e-1, -1.615753718733365076637e1, -7.500855792314704667340e1,
        -1.228866684490136173410e2, -6.485021904942025371773e1,
    ),
    atan_under=(
        1.0, 2.485846490142306297962e1, 1.650270098316988542046e2, 4.328810604912902668951e2,
        4.853903996359136964868e2, 1.945506571482613964425e2,
    ),
    atan_middle=0.66,
)  # fmt: skip

_SINGLE = Coefficients(
    precision=FLOAT32,
    half_pi=(1.570796251296997, 7.549789415861596e-08, 5.390302953474238e-15),  # within 2**-73
    ln2=(0.6931471824645996, -1.9046542121259336e-09),
    ln2_short=(0.6931381225585938, 9.05800061445916e-06),
    sin=(-1.9515295891e-4, 8.3321608736e-3, -1.6666654611e-1),
    cos=(2.443315711809948e-5, -1.388731625493765e-3, 4.166664568298827e-2),
    exp=_taylor(7),
    exp_least=-104.0,
    exp_most=89.0,
    tanh_most=10.0,
    log=(0.24279078841209412, 0.2849878668785095, 0.40000972151756287, 0.6666666269302368),
    atan_over=(8.05374449538e-2, -1.38776856032e-1, 1.99777106478e-1, -3.33329491539e-1),
    atan_under=(1.0,),
    atan_middle=0.4142135623730950,
)

TABLES = {FLOAT64: _DOUBLE, FLOAT32: _SINGLE}

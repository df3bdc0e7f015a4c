"""Elementary functions in machine code against 40 digits."""

import math
from typing import Any

import numpy as np
import pytest
import sympy

import cutpoint
from cutpoint import scalars
from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.lowering.lower import lower

DIGITS = 40
RNG = np.random.default_rng(5)


def both_signs(x: np.ndarray) -> np.ndarray:
    return np.concatenate([x, -x])


def magnitudes(low: float, high: float) -> np.ndarray:
    return both_signs(10 ** RNG.uniform(low, high, 60))


QUARTERS = np.arange(1, 63_000, 997) * (math.pi / 2)
ANGLES = np.concatenate(
    [RNG.uniform(-4, 4, 150), RNG.uniform(-1e5, 1e5, 150), magnitudes(-310, 5), QUARTERS, np.nextafter(QUARTERS, 0)]
)
SINES = np.concatenate([RNG.uniform(-1, 1, 150), magnitudes(-300, 0), both_signs(1 - 10.0 ** -np.arange(1, 16))])
DOMAINS: dict[str, tuple[float, np.ndarray]] = {
    "sin": (2, ANGLES),
    "cos": (2, ANGLES),
    "tan": (4, ANGLES),
    "exp": (1.5, np.concatenate([RNG.uniform(-708, 709, 150), RNG.uniform(-1, 1, 150), magnitudes(-310, 2.8)])),
    "log": (1.5, np.concatenate([RNG.uniform(0.4, 2.5, 150), abs(magnitudes(-307, 308)), [5e-324, 1e-310, 1e308]])),
    "tanh": (4, np.concatenate([RNG.uniform(-1, 1, 150), RNG.uniform(-25, 25, 80), magnitudes(-310, 2)])),
    "atan": (2, np.concatenate([RNG.uniform(-3, 3, 150), magnitudes(-310, 308)])),
    "asin": (
        3,
        np.concatenate([RNG.uniform(-1, 1, 150), magnitudes(-300, 0), both_signs(1 - 10.0 ** -np.arange(1, 16))]),
    ),
    "acos": (
        3,
        np.concatenate([RNG.uniform(-1, 1, 150), magnitudes(-300, 0), both_signs(1 - 10.0 ** -np.arange(1, 16))]),
    ),
}


def kernel(function: str) -> Kernel:
    return compile(lambda x: getattr(scalars, function)(x), x=(), name=function, backend="llvm")


def error_in_ulp(function: str, x: float, y: float) -> float:
    exact = getattr(sympy, function)(sympy.Float(x, DIGITS)).evalf(DIGITS)
    return float(abs(sympy.Float(y, DIGITS) - exact) / sympy.Float(np.spacing(abs(y)), DIGITS))


@pytest.mark.parametrize("function", DOMAINS)
def test_elementary_functions_are_as_accurate_as_they_say(function: str) -> None:
    ulp, points = DOMAINS[function]
    values = kernel(function)(points)
    worst = max(error_in_ulp(function, float(x), float(y)) for x, y in zip(points, values, strict=True))
    assert worst <= ulp


@pytest.mark.parametrize("function", ["sin", "cos", "tan"])
def test_angles_beyond_the_stated_limit_have_no_sine(function: str) -> None:
    found = kernel(function)(both_signs(np.array([1.76e15, 1.77e15, 1e300])))
    assert np.isnan(found).tolist() == [False, True, True] * 2


NAN, INF = math.nan, math.inf
LIMITS: dict[str, list[tuple[float, float]]] = {
    "sin": [(0, 0), (INF, NAN), (-INF, NAN), (1e300, NAN), (-1e300, NAN)],
    "cos": [(0, 1), (INF, NAN), (1e300, NAN)],
    "tan": [(0, 0), (INF, NAN), (1e300, NAN)],
    "exp": [(0, 1), (INF, INF), (-INF, 0), (1e300, INF), (-1e300, 0), (709.78, math.exp(709.78)), (-745, 5e-324)],
    "log": [(1, 0), (0, -INF), (INF, INF), (-1, NAN), (-INF, NAN)],
    "tanh": [(0, 0), (INF, 1), (-INF, -1), (1e300, 1), (-1e300, -1)],
    "atan": [(0, 0), (INF, math.pi / 2), (-INF, -math.pi / 2), (1e300, math.pi / 2)],
    "asin": [(0, 0), (1, math.pi / 2), (-1, -math.pi / 2), (1.5, NAN), (INF, NAN)],
    "acos": [(1, 0), (-1, math.pi), (0, math.pi / 2), (-1.5, NAN), (-INF, NAN)],
}


@pytest.mark.parametrize("function", LIMITS)
def test_elementary_functions_reach_their_limits_without_a_warning(function: str) -> None:
    points, expected = zip(*LIMITS[function], (NAN, NAN), strict=True)
    with np.errstate(all="raise"):
        found = kernel(function)(np.array(points))
    np.testing.assert_allclose(found, expected, rtol=2**-51, atol=0)


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("function", ["sin", "tan", "tanh", "atan"])
def test_odd_functions_are_exactly_odd_at_zero_too(function: str, single: bool) -> None:
    odd = kernel(function).float32 if single else kernel(function)
    points = np.concatenate([DOMAINS[function][1], [0.0, 5e-324]])
    points = points[abs(points) < 1e38]
    assert odd(-points).tobytes() == (-odd(points)).tobytes()
    assert [math.copysign(1, odd(x)) for x in (0.0, -0.0)] == [1, -1]


@pytest.mark.parametrize("function", ["clip", "maximum", "minimum"])
def test_a_bound_hands_on_what_is_not_a_number(function: str) -> None:
    bounds = (-1.0, 1.0) if function == "clip" else (0.5,)
    bounded = compile(lambda x: getattr(cutpoint, function)(x, *bounds), x=(), name=function, backend="llvm")
    points = np.array([NAN, INF, -INF, -1.0, 0.0, 0.5, 0.7, 1.0])
    expected = getattr(np, function)(points, *bounds)
    np.testing.assert_array_equal(bounded(points), expected)
    np.testing.assert_array_equal(getattr(cutpoint, function)(points, *bounds), expected)
    assert math.isnan(getattr(cutpoint, function)(NAN, *bounds))
    assert sum(bounded.operations.values()) == 2 * len(bounds)


def test_sine_and_cosine_share_their_reduction() -> None:
    both = compile(lambda x: [scalars.sin(x), scalars.cos(x)], x=(), backend="llvm")
    assert sum(lower(both.graph).operations.values()) < 1.4 * sum(lower(kernel("sin").graph).operations.values())


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_atan2_is_the_angle_of_a_point_in_every_quadrant(backend: Any) -> None:
    sizes = [0.0, 5e-324, 1e-300, 0.3, 1.0, 2.5, 1e300]
    axis = np.array([*sizes, *(-x for x in sizes[1:])])
    y, x = (each.ravel() for each in np.meshgrid(axis, axis))
    points = compile(cutpoint.atan2, y=(), x=(), backend=backend)
    np.testing.assert_allclose(points(y, x), np.arctan2(y, x), rtol=1e-15, atol=0)
    np.testing.assert_allclose(cutpoint.atan2(y, x), np.arctan2(y, x), rtol=1e-15, atol=0)
    assert np.isnan([points(NAN, 1.0), points(1.0, NAN), points(NAN, -0.0)]).all()
    assert points(2.0, INF) == 0 and points(INF, -3.0) == math.pi / 2

"""Kernels in single precision: the same graph, rounded to float32 throughout."""

import math
from collections import namedtuple
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from emitters import numpy_rows
from running_error import Single
from single_precision import LONG, RNG, ROBOTS, SHAPES, TAME, TINY, batch, every_kind, robot_kernel, robot_rows

import robot_library
from c_builds import assert_same_bits
from cutpoint import InputError, scalars
from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.graphs.replay import replay
from cutpoint.kernels.machine.cache import VARIABLE
from cutpoint.scalars import sin, sqrt, where

LARGEST = float(np.finfo(np.float32).max)


@pytest.fixture(scope="module", params=["llvm", "numpy"])
def kernel(request: pytest.FixtureRequest) -> Kernel:
    return compile(every_kind, q=7, v=(), M=(3, 4), backend=request.param).float32


@pytest.mark.parametrize(("robot", "function"), ROBOTS)
def test_results_are_within_the_running_error_bound_of_single_precision(robot: str, function: str) -> None:
    double = robot_kernel(robot, function)
    rows = [x[[*TAME]] for x in robot_rows(robot, double)]
    machine, array = double.float32(*rows), numpy_rows(double.float32, rows)
    for k, row in enumerate(zip(*rows, strict=True)):
        numbers = [Single(float(x)) for part in row for x in np.ravel(part)]
        expected = replay(double.graph, numbers, Single.constant)
        for found in (machine if isinstance(machine, tuple) else (machine,)), array:
            flat = [float(x) for part in found for x in np.ravel(part[k])]
            for x, bound in zip(flat, expected, strict=True):
                assert abs(x - bound.value) <= bound.error


def test_the_running_error_bound_leaves_half_the_digits_certain() -> None:
    double = robot_kernel("ur10", "inverse_dynamics")
    numbers = [Single(float(x)) for part in robot_rows("ur10", double) for x in part[4]]
    expected = replay(double.graph, numbers, Single.constant)
    largest = max(abs(x.value) for x in expected)
    assert all(x.error < 2.0**-12 * largest for x in expected)


ULPS = {
    "sin": [(1.6, 0, 1e5), (3.2, 1e5, 3.2e6)], "cos": [(1.6, 0, 1e5), (3.2, 1e5, 3.2e6)],
    "tan": [(4, 0, 1e5), (4.9, 1e5, 3.2e6)], "exp": [(1.1, 0, 88.7), (1.1, 0, -103)], "log": [(1, 0, LARGEST)],
    "tanh": [(3, 0, 12), (3, 0, -12)], "atan": [(2.3, 0, LARGEST), (2.3, 0, -LARGEST)],
}  # fmt: skip


@pytest.mark.parametrize("function", ULPS)
def test_elementary_functions_are_as_accurate_as_they_say(function: str) -> None:
    kernel = compile(lambda x: getattr(scalars, function)(x), x=(), name=function, backend="llvm")
    for ulps, low, high in ULPS[function]:
        x = floats_between(low, high)
        exact = kernel(x.astype(float))  # within 4 units of the last of 53 bits
        error = abs(kernel.float32(x) - exact) / np.spacing(abs(exact).astype(np.float32))
        assert error.max() <= ulps, x[error.argmax()]


def floats_between(low: float, high: float) -> np.ndarray:
    """About every thousandth float32 of a range away from zero, none more likely than another; both ends."""
    first, last = (int(np.float32(abs(x)).view(np.uint32)) for x in (low, high))
    x = np.append(RNG.integers(max(first, 1), last, 2**20, dtype=np.uint32), np.uint32(last)).view(np.float32)
    return np.copysign(x, np.float32(high))


NAN, INF = math.nan, math.inf
LIMITS: dict[str, list[tuple[float, float]]] = {
    "sin": [(0, 0), (TINY, TINY), (INF, NAN), (-INF, NAN), (3.3e6, NAN), (-1e30, NAN)],
    "cos": [(0, 1), (INF, NAN), (1e30, NAN)],
    "tan": [(0, 0), (INF, NAN), (1e30, NAN)],
    "exp": [(0, 1), (INF, INF), (-INF, 0), (89, INF), (-104, 0), (1e30, INF), (-1e30, 0), (-103.2, TINY)],
    "log": [(1, 0), (0, -INF), (INF, INF), (-1, NAN), (-INF, NAN), (TINY, -149 * math.log(2))],
    "tanh": [(0, 0), (TINY, TINY), (INF, 1), (-INF, -1), (1e30, 1), (-10, -1)],
    "atan": [(0, 0), (TINY, TINY), (INF, math.pi / 2), (-INF, -math.pi / 2), (1e30, math.pi / 2)],
}


@pytest.mark.parametrize("function", LIMITS)
def test_elementary_functions_reach_their_limits_without_a_warning(function: str) -> None:
    points, expected = zip(*LIMITS[function], (NAN, NAN), strict=True)
    kernel = compile(lambda x: getattr(scalars, function)(x), x=(), name=function, backend="llvm").float32
    with np.errstate(all="raise"):
        found = kernel(np.array(points, np.float32))
    np.testing.assert_allclose(found, expected, rtol=2.0**-22, atol=0)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_constants_are_rounded_once(backend: str) -> None:
    constants = [0.1, 1 + 2.0**-24 + 2.0**-50, -1 / 3, 1e-45, 1e-60, 1e300, -INF, NAN, -0.0, 16777217.0]
    kernel = compile(lambda x: [*constants, *(where(x < 1, c, x) for c in constants)], x=(), backend=backend).float32
    with np.errstate(over="ignore"):
        expected = np.array(constants, np.float32)
    assert_same_bits(kernel(0.0), np.tile(expected, 2))
    assert_same_bits(kernel(np.zeros(LONG))[-1], np.tile(expected, 2))


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_no_operation_keeps_more_digits_than_float32(backend: str) -> None:
    kernel = compile(lambda x, y: [(x + y) - x, x / y * y, sqrt(x) * sqrt(x)], x=(), y=(), backend=backend).float32
    x, y = RNG.uniform(1, 100, (2, 200)).astype(np.float32)
    assert np.array_equal(kernel(x, y)[:, 0], (x + y) - x)
    assert np.array_equal(kernel(x, y)[:, 1], x / y * y)
    assert np.array_equal(kernel(x, y)[:, 2], np.sqrt(x) * np.sqrt(x))


def test_what_is_given_in_other_precisions_is_rounded_without_a_warning(kernel: Kernel) -> None:
    q, v, M = (RNG.normal(size=(5, *shape)) for shape in SHAPES)
    q[0, 0], M[1, 0, 0] = 1e300, 1e-300
    with np.errstate(over="ignore"):
        expected = kernel(*(x.astype(np.float32) for x in (q, v, M)))
    with np.errstate(all="raise"):
        for given in (q, v, M), (q.tolist(), v.tolist(), M.tolist()), (q, v, M.astype(">f8")):
            found = kernel(*given)
            assert found.dtype == np.float32 and np.array_equal(found, expected, equal_nan=True)
    whole = kernel(np.arange(7), 2, np.ones((3, 4), bool))
    assert np.array_equal(whole, kernel(np.arange(7.0), 2.0, np.ones((3, 4))))


def test_what_is_no_real_number_is_refused(kernel: Kernel) -> None:
    q, v, M = (x[0] for x in batch(1))
    with pytest.raises(InputError, match="q holds complex64, but must hold real numbers"):
        kernel(q * 1j, v, M)
    with pytest.raises(InputError, match="v holds <U1, but must hold real numbers"):
        kernel(q, "x", M)
    with pytest.raises(InputError, match=r"q has shape \(6,\): its last axis must be 7"):
        kernel(q[:6], v, M)


def test_results_go_to_arrays_of_either_precision_and_to_no_others(kernel: Kernel) -> None:
    rows = batch(LONG)
    expected = kernel(*rows)
    for dtype in (np.float32, np.float64):
        out = np.empty(expected.shape, dtype)
        assert kernel(*rows, out=out) is out and np.array_equal(out, expected)
    with pytest.raises(InputError, match="out for result is of int64, but must be of floats"):
        kernel(*rows, out=np.empty(expected.shape, int))


def test_an_output_may_be_an_input() -> None:
    kernel = compile(lambda x: [sin(x[0]), x[0] * x[1], x[1] + x[2]], x=3, backend="llvm").float32
    x = RNG.normal(size=(LONG, 3)).astype(np.float32)
    expected = kernel(x)
    kernel(x, out=x)
    assert np.array_equal(x, expected)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_empty_inputs_and_outputs_are_taken(backend: str) -> None:
    Two = namedtuple("Two", "none some")
    kernel = compile(lambda x, e: Two([], [sin(x)]), x=(), e=0, backend=backend).float32
    found = kernel(np.ones(3), np.empty((3, 0)))
    assert found.none.shape == (3, 0) and found.some.shape == (3, 1)
    assert found.none.dtype == found.some.dtype == np.float32


SCALED: dict[str, tuple[Callable[[Any], Any], float, float]] = {
    "a divisor whose inverse is beyond float32": (lambda x: x / 1e-40, 1e-30, 1e10),
    "factors whose product is beyond float32": (lambda x: x * 1e25 * 1e25, 1e-30, 1e20),
    "factors whose product is nothing in float32": (lambda x: x * 1e-30 * 1e-30 * 1e38, 1e38, 1e16),
}


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("name", SCALED)
def test_constants_gather_within_both_precisions_alone(name: str, backend: str) -> None:
    function, x, expected = SCALED[name]
    kernel = compile(function, x=(), backend=backend)
    assert kernel.float32(x) == pytest.approx(expected, rel=1e-5)  # 1e-40 has fewer digits in float32
    assert kernel(x) == pytest.approx(expected, rel=1e-15)


def test_a_kernel_has_one_in_single_precision_and_stays_as_it_was(kernel: Kernel) -> None:
    double = compile(every_kind, q=7, v=(), M=(3, 4), backend=kernel.backend)
    before = double(*batch(1))
    assert double.float32 is double.float32 and double.float32.float32 is double.float32
    assert double(*batch(1)).dtype == before.dtype == np.float64
    assert repr(double.float32).endswith(f"{kernel.backend} in float32>")


def test_code_on_disk_is_kept_for_each_precision(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    double = compile(lambda x: [x[1], x[0]], x=2, backend="llvm")
    x = np.array([1 / 3, 2 / 3])
    for _ in range(2):  # compiled, then found
        again = compile(lambda x: [x[1], x[0]], x=2, backend="llvm")
        assert again(x).tolist() == x[::-1].tolist()
        assert again.float32(x).tolist() == x[::-1].astype(np.float32).tolist()
    assert double(x).dtype == np.float64


def test_a_robots_kernel_computes_in_single_precision() -> None:
    robot = robot_library.MAKERS["ur10"]()
    q, v, a = RNG.normal(size=(3, 100, 6))
    tau = robot.inverse_dynamics(q, v, a)
    found = robot.kernel("inverse_dynamics").float32(q, v, a)
    assert found.dtype == np.float32
    assert abs(found - tau).max() < 2.0**-18 * abs(tau).max()

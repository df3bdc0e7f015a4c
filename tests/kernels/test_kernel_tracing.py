"""Treatment of numbers while a function is traced."""

import gc
import math
from collections.abc import Callable
from dataclasses import make_dataclass
from typing import Any

import numpy as np
import pytest

from cutpoint.errors import TraceError
from cutpoint.kernels import Graph, compile, graph_of
from cutpoint.scalars import Jet, absolute, atan, cos, exp, minimum, sin, tan, tanh, where
from robot_library import assert_close


def results(function: Callable[..., Any]) -> tuple[Any, ...]:
    return graph_of(lambda x, y, z: [*function(x, y, z)], x=(), y=(), z=()).results


def operations(function: Callable[..., Any]) -> dict[str, int]:
    return graph_of(function, x=(), y=()).operations


def test_what_is_known_is_no_operation() -> None:
    known = results(lambda x, y, z: [x * 0, 0 / x, x - x, x / x, x**0, 0.0 * (x + y)])
    assert known == (0.0, 0.0, 0.0, 1.0, 1.0, 0.0)
    same = results(lambda x, y, z: [x, x * 1, 1 * x, x + 0, 0 + x, x - 0, x / 1, x**1, -(0 - x), +x, 2 * x / 2])
    assert len({id(r) for r in same}) == 1


@pytest.mark.parametrize(
    "one, other",
    [
        (lambda x, y: x + y, lambda x, y: y + x),
        (lambda x, y: x * y, lambda x, y: y * x),
        (lambda x, y: x - y, lambda x, y: x + -y),
        (lambda x, y: -(x - y), lambda x, y: y - x),
        (lambda x, y: (-x) * y, lambda x, y: -(y * x)),
        (lambda x, y: (-x) / (-y), lambda x, y: x / y),
        (lambda x, y: -2 * x, lambda x, y: -(x * 2)),
        (lambda x, y: 3 * (2 * x), lambda x, y: x * 6),
        (lambda x, y: x**5, lambda x, y: x * ((x * x) * (x * x))),
        (lambda x, y: x**-2, lambda x, y: 1 / (x * x)),
        (lambda x, y: x**0.5, lambda x, y: x.sqrt()),
        (lambda x, y: sin(-x), lambda x, y: -sin(x)),
        (lambda x, y: cos(-x), lambda x, y: cos(x)),
        (lambda x, y: tan(-x) + tanh(-x) + atan(-x), lambda x, y: -tan(x) - tanh(x) - atan(x)),
        (lambda x, y: abs(x), lambda x, y: absolute(x)),
        (lambda x, y: where(x > y, x, y), lambda x, y: where(y < x, x, y)),
        (lambda x, y: where(~(x < y), x, y), lambda x, y: where(x < y, y, x)),
        (lambda x, y: where((x < y) & True, x, y), lambda x, y: where((x < y) | False, x, y)),
        (lambda x, y: np.float64(2) * x, lambda x, y: x * np.float64(2)),
        (lambda x, y: (np.array([1.0, 2.0]) * x)[1] + y, lambda x, y: 2 * x + y),
        (lambda x, y: (np.eye(2) @ np.array([x, y]))[1], lambda x, y: y),
        (lambda x, y: np.int64(2) * x + np.float32(0.5), lambda x, y: 2 * x + 0.5),
    ],
)
def test_equal_expressions_are_one_node(one: Callable[..., Any], other: Callable[..., Any]) -> None:
    first, second = results(lambda x, y, z: [one(x, y), other(x, y)])
    assert first is second


def test_common_terms_are_computed_once() -> None:
    assert operations(lambda x, y: (x * y + 1) * (y * x + 1)) == {"mul": 2, "add": 1}


def test_a_choice_between_equals_is_no_choice() -> None:
    assert results(lambda x, y, z: [where(x < y, z, z), where(x < y, 1, 1.0), where(x < x, y, z)])[0].op == "input"
    assert results(lambda x, y, z: [where(x < y, 1, 1.0)]) == (1.0,)


def test_additions_are_never_reordered() -> None:
    kernel = compile(lambda x: (x + 2.0**52) - 2.0**52, x=())
    assert kernel(1.3) == 1.0


def test_factors_that_would_underflow_stay_apart() -> None:
    kernel = compile(lambda x: [(x * 1e-200) * 1e-200 * 1e300, x / 1e300], x=())
    assert kernel(1e200) == pytest.approx([1e100, 1e-100], rel=1e-15)
    assert compile(lambda x: x / 1e-320, x=())(5e-321) == 5e-321 / 1e-320


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.float16, np.longdouble, np.int64])
def test_numpys_numbers_stand_on_either_side(kind: type) -> None:
    c = kind(2)
    kernel = compile(lambda x: [where(c < x, c - x, x / c), where(x >= c, c * x, c + x), minimum(c, x)], x=())
    assert kernel(3.0).tolist() == [-1.0, 6.0, 2.0] and kernel(1.0).tolist() == [0.5, 3.0, 1.0]


def test_arrays_of_traced_numbers_are_compared_as_objects() -> None:
    def above(q: list[Any]) -> list[Any]:
        return [where(c, 1.0, 0.0) for c in np.greater(np.array(q), np.ones(2), dtype=object)]

    assert compile(above, q=2)([0.0, 2.0]).tolist() == [0.0, 1.0]
    beyond = compile(lambda q, bound: where(np.less(bound, q, dtype=object), q - bound, 0 * q), q=2, bound=())
    assert beyond([0.0, 2.0], 0.5).tolist() == [0.0, 1.5]
    with pytest.raises(TraceError, match=r"all take arrays, which are compared by np\.less"):
        graph_of(lambda q: [*(np.array(q) < np.ones(2))], q=2)


def test_tracing_leaves_the_garbage_collector_as_it_was() -> None:
    assert gc.isenabled()
    assert graph_of(lambda x: [x, gc.isenabled()], x=()).results[1] == 0.0
    assert gc.isenabled()


REFUSED: dict[str, tuple[Callable[[Any, Any], Any], str]] = {
    "if": (lambda x, y: x if x > y else y, "cutpoint.where(x > 0, yes, no)"),
    "min": (lambda x, y: min(x, y), "cutpoint.where"),
    "and": (lambda x, y: x > 0 and y > 0, "`&`"),
    "truth": (lambda x, y: not x, "truth value"),
    "float": (lambda x, y: float(x), "float()"),
    "int": (lambda x, y: [y][x], "no value"),
    "math": (lambda x, y: math.sin(x), "cutpoint.sin"),
    "numpy's floor": (lambda x, y: np.floor(x), "use it outside the kernel"),
    "numpy function": (lambda x, y: np.tanh(x), "cutpoint.tanh"),
    "renamed numpy function": (lambda x, y: np.arctan(x), "cutpoint.atan"),
    "numpy maximum": (lambda x, y: np.maximum(x, y), "cutpoint.maximum"),
    "unknown numpy function": (lambda x, y: np.cbrt(x), "cutpoint's functions"),
    "numpy array of float": (lambda x, y: np.array([x, y], float), "no value"),
    "equal": (lambda x, y: x == y, "no meaning"),
    "different": (lambda x, y: x != y, "no meaning"),
    "member": (lambda x, y: x in [y], "no meaning"),
    "modulo": (lambda x, y: x % 2, "wrap an angle x with 2 * cutpoint.atan(cutpoint.tan(x / 2))"),
    "power": (lambda x, y: x**1.5, "whole"),
    "traced power": (lambda x, y: x**y, "constant"),
    "to a power": (lambda x, y: 2**x, "exp"),
    "zero division": (lambda x, y: x / 0, "zero"),
    "text": (lambda x, y: x + "1", "str"),
    "nothing": (lambda x, y: None * x, "NoneType"),
    "complex": (lambda x, y: x * 1j, "complex"),
    "condition in where": (lambda x, y: x.where(x, y, x), "comparison"),
    "rounded": (lambda x, y: round(x, 2), "outside the kernel"),
    "floor": (lambda x, y: math.floor(x), "outside the kernel"),
    "bits": (lambda x, y: x >> 1, "whole numbers"),
    "numbers joined": (lambda x, y: x & y, "join conditions"),
    "sum of conditions": (lambda x, y: (x < y) + 1, "cutpoint.where(condition, 1.0, 0.0)"),
    "number times condition": (lambda x, y: x * (x < y), "cutpoint.where(condition, 1.0, 0.0)"),
    "while": (lambda x, y: next(y for _ in iter(lambda: bool(x < y), False)), "a constant number of passes"),
    "counted conditions": (lambda x, y: sum([x < y, x < 0]), "cutpoint.where(condition, 1.0, 0.0)"),
    "condition joined with number": (lambda x, y: (x < y) & x, "join conditions"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_compiled_points_at_the_users_line(case: str) -> None:
    function, remedy = REFUSED[case]
    with pytest.raises(TraceError) as caught:
        graph_of(function, x=(), y=())
    assert caught.value.place == f"{__file__}:{function.__code__.co_firstlineno}"
    assert remedy in str(caught.value) and caught.value.place in str(caught.value)


@pytest.mark.parametrize(
    "function",
    [
        np.linalg.inv,
        lambda a: np.arcsin(np.array(a)),
        lambda a: np.hypot(np.array(a), 1.0),
        lambda a: np.std(np.array(a)),
        lambda a: np.isnan(np.array(a)),
        lambda a: (a[0][0] < 1) ^ (a[1][1] < 1),
        lambda a: np.logical_and(a[0][0] < 1, a[1][1] < 1),
    ],
)
def test_what_numpy_or_python_cannot_compute_is_named(function: Callable[..., Any]) -> None:
    with pytest.raises(TraceError, match=r"^\w+: this cannot be computed with traced numbers \(.*\); (write|use) "):
        graph_of(function, a=(2, 2))


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_what_is_told_to_write_for_isfinite_tells_numbers_apart(backend: Any) -> None:
    with pytest.raises(TraceError, match=r"np.isfinite .*; write cutpoint.absolute\(x\) < 1e30"):
        graph_of(lambda x: np.isfinite(x), x=())
    is_finite = compile(lambda x: where(absolute(x) < 1e30, 1.0, 0.0), backend=backend, x=())
    assert is_finite([0.0, -3.0, np.inf, -np.inf, np.nan]).tolist() == [1.0, 1.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize(
    "function",
    [
        lambda q, v: q + v,
        lambda q, v: 2 * q - v / 3,
        lambda q, v: q @ v,
        lambda q, v: np.outer(q, v)[1:] @ np.array([1.0, 2.0, 3.0]),
        lambda q, v: (q * v).sum() + len(q),
        lambda q, v: [*q, *v[::-1]],
    ],
)
def test_inputs_are_arrays_in_the_function_too(function: Callable[..., Any], backend: Any) -> None:
    q, v = np.array([[0.3, -2.0, 5.0], [1.5, 0.25, -7.0]])
    assert_close(compile(function, backend=backend, q=3, v=3)(q, v), function(q, v), 1e-14)


def test_errors_of_a_users_own_stay_as_they_are() -> None:
    with pytest.raises(TypeError, match="can only concatenate list"):
        graph_of(lambda x: [*x] + 1, x=3)


def known(x: Any) -> Any:
    """Conditions that are known when traced, which Python's ~, & and | make whole numbers of."""
    yes, no = ~(x < x), ~(x - x < 1)
    outcomes = [where(c, 1, 0) for c in (yes, no, yes & no, yes | no, ~yes, ~no, no | True, yes & True)]
    return [*outcomes, where((x < 0) | yes, 1, 0), where((x < 0) & no, 1, 0), where((x < 5) & yes, x, 7)]


@pytest.mark.filterwarnings("ignore:Bitwise inversion")
@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_conditions_that_are_known_hold_or_do_not(backend: str) -> None:
    assert compile(known, backend=backend, x=())(3.0).tolist() == [1, 0, 0, 1, 0, 1, 1, 1, 1, 0, 3.0]


def test_a_whole_number_is_no_condition() -> None:
    with pytest.raises(TraceError, match="condition of where must be a comparison, not a int"):
        graph_of(lambda x: where(2, x, 0.0), x=())


@pytest.mark.parametrize("one", [lambda x: np.array(x), lambda x: np.squeeze(np.array([x])), lambda x: np.array(2.0)])
def test_arrays_without_axes_are_numbers(one: Callable[..., Any]) -> None:
    assert compile(one, x=())(np.array(2.0)).shape == ()
    assert graph_of(one, x=()).outputs[0].shape == ()


def test_numpys_arctan_of_arrays_is_ours() -> None:
    found = compile(lambda x: [np.arctan(np.array(x)), atan(np.array(x))], x=3)([0.0, 1.0, -2.0])
    np.testing.assert_allclose(found, np.arctan([[0.0, 1.0, -2.0]] * 2), rtol=1e-15)


@pytest.mark.parametrize(
    ("fields", "complaint"),
    [([], "law: the Found that it returns has no fields"), (["_x"], "law: output '_x' needs another name")],
)
def test_a_record_that_is_no_kernels_is_refused(fields: list[str], complaint: str) -> None:
    Found = make_dataclass("Found", fields)

    def law(x: Any) -> Any:
        return Found(*[x] * len(fields))

    with pytest.raises(TraceError, match=f"^{complaint}"):
        graph_of(law, x=())


def test_an_angle_is_wrapped_as_the_error_says() -> None:
    turns = np.linspace(-20.0, 20.0, 1001)
    found = compile(lambda x: 2 * atan(tan(x / 2)), x=())(turns)
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * turns), rtol=0, atol=1e-14)
    assert (abs(found) <= math.pi).all()


def test_numbers_of_two_traces_do_not_meet() -> None:
    leaked: list[Any] = []
    graph_of(lambda x: leaked.append(x) or x, x=())
    with pytest.raises(TraceError, match="two traces"):
        graph_of(lambda y: y + leaked[0], y=())
    with pytest.raises(TraceError, match="another trace"):
        graph_of(lambda y: [y, leaked[0]], y=())
    with pytest.raises(TraceError, match="kept and used after"):
        leaked[0] * leaked[0]


def test_traced_numbers_serve_as_keys_by_identity() -> None:
    graph = graph_of(lambda x, y: [{x: 1, y: 2, exp(x): 3}[y], x in {x, y}, exp(x) in {x, y}], x=(), y=())
    assert graph.results == (2.0, 1.0, 0.0)


@pytest.mark.parametrize("what", [None, "text", object(), {"a": 1}, [1, [2]]])
def test_a_function_must_return_numbers(what: Any) -> None:
    with pytest.raises(TraceError, match="output 'result'"):
        graph_of(lambda x: what, x=())


def test_a_jet_of_traced_numbers_is_a_jet() -> None:
    def function(x: Any, v: Any, a: Any) -> Any:
        jet = Jet(x, v, a)
        kept = where(jet < x + 1, x * sin(jet) + x - jet, v)
        return [kept.derivative(k) for k in range(3)]

    found = compile(function, x=(), v=(), a=())(0.3, 2.0, -1.0)
    s, c = math.sin(0.3), math.cos(0.3)
    expected = [0.3 * s, 0.3 * c * 2 - 2, 0.3 * (-s * 4 - c) + 1]
    assert found == pytest.approx(expected, rel=1e-14)


def test_a_condition_is_no_output() -> None:
    with pytest.raises(TraceError, match=r"Condition; .* write cutpoint.where\(condition, 1.0, 0.0\)"):
        graph_of(lambda x: x < 1, x=())


def test_the_graph_lists_operands_before_users() -> None:
    graph = graph_of(lambda x, y: [sin(x * y) + x, cos(y) / (x + 2)], x=(), y=())
    seen: set[int] = set()
    for node in graph.nodes:
        assert all(a.serial in seen for a in node.args if hasattr(a, "serial"))
        seen.add(node.serial)
    assert [n.op for n in graph.nodes] == [n.op for n in again(graph)]


def again(graph: Graph) -> Any:
    return graph_of(lambda x, y: [sin(x * y) + x, cos(y) / (x + 2)], x=(), y=()).nodes

"""Derivatives of traced functions: exact for every operation, whatever the way through the chain rule."""

import operator
from collections import namedtuple
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st
from running_error import EPS, Bounded

from cutpoint import scalars
from cutpoint.errors import InputError, TraceError
from cutpoint.kernels import Graph, compile, graph_of, jacobian_of
from cutpoint.kernels.graphs import elimination, slopes
from cutpoint.kernels.graphs.elimination import Order, Web, cheapest_first, forward, reverse
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.scalars import Jet, atan, cos, exp, log, sin, sqrt, tan, tanh, where

ORDERS = (forward, reverse, cheapest_first)
BACKENDS = ("llvm", "numpy")
FINITE = st.floats(-3, 3)
DIGITS = 40

every_order = pytest.mark.parametrize("order", ORDERS)

# every operation, with SymPy as the oracle

ANY = [0.0, 1e-300, -1e-12, 1e-3, 0.7, -2.5, 31.0, -1e5]
POSITIVE = [1e-300, 1e-12, 1e-3, 0.7, 2.5, 1e5, 1e300]
AWAY_FROM_ZERO = [1e-100, -1e-12, 0.7, -2.5, 1e5, -1e100]
MODERATE = [0.0, 1e-300, -1e-12, 1e-3, 0.7, -2.5, 9.0]

OPERATIONS: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any], list[float]]] = {
    "add": (lambda x: x + x * x, lambda x: x + x * x, ANY),
    "sub": (lambda x: x - x * x, lambda x: x - x * x, ANY),
    "neg": (lambda x: -(x * x), lambda x: -(x * x), ANY),
    "mul": (lambda x: (x + 1) * x * 3, lambda x: (x + 1) * x * 3, ANY),
    "div": (lambda x: (x - 3) / (x * x + 1), lambda x: (x - 3) / (x * x + 1), MODERATE),
    "div of a constant": (lambda x: 3 / x, lambda x: 3 / x, AWAY_FROM_ZERO),
    "sqrt": (sqrt, sympy.sqrt, POSITIVE),
    "sin": (sin, sympy.sin, ANY),
    "cos": (cos, sympy.cos, ANY),
    "tan": (tan, sympy.tan, ANY),
    "exp": (exp, sympy.exp, [*MODERATE, -700.0, 700.0]),
    "log": (log, sympy.log, POSITIVE),
    "tanh": (tanh, sympy.tanh, MODERATE),
    "atan": (atan, sympy.atan, [*ANY, 1e200]),
    "select": (lambda x: where(x < 0.5, x * x, 3 * x), lambda x: sympy.Piecewise((x * x, x < 0.5), (3 * x, True)), ANY),
}


def exact_slope(written: Callable[[Any], Any], x: float) -> tuple[float, float]:
    """d written / dx with 40 digits, and the size of what is added up to make it: 1 - tanh^2 may be far below 1."""
    symbol = sympy.Symbol("x", real=True)
    expression = sympy.diff(written(symbol), symbol)
    at = sympy.Float(x, DIGITS)
    terms = sympy.Add.make_args(sympy.expand(expression)) if not expression.has(sympy.Piecewise) else [expression]
    slope, *sizes = (term.subs(symbol, at).evalf(DIGITS) for term in (expression, *terms))
    return float(slope), float(sum(abs(size) for size in sizes))


def assert_exact(name: str, backend: str = "llvm") -> None:
    traced, written, points = OPERATIONS[name]
    found = compile(jacobian_of(lambda x: traced(x)), x=(), backend=backend)(np.array(points)).d_result_d_x
    for x, y in zip(points, found, strict=True):
        slope, size = exact_slope(written, x)
        # at most 8 roundings of what is added up, elementary functions within 4 units in the last place
        assert abs(y - slope) <= 16 * EPS * size, f"{name} at {x}: {y}, exactly {slope}"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", OPERATIONS)
def test_every_operation_has_its_exact_slope(name: str, backend: str) -> None:
    assert_exact(name, backend)


def test_every_operation_of_graphs_is_among_them() -> None:
    assert {*slopes._RULES, "select"} == {name.split()[0] for name in OPERATIONS}


OPERANDS = [(name, k) for name in slopes._RULES for k in range(2 if name in ("add", "sub", "mul", "div") else 1)]


@pytest.mark.parametrize(("name", "operand"), OPERANDS)
def test_a_wrong_sign_in_any_rule_is_caught(name: str, operand: int, monkeypatch: pytest.MonkeyPatch) -> None:
    right = slopes._RULES[name]

    def wrong(y: Any, *operands: Any) -> list[Any]:
        return [-slope if k == operand else slope for k, slope in enumerate(right(y, *operands))]

    monkeypatch.setitem(slopes._RULES, name, wrong)
    with pytest.raises(AssertionError):
        assert_exact(name)


def test_exchanged_sides_of_a_choice_are_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    right = slopes.local_slopes
    monkeypatch.setattr(elimination, "local_slopes", lambda x: right(x)[:1] + right(x)[:0:-1])
    with pytest.raises(AssertionError):
        assert_exact("select")


# random functions, with jets as the oracle

_FORMS: dict[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv, "neg": operator.neg,
    "lt": operator.lt, "le": operator.le, "and": operator.and_, "or": operator.or_, "not": operator.invert,
    "select": where,
}  # fmt: skip


def bounded(graph: Graph, x: tuple[float, ...]) -> list[Bounded]:
    """The graph's results, each with a bound on its rounding error."""
    values: dict[int, Any] = {}

    def value(y: Any) -> Any:
        return values[y.serial] if isinstance(y, Node) else y

    for node in graph.nodes:
        form = _FORMS.get(node.op) or getattr(scalars, node.op, None)
        values[node.serial] = Bounded(x[node.args[0]]) if node.op == "input" else form(*map(value, node.args))
    return [y if isinstance(y, Bounded) else Bounded(y) for y in map(value, graph.results)]


def by_jets(function: Callable[[list[Any]], list[Any]], x: list[Any]) -> list[list[Any]]:
    """The Jacobian, column by column from jets along each input."""
    along = [function([Jet(y, int(j == k)) for j, y in enumerate(x)]) for k in range(len(x))]
    return [[y.derivative(1) if isinstance(y, Jet) else 0.0 for y in row] for row in zip(*along, strict=True)]


@given(st.lists(steps, min_size=1, max_size=25), st.tuples(FINITE, FINITE, FINITE))
@settings(deadline=None, max_examples=60)
def test_every_order_gives_what_jets_give(recipe: list[Step], x: tuple[float, ...]) -> None:
    def function(x: Any) -> Any:
        return cook(recipe, x)

    def all_ways(x: Any) -> Any:
        return [*(jacobian_of(function, orders=[order])(x=x).d_result_d_x for order in ORDERS), by_jets(function, x)]

    found = bounded(graph_of(all_ways, x=3), x)
    size = len(found) // (len(ORDERS) + 1)
    *ours, jets = (found[k : k + size] for k in range(0, len(found), size))
    for way in ours:
        for y, expected in zip(way, jets, strict=True):
            assert abs(y.value - expected.value) <= y.error + expected.error


# choices

CORNERS: dict[str, tuple[Callable[[Any], Any], float, float]] = {
    "root of zero": (lambda x: where(x > 0, sqrt(x), x), 0.0, 1.0),
    "pole": (lambda x: where(x * x > 0, sin(x) / x, 1 - x * x / 6), 0.0, 0.0),
    "logarithm of what is negative": (lambda x: where(x > 0, x * log(x), 2 * x), -1.0, 2.0),
    "overflow": (lambda x: where(x < 100, exp(exp(x)), x), 1e3, 1.0),
    "root used in two choices": (lambda x: where(x > 0, sqrt(x), x) + where(x > -1, 3 * x, sqrt(x)), 0.0, 4.0),
    "root behind either of two choices": (
        lambda x: where(x > 0, sqrt(x), x) + where(x > 1, 2 * sqrt(x), x * x), 0.0, 1.0,
    ),
    "nested": (lambda x: where(x < 1, where(x < 0, sqrt(-x), 5 * x), log(x - 1)), 0.5, 5.0),
    "contradiction": (lambda x: where(x < 1, where(x < 1, 5 * x, log(x - 1)), 0), 0.5, 5.0),
    "constant side": (lambda x: where(x < 1, 3.0, x * x), 2.0, 4.0),
    "kink": (lambda x: abs(x) * 2, 0.0, 2.0),
    "cancelled": (lambda x: ((sin(x) + 3) - sin(x)) * x, 2.0, 3.0),
    "behind a product": (lambda x: x * where(x > 1, sqrt(x - 1), 2 * x), 1.0, 4.0),
}  # fmt: skip


@every_order
@pytest.mark.parametrize("case", CORNERS)
def test_the_side_not_chosen_never_spoils_a_derivative(case: str, order: Order) -> None:
    function, x, slope = CORNERS[case]
    for backend in BACKENDS:
        kernel = compile(jacobian_of(lambda x: function(x), orders=[order]), x=(), backend=backend)
        assert kernel(x).d_result_d_x == pytest.approx(slope, rel=1e-15, abs=0)


def test_a_choice_costs_one_choice() -> None:
    graph = graph_of(jacobian_of(lambda x: where(x < 1, x * x, 3 * sin(x))), x=())
    assert graph.operations == {"lt": 1, "add": 1, "cos": 1, "mul": 1, "select": 1}
    never = graph_of(jacobian_of(CORNERS["contradiction"][0]), x=())
    assert never.operations == {"lt": 1, "select": 1}


# cost


def operations(function: Callable[..., Any], **inputs: Any) -> int:
    return sum(graph_of(function, **inputs).operations.values())


def test_what_does_not_depend_costs_nothing() -> None:
    separate = jacobian_of(lambda x: [sin(y) for y in x])
    assert graph_of(separate, x=50).operations == {"cos": 50}
    linear = jacobian_of(lambda x: [3 * x[0] - x[1] / 2, x[1] + 4])
    assert graph_of(linear, x=2).results == (3.0, -0.5, 0.0, 1.0)


def test_a_gradient_costs_at_most_three_times_its_function() -> None:
    def function(x: Any) -> Any:
        product = x[0]
        for y in x[1:]:
            product = product * y
        return product

    n = 40
    assert operations(jacobian_of(function), x=n) <= 3 * operations(function, x=n)
    assert operations(jacobian_of(function, orders=[forward]), x=n) > 10 * operations(function, x=n)


def test_many_results_of_one_input_go_forward() -> None:
    def function(x: Any) -> Any:
        values = [sin(x)]
        for _ in range(30):
            values.append(values[-1] * x)
        return values

    assert operations(jacobian_of(function), x=()) <= 3 * operations(function, x=())
    assert operations(jacobian_of(function, orders=[reverse]), x=()) > 5 * operations(function, x=())


@given(st.lists(steps, min_size=1, max_size=25))
@settings(deadline=None, max_examples=30)
def test_the_cheapest_order_is_kept(recipe: list[Step]) -> None:
    def function(x: Any) -> Any:
        return cook(recipe, x)

    each = [operations(jacobian_of(function, orders=[order]), x=3) for order in ORDERS]
    assert operations(jacobian_of(function), x=3) == min(each)


@given(st.lists(steps, min_size=1, max_size=25))
@settings(deadline=None, max_examples=20)
def test_cheapest_first_always_takes_what_takes_the_fewest_products(recipe: list[Step]) -> None:
    def eliminate(x: Any) -> Any:
        web = Web(cook(recipe, x), x)
        for number in cheapest_first(web):
            assert web.cost(number) == min(web.cost(other) for other in web.inner if other in web.slopes)
            web.eliminate(number)
        assert not {*web.inner} & {*web.slopes}
        return x

    graph_of(eliminate, x=3)


def test_of_a_large_function_only_the_promising_order_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elimination, "MANY_PRODUCTS", 10)

    def narrowing(x: Any) -> Any:
        return sin(sum((y * y for y in x), 0))

    def widening(x: Any) -> Any:
        return [sin(x * x) * k for k in range(2, 20)]

    for function, shape, order in ((narrowing, 20, reverse), (widening, (), forward)):
        chosen, alone = (graph_of(jacobian_of(function, orders=orders), x=shape) for orders in (None, [order]))
        assert chosen.fingerprint() == alone.fingerprint()


def test_the_same_function_gives_the_same_graph() -> None:
    def function(x: Any) -> Any:
        return [sin(x[0] * x[1]) / x[2], where(x[0] < x[1], x[2], exp(x[0])) * x[1]]

    first, second = (graph_of(jacobian_of(function), x=3) for _ in range(2))
    assert [node.op for node in first.nodes] == [node.op for node in second.nodes]
    assert first.fingerprint() == second.fingerprint()


# the public face

Pair = namedtuple("Pair", "torque power")


def pair(q: Any, k: Any) -> Pair:
    return Pair([q[0] * k, sin(q[1]), 2.0], q[0] * q[1])


def test_outputs_are_named_and_shaped_by_the_pairs() -> None:
    kernel = compile(jacobian_of(pair), q=2, k=())
    found = kernel([[2.0, 0.0]] * 5, 3.0)
    assert found._fields == ("d_torque_d_q", "d_torque_d_k", "d_power_d_q", "d_power_d_k")
    assert [x.shape for x in found] == [(5, 3, 2), (5, 3), (5, 2), (5,)]
    assert found.d_torque_d_q[0].tolist() == [[3.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
    assert (found.d_torque_d_k[0].tolist(), found.d_power_d_q[0].tolist()) == ([2.0, 0.0, 0.0], [0.0, 2.0])
    assert kernel.name == "jacobian_of_pair"


def test_outputs_and_inputs_are_chosen_by_name() -> None:
    found = compile(jacobian_of(pair, of=["power"], with_respect_to=["k", "q"]), q=2, k=())([2.0, 0.0], 3.0)
    assert found._fields == ("d_power_d_k", "d_power_d_q")
    matrix = compile(jacobian_of(lambda M: [M[0][1] * M[1][0]]), M=(2, 2))([[1.0, 2.0], [3.0, 4.0]])
    assert matrix.d_result_d_M.tolist() == [[[0.0, 3.0], [2.0, 0.0]]]


def test_inputs_and_outputs_may_be_empty() -> None:
    found = compile(jacobian_of(lambda x, y: [y, y * y]), x=0, y=())(np.empty(0), 3.0)
    assert (found.d_result_d_x.shape, found.d_result_d_y.tolist()) == ((2, 0), [1.0, 6.0])
    for size in (0, 2):
        assert compile(jacobian_of(lambda x: []), x=size)(np.ones(size)).d_result_d_x.shape == (0,)


def test_second_derivatives_are_derivatives_of_derivatives() -> None:
    hessian = compile(jacobian_of(jacobian_of(lambda x: exp(x[0]) * sin(x[1]))), x=2)
    a, b = 0.3, 1.1
    expected = np.exp(a) * np.array([[np.sin(b), np.cos(b)], [np.cos(b), -np.sin(b)]])
    np.testing.assert_allclose(hessian([a, b]).d_d_result_d_x_d_x, expected, rtol=1e-14)


def test_within_a_traced_function_it_takes_intermediate_numbers_and_constants() -> None:
    def slope(x: Any, y: Any) -> Any:
        return jacobian_of(lambda x, y: x * x * y, with_respect_to=["x"])(x=x, y=y)[0]

    kernel = compile(lambda a: [slope(sin(a), 3.0), slope(2.0, a), slope(a, a), slope(-a, 2 * a)], a=())
    np.testing.assert_allclose(kernel(0.4), [6 * np.sin(0.4), 1.6, 2 * 0.16, -4 * 0.16], rtol=1e-15)
    chosen = compile(lambda a: jacobian_of(lambda x, y: where((x > 1) | ~(y < 0), x, y))(x=2.0, y=a), a=())
    assert chosen(-1.0) == (1.0, 0.0)
    negated = compile(lambda a: jacobian_of(lambda x, y: where((x > 1) & ~(y < 0), x, y))(x=a, y=2.0), a=())
    assert [negated(a) for a in (2.0, 0.0)] == [(1.0, 0.0), (0.0, 1.0)]


def test_what_a_function_closes_over_is_constant() -> None:
    def outer(q: Any, k: Any) -> Any:
        return jacobian_of(lambda q: k * q * q)(q=q).d_result_d_q

    assert compile(outer, q=(), k=())(2.0, 5.0) == 20.0


def test_unknown_names_list_those_that_there_are() -> None:
    with pytest.raises(InputError, match=r"no output is named 'force'; there are: 'torque', 'power'"):
        graph_of(jacobian_of(pair, of=["force"]), q=2, k=())
    with pytest.raises(InputError, match=r"no input is named 'v'; there are: 'q', 'k'"):
        graph_of(jacobian_of(pair, with_respect_to=["v"]), q=2, k=())
    with pytest.raises(InputError, match=r"^jacobian_of: orders must be functions of .* got 'reverse'"):
        jacobian_of(pair, orders="reverse")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"jacobian_of_pair: its parameters are not the inputs \['q'\]"):
        graph_of(jacobian_of(pair), q=2)


def test_two_derivatives_of_one_name_are_refused() -> None:
    record = namedtuple("record", "a a_d_b")
    with pytest.raises(InputError, match=r"^jacobian_of: two derivatives would be named 'd_a_d_b_d_q'; rename"):
        compile(jacobian_of(lambda q, b_d_q: record(q + b_d_q, b_d_q * q)), q=(), b_d_q=())


def test_without_a_trace_it_says_so() -> None:
    with pytest.raises(TraceError, match=r"jacobian_of pair is called without a traced number; compile it"):
        jacobian_of(pair)(q=[1.0, 2.0], k=3.0)


def test_results_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(TraceError, match=r"output 'result' holds a str"):
        graph_of(jacobian_of(lambda x: ["x"]), x=())
    with pytest.raises(TraceError, match=r"an output is ragged"):
        graph_of(jacobian_of(lambda x: [x, [x]]), x=())

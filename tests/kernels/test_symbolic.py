"""SymPy: expressions that one can read, exact, and those that mechanics on paper gives."""

from collections import namedtuple
from typing import Any

import numpy as np
import pytest
import sympy
from graph_recipes import ONE

import cutpoint
from cutpoint import InputError, Robot
from cutpoint.kernels import compile
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from cutpoint.scalars import where


def symbols(names: str) -> Any:
    return sympy.symbols(names)


def test_expressions_are_written_as_on_paper() -> None:
    q_0, q_1, M_1_2, k = symbols("q_0 q_1 M_1_2 k")
    kernel = compile(lambda q, M, k: [cutpoint.sin(q[0]) * k / 2 - q[1], 0.1 * M[1][2], 3], q=2, M=(2, 3), k=())
    paper = sympy.Matrix([sympy.sin(q_0) * k / 2 - q_1, sympy.Float(0.1) * M_1_2, 3])
    assert kernel.to_sympy() == paper and str(kernel.to_sympy()[0]) == "k*sin(q_0)/2 - q_1"


@pytest.mark.parametrize("name", ["sin", "cos", "tan", "exp", "log", "tanh", "atan", "sqrt"])
def test_elementary_functions_are_sympys_own(name: str) -> None:
    kernel = compile(lambda x: getattr(cutpoint.scalars, name)(x), x=())
    assert kernel.to_sympy() == getattr(sympy, name)(sympy.Symbol("x"))


def test_a_choice_is_piecewise() -> None:
    x, y = symbols("x y")
    found = compile(lambda x, y: where((x < 1) & ~(y <= x), x, -y), x=(), y=()).to_sympy()
    assert isinstance(found, sympy.Piecewise)
    for a, b in ((0, 1), (0, -1), (2, 3), (-1, -1)):
        assert found.subs({x: a, y: b}) == (a if a < 1 and b > a else -b)


@pytest.mark.parametrize("steps", [False, True])
def test_outputs_keep_their_names_and_shapes(steps: bool) -> None:
    record = namedtuple("record", "number vector matrix block nothing")

    def function(x: Any) -> Any:
        return record(x[0], x, [x, x], [[[x[0]]], [[x[1]]]], [])

    made = compile(function, x=2).to_sympy(steps=steps)
    found = made[1] if steps else made
    assert found._fields == record._fields
    assert found.number == sympy.Symbol("x_0") and found.vector.shape == (2, 1) and found.matrix.shape == (2, 2)
    assert found.block.shape == (2, 1, 1) and found.nothing.shape == (0, 1)


@pytest.mark.parametrize("value", [0.1, -2.5, 1 / 3, 1e300, 5e-324, 2.0**60, 1e-8, 7.0])
def test_constants_keep_every_digit(value: float) -> None:
    found = compile(lambda x: [x, value], x=()).to_sympy()[1]
    assert float(found) == value and sympy.Rational(found) == sympy.Rational(*value.as_integer_ratio())


def test_what_is_not_finite_stays_so() -> None:
    found = compile(lambda x: [x, float("inf"), -float("inf"), float("nan")], x=()).to_sympy()
    assert [*found[1:]] == [sympy.oo, -sympy.oo, sympy.nan]


@pytest.mark.parametrize("name", ONE)
def test_steps_put_in_place_are_the_expressions(name: str) -> None:
    kernel = compile(lambda x: [ONE[name](x * x + 1) * x, ONE[name](x * x + 1) - x], x=())
    steps, found = kernel.to_sympy(steps=True)
    for symbol, expression in reversed(steps):
        found = found.subs(symbol, expression)
    for at in (-0.3, 0.7):
        ours, plain = (sympy.Matrix(m).subs("x", at).evalf(30) for m in (found, kernel.to_sympy()))
        assert all(abs(a - b) < 1e-25 for a, b in zip(ours, plain, strict=True))


def test_steps_use_each_other_in_order_and_spare_the_names_of_inputs() -> None:
    def function(s: Any) -> Any:
        for _ in range(40):  # written out, this would have 2**40 terms
            s = [cutpoint.sin(s[0]) + s[0] * s[0]]
        return s[0]

    steps, found = compile(function, s=1).to_sympy(steps=True)
    known = {sympy.Symbol("s_0")}
    for symbol, expression in steps:
        assert expression.free_symbols <= known and symbol not in known
        known.add(symbol)
    assert found.free_symbols <= known and len(steps) == 39


def two_joint_arm() -> Robot:
    """Two joints about y, links along z with their centroids in between, in whole numbers and eighths."""
    links = [Link("base"), Link("upper", 3.0, np.array([0, 0, 0.25]), np.diag([0.5, 0.125, 0.5])),
             Link("fore", 2.0, np.array([0, 0, 0.5]), np.diag([0.25, 0.0625, 0.25]))]  # fmt: skip
    at = np.eye(4)
    at[2, 3] = 0.5
    axis = np.array([0.0, 1.0, 0.0])
    joints = [Joint("shoulder", "continuous", "base", "upper", axis=axis),
              Joint("elbow", "continuous", "upper", "fore", axis=axis, placement=at)]  # fmt: skip
    return Robot(build("arm", links, joints)).with_gravity([0.0, 0.0, -10.0])


def lagrange_torques() -> Any:
    """The same arm by Lagrange's equations: lengths m, masses kg, moments of inertia kg m2, gravity 10 m/s2."""
    t, half = sympy.Symbol("t"), sympy.Rational(1, 2)
    q = [sympy.Function(f"q{k}")(t) for k in range(2)]
    first = sympy.Matrix([sympy.sin(q[0]), sympy.cos(q[0])])
    second = sympy.Matrix([sympy.sin(q[0] + q[1]), sympy.cos(q[0] + q[1])])
    centroids = (first / 4, first / 2 + second / 2)
    masses, moments, angles = (3, 2), (sympy.Rational(1, 8), sympy.Rational(1, 16)), (q[0], q[0] + q[1])
    kinetic = sum(
        half * m * c.diff(t).dot(c.diff(t)) + half * i * angle.diff(t) ** 2
        for m, c, i, angle in zip(masses, centroids, moments, angles, strict=True)
    )
    potential = sum(10 * m * c[1] for m, c in zip(masses, centroids, strict=True))
    lagrangian = kinetic - potential
    torques = [lagrangian.diff(x.diff(t)).diff(t) - lagrangian.diff(x) for x in q]
    names = {x.diff(t, n): sympy.Symbol(f"{'qva'[n]}_{k}") for n in (2, 1) for k, x in enumerate(q)}
    places = {x: sympy.Symbol(f"q_{k}") for k, x in enumerate(q)}
    return sympy.Matrix([torque.subs(names).subs(places) for torque in torques])


def test_torques_of_a_two_joint_arm_are_those_of_lagranges_equations() -> None:
    arm = two_joint_arm()
    arm.inverse_dynamics(*np.zeros((3, 2)))
    ours, theirs = arm.kernel("inverse_dynamics").to_sympy(), lagrange_torques()
    assert sympy.simplify(sympy.expand_trig(ours - theirs)) == sympy.zeros(2, 1)
    assert theirs.free_symbols == set(symbols("q_0 q_1 v_0 v_1 a_0 a_1"))


def test_two_numbers_of_one_symbol_are_refused() -> None:
    kernel = compile(lambda q, q_0: [q[0], q_0], q=1, q_0=(), name="law")
    with pytest.raises(InputError, match="law: 'q_0' would be the symbol for two inputs: rename one"):
        kernel.to_sympy()


@pytest.mark.parametrize(("method", "package"), [("to_sympy", "sympy"), ("to_jax", "jax")])
def test_a_missing_extra_is_named(method: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = compile(lambda x: x * 2, x=())

    def without(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr("cutpoint.kernels.kernel.import_module", without)
    with pytest.raises(InputError, match=rf'{method} needs {package}: pip install "cutpoint\[{package}\]"'):
        getattr(kernel, method)()

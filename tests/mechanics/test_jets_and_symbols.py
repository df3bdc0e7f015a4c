"""The equations on other scalars: time jets against exact derivatives, SymPy symbols against compiled kernels."""

from functools import reduce
from operator import add, mul, sub, truediv
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from cutpoint import definitions, scalars
from cutpoint.control import Feedforward, Measurement, Reference
from cutpoint.errors import InputError
from cutpoint.scalars import Jet
from robot_library import Array, Robot, assert_close, derivative, robot, tree, vectors

FUNCTIONS = ("sin", "cos", "tan", "exp", "log", "tanh", "sqrt", "atan", "asin", "acos")
TIME = sympy.Symbol("t")
PATH = sympy.Rational(7, 10) + TIME / 3 - TIME**2 / 5 + TIME**3 / 7 + TIME**4 / 11
OTHER = sympy.Rational(3, 2) - TIME / 2 + TIME**2 / 3 + TIME**3 / 5 - TIME**4 / 13


def jet(expression: Any, order: int = 4) -> Jet:
    return Jet(*(float(expression.diff(TIME, k).subs(TIME, 0)) for k in range(order + 1)))


def derivatives(x: Jet) -> list[float]:
    return [x.derivative(k) for k in range(len(x.derivatives))]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_of_jets_have_the_derivatives_that_sympy_finds(name):
    expected = jet(getattr(sympy, name)(PATH))
    assert_close(derivatives(getattr(scalars, name)(jet(PATH))), derivatives(expected), 1e-13)


@pytest.mark.parametrize("operation", [add, sub, mul, truediv])
def test_arithmetic_of_jets_has_the_derivatives_that_sympy_finds(operation):
    x, y = jet(PATH), jet(OTHER)
    assert_close(derivatives(operation(x, y)), derivatives(jet(operation(PATH, OTHER))), 1e-13)
    assert_close(derivatives(operation(x, 2.5)), derivatives(jet(operation(PATH, sympy.Rational(5, 2)))), 1e-13)
    assert_close(derivatives(operation(2, x)), derivatives(jet(operation(sympy.Integer(2), PATH))), 1e-13)


@pytest.mark.parametrize("exponent", [0, 1, 2, 3, 7, -2, 3.0, sympy.Rational(1, 2)])
def test_powers_of_jets_have_the_derivatives_that_sympy_finds(exponent):
    given = 0.5 if isinstance(exponent, sympy.Rational) and not exponent.is_integer else exponent
    assert_close(derivatives(jet(PATH) ** given), derivatives(jet(PATH ** sympy.nsimplify(exponent))), 1e-13)


def test_the_magnitude_of_a_jet_is_its_own_or_its_opposite():
    assert derivatives(abs(jet(-PATH))) == derivatives(jet(PATH)) == derivatives(abs(jet(PATH)))


def test_a_composition_of_everything_is_differentiated_as_a_whole():
    ours = scalars.exp(scalars.sin(jet(PATH)) / jet(OTHER)) * scalars.tanh(jet(OTHER)) - scalars.atan(jet(PATH) * 3)
    theirs = sympy.exp(sympy.sin(PATH) / OTHER) * sympy.tanh(OTHER) - sympy.atan(PATH * 3)
    assert_close(derivatives(ours), derivatives(jet(theirs)), 1e-12)


@given(values=vectors(3), other=vectors(3))
def test_where_chooses_a_jet_by_its_value(values, other):
    x, y = Jet(*values), Jet(*other)
    smaller = scalars.minimum(x, y)
    assert derivatives(smaller) == derivatives(x if values[0] <= other[0] else y)


def test_operations_keep_the_shorter_order():
    assert len((Jet(1.0, 2.0, 3.0) * Jet(1.0, 2.0)).derivatives) == 2
    assert len((Jet(1.0, 2.0, 3.0) + Jet(1.0)).derivatives) == 1


@pytest.mark.parametrize("name", ["xia2019", "mixed"])
def test_jets_through_the_whole_recursion_are_the_rates_of_the_torques(name):
    ours = robot(name)
    rng = np.random.default_rng(0)
    amplitude, phase, rate = rng.uniform(-1, 1, ours.nv), rng.uniform(0, 6, ours.nv), rng.uniform(0.3, 2.5, ours.nv)

    def path(h: float) -> list[Array]:
        return [amplitude * rate**k * np.sin(rate * h + phase + k * np.pi / 2) for k in range(5)]

    q, v, a = ([Jet(*x) for x in np.transpose(path(0.0)[k : k + 3])] for k in range(3))
    torques = definitions.inverse_dynamics(ours.machine, q, v, a)
    first = derivative(lambda h: ours.inverse_dynamics(*path(h)[:3]), 0.01)
    second = derivative(lambda h: derivative(lambda k: ours.inverse_dynamics(*path(h + k)[:3]), 0.02), 0.02)
    assert_close([tau.derivative(0) for tau in torques], ours.inverse_dynamics(*path(0.0)[:3]), 1e-12)
    assert_close([tau.derivative(1) for tau in torques], first, 1e-10)
    assert_close([tau.derivative(2) for tau in torques], second, 1e-8)


def symbolic_motion(n: int) -> list[list[Any]]:
    return [list(sympy.symbols(f"{x}:{n}")) for x in ("q", "v", "a")]


def evaluated(expressions: list[Any], symbols: list[list[Any]], *values: Array) -> Array:
    flat = [s for group in symbols for s in group]
    return np.array(sympy.lambdify(flat, expressions)(*np.concatenate(values)), float)


@pytest.mark.parametrize("seed", [0, 4])
def test_equations_on_symbols_are_the_compiled_ones_and_lagranges(seed):
    """d/dt dT/dv - dT/dq + dU/dq, differentiated by SymPy, against the recursion on symbols and as machine code."""
    ours = tree(seed, size=2)
    symbols = q, v, a = symbolic_motion(2)
    T, U = definitions.kinetic_energy(ours.machine, q, v), definitions.potential_energy(ours.machine, q)
    L = T - U
    lagrange = [
        reduce(
            add,
            (L.diff(v_i).diff(q_j) * v_j + L.diff(v_i).diff(v_j) * a_j for q_j, v_j, a_j in zip(*symbols, strict=True)),
        )
        - L.diff(q_i)
        for q_i, v_i in zip(q, v, strict=True)
    ]
    recursion = definitions.inverse_dynamics(ours.machine, q, v, a)
    for state in np.random.default_rng(seed).uniform(-3, 3, (5, 3, 2)):
        expected = evaluated(lagrange, symbols, *state)
        assert_close(ours.inverse_dynamics(*state), expected, 1e-12, scale=1.0)
        assert_close(evaluated(recursion, symbols, *state), expected, 1e-12, scale=1.0)


@given(data=st.data())
def test_laws_run_on_plain_numbers_as_they_are(data):
    """The same text on floats, without any compilation, against the kernel."""
    ours: Robot = robot("xia2019")
    motion = [data.draw(vectors(6)) for _ in range(5)]
    u = ours.elastic_inverse_dynamics(*motion)
    m = Measurement(0.0, 1e-3, *motion[:4])
    _, command = Feedforward(ours).step((), m, Reference(*motion, motion[0], motion[1]))
    assert_close(np.asarray(command.torque, float), u.motor_torque, 1e-11, scale=10.0)


def test_what_is_no_number_is_refused_by_the_functions_name():
    with pytest.raises(InputError, match=r"^sin takes a number of any kind or an array of them, not a list$"):
        scalars.sin([0.0, 1.0])


def test_floats_give_what_compiled_numbers_give_where_python_refuses():
    for x in (-1.0, np.float64(-1.0)):
        assert np.isnan(scalars.sqrt(x)) and np.isnan(scalars.log(x))
    assert scalars.log(0.0) == -np.inf and scalars.exp(800.0) == np.inf

"""JAX: machine code's own bits under jit and vmap, derivatives that are machine code's own, at the speed of rows."""

import threading
from collections import namedtuple
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cutpoint
from c_builds import assert_same_bits
from cutpoint import InputError
from cutpoint.kernels import Kernel, compile, jacobian_of
from cutpoint.scalars import cos, exp, log, sin, where

jax.config.update("jax_enable_x64", True)

EPS = 2.0**-52
RNG = np.random.default_rng(4)
Both = namedtuple("Both", "row number")


def both(q: Any, v: Any, M: Any) -> Both:
    x = sin(q[0]) * v + M[1][2] * q[1] * q[1]
    return Both([x * q[0], where(q[0] < 0.3, q[1] * x, -x), 2.5], exp(v / 4) * M[0][0] + cos(x))


def both_in_jax(q: Any, v: Any, M: Any) -> Both:
    x = jnp.sin(q[0]) * v + M[1][2] * q[1] * q[1]
    return Both(jnp.stack([x * q[0], jnp.where(q[0] < 0.3, q[1] * x, -x), 2.5]), jnp.exp(v / 4) * M[0][0] + jnp.cos(x))


def given(*batches: tuple[int, ...]) -> list[np.ndarray]:
    return [RNG.normal(size=(*batch, *own)) for batch, own in zip(batches, ((2,), (), (2, 3)), strict=True)]


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return compile(both, q=2, v=(), M=(2, 3), backend="llvm")


@pytest.fixture(scope="module")
def function(kernel: Kernel) -> Callable[..., Any]:
    return kernel.to_jax()


def assert_close(ours: Any, theirs: Any) -> None:
    """To 100 roundings of the largest: the expressions have some ten operations, of numbers about 1."""
    for x, y in zip(jax.tree.leaves(ours), jax.tree.leaves(theirs), strict=True):
        assert x.shape == y.shape
        assert np.abs(np.asarray(x - y)).max(initial=0) <= 100 * EPS * max(1, np.abs(np.asarray(y)).max(initial=0))


BATCHES = [
    ((), (), ()), ((300,), (), ()), ((300,), (300,), (300,)), ((2, 1), (3,), ()), ((1,), (1,), (1,)), ((0,), (), ()),
    ((), (4,), (1, 1)),
]  # fmt: skip


@pytest.mark.parametrize("batches", BATCHES)
def test_calls_are_those_of_the_kernel_bit_by_bit(kernel: Kernel, function: Any, batches: Any) -> None:
    q, v, M = given(*batches)
    found, jitted, expected = function(q, M=M, v=v), jax.jit(function)(q, v, M), kernel(q, v, M)
    assert found._fields == jitted._fields == expected._fields
    for ours, again, theirs in zip(found, jitted, expected, strict=True):
        assert isinstance(ours, jax.Array) and ours.dtype == float
        assert_same_bits(ours, theirs)
        assert_same_bits(again, theirs)


def test_numbers_that_are_subnormal_huge_or_not_finite_are_no_special_case() -> None:
    kernel = compile(lambda x, y: [x + y, x * y, x / y, sin(x), exp(x), log(x), where(x < y, x, y)], x=(), y=())
    odd = np.array([0.0, -0.0, 5e-324, 1e-310, 1.0, -740.0, 1e5, 1e16, 1e308, np.inf, -np.inf, np.nan])
    x, y = (side.ravel() for side in np.meshgrid(odd, odd))
    assert_same_bits(kernel.to_jax()(x, y), kernel(x, y))


def test_xla_keeps_its_own_ways_with_subnormal_numbers() -> None:
    half = compile(lambda x: x * 0.5, x=()).to_jax()
    x = jnp.full(4096, 6e-308)  # half of it is normal yet, a quarter is not
    after_our_code, alone = jax.jit(lambda x: half(x) * 0.5)(x), jax.jit(lambda x: x * 0.5)(half(x))
    assert_same_bits(after_our_code, alone)


MAPS: dict[str, Callable[[Any], Any]] = {
    "over all": lambda f: jax.vmap(f)(*given((5,), (5,), (5,))),
    "over one": lambda f: jax.vmap(f, (0, None, None))(*given((5,), (), ())),
    "over another axis": lambda f: jax.vmap(f, (1, None, 2))(np.ones((2, 4)), 0.5, np.ones((2, 3, 4))),
    "nested": lambda f: jax.vmap(jax.vmap(f, (0, None, None)), (None, 0, None))(*given((5,), (4,), ())),
    "nested, together": lambda f: jax.vmap(jax.vmap(f))(*given((5, 4), (5, 4), (5, 4))),
    "nested, crossed": lambda f: jax.vmap(jax.vmap(f, (0, None, 0)), (0, 0, None))(*given((5, 4), (5,), (4,))),
    "of length one": lambda f: jax.vmap(f, (0, None, None))(*given((1,), (), ())),
    "out to the end": lambda f: jax.vmap(f, out_axes=-1)(*given((5,), (5,), (5,))),
}


@pytest.mark.parametrize("name", MAPS)
def test_vmap_is_a_loop(function: Any, name: str) -> None:
    state = RNG.bit_generator.state
    ours = jax.jit(lambda: MAPS[name](function))()
    RNG.bit_generator.state = state
    assert_close(ours, MAPS[name](both_in_jax))


def test_vmap_over_nothing_is_nothing(function: Any) -> None:
    assert jax.vmap(function)(*given((0,), (0,), (0,))).row.shape == (0, 3)


def total(f: Any) -> Callable[..., Any]:
    return lambda *x: sum(part.sum() for part in f(*x))


DERIVATIVES: dict[str, Callable[[Any, Any], Any]] = {
    "jacfwd": lambda f, x: jax.jacfwd(f, (0, 1, 2))(*x),
    "jacrev": lambda f, x: jax.jacrev(f, (0, 1, 2))(*x),
    "grad by one": lambda f, x: jax.grad(total(f), 1)(*x),
    "jvp": lambda f, x: jax.jvp(f, x, tuple(2 * y for y in x)),
    "vjp": lambda f, x: jax.vjp(f, *x)[1](f(*x)),
    "linearize": lambda f, x: jax.linearize(f, *x)[1](*x),
    "hessian": lambda f, x: jax.hessian(f, (0, 1))(*x),
    "reverse over reverse": lambda f, x: jax.jacrev(jax.jacrev(f))(*x),
    "thrice": lambda f, x: jax.jacfwd(jax.jacfwd(jax.jacrev(f)))(*x),
    "checkpoint": lambda f, x: jax.grad(total(jax.checkpoint(f)))(*x),
    "of vmap": lambda f, x: jax.jacrev(jax.vmap(f, (0, None, None)), (0, 2))(jnp.ones((4, 2)), *x[1:]),
    "under vmap": lambda f, x: jax.vmap(jax.jacfwd(f, (0, 2)), (None, 0, None))(x[0], jnp.arange(4.0), x[2]),
    "hessian under vmap": lambda f, x: jax.vmap(jax.hessian(f), (None, 0, None))(x[0], jnp.arange(4.0), x[2]),
    "scan": lambda f, x: jax.grad(lambda v: jax.lax.scan(lambda q, _: (f(q, v, x[2]).row[:2] / 4, q), x[0],
                                                         None, 5)[0].sum())(x[1]),
}  # fmt: skip


@pytest.mark.parametrize("jitted", [False, True])
@pytest.mark.parametrize("name", DERIVATIVES)
def test_derivatives_are_those_that_jax_finds_itself(function: Any, name: str, jitted: bool) -> None:
    x = tuple(given((), (), ()))
    wrapped = jax.jit if jitted else lambda f: f
    assert_close(wrapped(lambda *y: DERIVATIVES[name](function, y))(*x), DERIVATIVES[name](both_in_jax, x))


def test_jacobians_of_a_robot_are_its_own() -> None:
    arm = cutpoint.robots.xia2019()
    q, v, tau = RNG.normal(size=(3, 20, 6))
    expected = arm.forward_dynamics(q, v, tau), arm.kernel("forward_dynamics")
    function = expected[1].to_jax()
    found = jax.vmap(jax.jacfwd(function, (0, 1, 2)))(q, v, tau)
    own = compile(jacobian_of(lambda **x: cutpoint.definitions.forward_dynamics(arm.machine, **x)), q=6, v=6, tau=6)
    for ours, theirs in zip(found, own(q, v, tau), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-10 * np.abs(theirs).max())
    assert_same_bits(function(q, v, tau), expected[0])


def test_an_input_that_is_not_moved_costs_no_derivative(function: Any) -> None:
    text = jax.jit(jax.grad(total(function), 1)).lower(*given((), (), ())).as_text()
    targets = [line for line in text.splitlines() if "custom_call @" in line and "cutpoint" in line]
    assert targets and not [line for line in targets if "3x2xf64" in line]


def test_empty_inputs_and_outputs_are_kept() -> None:
    record = namedtuple("record", "nothing twice constant")
    kernel = compile(lambda q, none: record([], [2 * x for x in q], 1.5), q=2, none=0)
    found = kernel.to_jax()(np.ones((3, 2)), np.zeros(0))
    assert [x.shape for x in found] == [(3, 0), (3, 2), (3,)] and found.twice.tolist() == [[2.0, 2.0]] * 3
    slopes = jax.jacfwd(kernel.to_jax(), (0, 1))(np.ones(2), np.zeros(0))
    assert slopes.twice[0].tolist() == [[2.0, 0.0], [0.0, 2.0]] and slopes.twice[1].shape == (2, 0)
    assert compile(lambda: 2.0).to_jax()() == 2.0
    assert compile(lambda x: [], x=2).to_jax()(np.ones((3, 2))).shape == (3, 0)


def test_threads_may_call_at_the_same_time(kernel: Kernel, function: Any) -> None:
    arguments = given((3000,), (3000,), ())
    expected, found = kernel(*arguments), [None] * 4

    def work(k: int) -> None:
        for _ in range(20):
            found[k] = function(*arguments)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in found:
        for ours, theirs in zip(result, expected, strict=True):
            assert_same_bits(ours, theirs)


def test_arguments_that_do_not_fit_are_refused(function: Any) -> None:
    with pytest.raises(InputError, match=r"both: q has shape \(3,\): its last axis must be 2"):
        function(np.zeros(3), 0.0, np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"both: leading axes do not broadcast: q \(4,\), v \(3,\), M \(\)"):
        function(np.zeros((4, 2)), np.zeros(3), np.zeros((2, 3)))
    with pytest.raises(InputError, match="both: q holds complex128, but must hold real numbers"):
        function(np.zeros(2, complex), 0.0, np.zeros((2, 3)))
    with pytest.raises(InputError, match="both: M missing; it takes q, v, M"):
        function(np.zeros(2), 0.0)


def test_single_precision_is_refused_with_the_remedy(function: Any) -> None:
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(InputError, match=r'float64; run jax.config.update\("jax_enable_x64", True\) first'):
            function(np.zeros(2), 0.0, np.zeros((2, 3)))
    finally:
        jax.config.update("jax_enable_x64", True)

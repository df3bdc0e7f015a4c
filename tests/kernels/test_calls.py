"""Single calls: the built-in function in front of a kernel does what the general call does, only sooner."""

import gc
import pickle
import sys
import threading
import tracemalloc
import weakref
from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import pytest
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st

from cutpoint.errors import InputError
from cutpoint.kernels import Kernel, compile, jacobian_of
from cutpoint.kernels.arrays import numpy_api, plain_arguments
from cutpoint.scalars import exp, sin, where

RNG = np.random.default_rng(7)


class Several(NamedTuple):
    vector: Any
    number: Any
    matrix: Any


class Alone(NamedTuple):
    only: Any


FUNCTIONS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "number of numbers": (lambda x, y: x * y - 1, {"x": (), "y": ()}),
    "number of a vector": (lambda q: sum(x * x for x in q), {"q": 9}),
    "vector": (lambda q, v, a: [x * y + sin(z) for x, y, z in zip(q, v, a, strict=True)], {"q": 6, "v": 6, "a": 6}),
    "matrix": (lambda q, M: [[x * y for y in M[1]] for x in q], {"q": 3, "M": (2, 5)}),
    "array of three axes": (lambda T: [[[x + 1 for x in row] for row in M] for M in T], {"T": (2, 3, 4)}),
    "constants and inputs": (lambda q, t: [0.0, q[1], -0.0, 2.5, t, q[0] / t], {"q": 2, "t": ()}),
    "several": (
        lambda q, t, M: Several([x * t for x in q], exp(t), [[M[j][i] for j in range(2)] for i in range(3)]),
        {"q": 17, "t": (), "M": (2, 3)},
    ),
    "numbers in a record": (lambda x: Several(x[0], x[1], x[0] * x[1]), {"x": 2}),
    "one in a record": (lambda q: Alone([-x for x in q]), {"q": 8}),
    "many arguments": (
        lambda a, b, c, d, e, f, g, h, i: [where(x < y, x * b[0] - c[1], y / h[0]) for x, y in zip(a, i, strict=True)],
        dict.fromkeys("abcdefghi", 2),
    ),
}  # fmt: skip


@pytest.fixture(scope="module", params=FUNCTIONS.values(), ids=FUNCTIONS)
def kernel(request: pytest.FixtureRequest) -> Kernel:
    function, inputs = request.param
    return compile(function, backend="llvm", **inputs)


def drawn(kernel: Kernel) -> list[Any]:
    return [np.array(RNG.normal(size=p.shape)) if p.shape else float(RNG.normal()) for p in kernel.graph.inputs]


def assert_same(found: Any, expected: Any) -> None:
    """The same bits, in the same kinds of object."""
    assert type(found) is type(expected)
    if isinstance(expected, tuple):
        assert len(found) == len(expected)
        for x, y in zip(found, expected, strict=True):
            assert_same(x, y)
    else:
        assert (found.shape, found.dtype) == (expected.shape, expected.dtype)
        assert found.tobytes() == expected.tobytes()
        assert str(found.flags) == str(expected.flags)


def outcome(call: Callable[[], Any]) -> Any:
    """What a call returns, or the error that it raises as text."""
    try:
        return call()
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def assert_same_outcome(found: Any, expected: Any) -> None:
    if isinstance(expected, str):
        assert found == expected
    else:
        assert_same(found, expected)


class Spy:
    """Takes calls and remembers what came."""

    def __init__(self) -> None:
        self.calls: list[tuple[tuple[Any, ...], dict[str, Any]]] = []

    def __call__(self, *arguments: Any, **named: Any) -> str:
        self.calls.append((arguments, named))
        return "general"


def test_this_python_and_this_numpy_are_known() -> None:
    assert plain_arguments.is_possible()


def test_plain_arguments_give_the_bits_of_the_general_call(kernel: Kernel) -> None:
    for _ in range(20):
        arguments = drawn(kernel)
        assert_same(kernel.call(*arguments), kernel.general(*arguments))
        assert_same(kernel(*arguments), kernel.general(*arguments))


@pytest.mark.parametrize("x", [0.0, -0.0, 5e-324, 1e-310, 1.0, 1e308, -1e308, np.inf, -np.inf, np.nan])
def test_odd_numbers_are_no_special_case(kernel: Kernel, x: float) -> None:
    arguments = [np.full(p.shape, x) for p in kernel.graph.inputs]
    assert_same(kernel.call(*arguments), kernel.general(*arguments))


@given(st.lists(steps, min_size=1, max_size=25), st.integers(0, 2**32))
@settings(max_examples=20)
def test_any_graph_gives_the_bits_of_the_general_call(recipe: list[Step], seed: int) -> None:
    kernel = compile(lambda x: cook(recipe, x), x=3, backend="llvm")
    x = np.random.default_rng(seed).uniform(-3, 3, 3)
    assert_same(kernel.call(x), kernel.general(x))


def test_plain_arguments_never_reach_the_general_call(kernel: Kernel) -> None:
    spy = Spy()
    call = kernel.shortcut(spy, largest=1e15)
    arguments = drawn(kernel)
    for array in (x for x in arguments if isinstance(x, np.ndarray)):
        array.flags.writeable = False
    call(*arguments)
    call(*[np.array(x) for x in arguments])
    call(*[np.float64(x) if isinstance(x, float) else x for x in arguments])
    assert not spy.calls


def unaligned(x: np.ndarray) -> np.ndarray:
    memory = np.zeros(x.nbytes + 1, np.uint8)[1:]
    view = memory.view(np.float64).reshape(x.shape)
    view[...] = x
    return view


class Inherited(np.ndarray):
    pass


class Number(float):
    pass


ODD: dict[str, Callable[[np.ndarray], Any]] = {
    "list": lambda x: x.tolist(),
    "tuple": lambda x: tuple(x.tolist()) if x.ndim else (x.item(),),
    "every second": lambda x: np.repeat(x, 2, axis=-1)[..., ::2] if x.ndim else x[None][::2],
    "backwards": lambda x: x[..., ::-1] if x.ndim else x[None][::-1],
    "Fortran's order": lambda x: np.asfortranarray(x.T).T if x.ndim < 2 else np.asfortranarray(x),
    "transposed": lambda x: x.T if x.ndim > 1 else x[..., None].T,
    "broadcast": lambda x: np.broadcast_to(x.flat[0], x.shape) if x.ndim else np.broadcast_to(x, (2,)),
    "unaligned": unaligned,
    "bytes swapped": lambda x: x.astype(">f8"),
    "float32": lambda x: x.astype(np.float32),
    "long double": lambda x: x.astype(np.longdouble),
    "integers": lambda x: x.astype(int),
    "truths": lambda x: x > 0,
    "complex": lambda x: x + 1j,
    "objects": lambda x: x.astype(object),
    "fractions": lambda x: Fraction(1, 3),
    "float64 scalar of NumPy": lambda x: np.float64(1.5),
    "heir of float": lambda x: Number(0.5),
    "whole number": lambda x: 3,
    "text": lambda x: "straight",
    "texts": lambda x: np.full(x.shape, "a"),
    "None": lambda x: None,
    "heir of ndarray": lambda x: x.view(Inherited),
    "masked": lambda x: np.ma.masked_array(x),
    "batch": lambda x: np.stack([x, x]),
    "batch of one": lambda x: x[None],
    "empty batch": lambda x: np.zeros((0, *x.shape)),
    "too short": lambda x: x[..., :-1] if x.ndim else np.zeros(()),
    "too long": lambda x: np.concatenate([x, x], axis=-1) if x.ndim else np.zeros(3),
    "flat": lambda x: x.ravel(),
    "number": lambda x: 0.25,
    "no numbers": lambda x: np.full_like(x, np.nan),
}  # fmt: skip


@pytest.mark.parametrize("odd", ODD.values(), ids=ODD)
def test_an_odd_argument_fares_as_in_the_general_call(kernel: Kernel, odd: Callable[[np.ndarray], Any]) -> None:
    for k in range(len(kernel.graph.inputs)):
        arguments = drawn(kernel)
        arguments[k] = odd(np.array(arguments[k]))
        expected = outcome(lambda arguments=arguments: kernel.general(*arguments))
        assert_same_outcome(outcome(lambda arguments=arguments: kernel.call(*arguments)), expected)
        assert_same_outcome(outcome(lambda arguments=arguments: kernel(*arguments)), expected)


def test_what_is_not_plain_is_handed_on_as_it_came(kernel: Kernel) -> None:
    names = [p.name for p in kernel.graph.inputs]
    arguments, spy = drawn(kernel), Spy()
    call = kernel.shortcut(spy)
    out = object()
    assert call() == call(*arguments, 1.0) == call(**dict(zip(names, arguments, strict=True))) == "general"
    assert call(*arguments, out=out) == call(*arguments[1:]) == call(None, *arguments[1:]) == "general"
    assert [len(positional) for positional, _ in spy.calls] == [
        0, len(names) + 1, 0, len(names), len(names) - 1, len(names),
    ]  # fmt: skip
    assert [*spy.calls[2][1]] == names and spy.calls[3][1]["out"] is out
    assert all(x is y for x, y in zip(spy.calls[3][0], arguments, strict=True))


@pytest.mark.parametrize("x", [np.nan, np.inf, -np.inf, 1.001e15, -1e300])
def test_a_number_that_is_too_large_or_none_is_seen_wherever_it_is(kernel: Kernel, x: float) -> None:
    spy = Spy()
    call = kernel.shortcut(spy, largest=1e15)
    for k, port in enumerate(kernel.graph.inputs):
        for index in np.ndindex(port.shape):
            arguments = [np.array(a) for a in drawn(kernel)]
            arguments[k][index] = x
            assert call(*arguments) == "general"
    assert len(spy.calls) == sum(p.size for p in kernel.graph.inputs)


@pytest.mark.parametrize("x", [0.0, -0.0, 5e-324, 0.999e15, -0.999e15])
def test_a_number_that_is_not_too_large_is_plain(kernel: Kernel, x: float) -> None:
    spy = Spy()
    kernel.shortcut(spy, largest=1e15)(*[np.full(p.shape, x) for p in kernel.graph.inputs])
    assert not spy.calls


def test_a_bound_array_is_read_at_every_call(kernel: Kernel) -> None:
    *first, last = [np.array(x) for x in drawn(kernel)]
    call = kernel.shortcut(Spy(), bound=[last], record=kernel._record)
    assert_same(call(*first), kernel.general(*first, last))
    last += 1
    assert_same(call(*first), kernel.general(*first, last))


@pytest.mark.parametrize(
    "wrong", [np.zeros(2), np.zeros(3, np.float32), np.zeros(3, ">f8"), np.zeros(6)[::2], unaligned(np.zeros(3))]
)
def test_a_bound_array_that_is_not_plain_is_refused(wrong: np.ndarray) -> None:
    kernel = compile(lambda x, y: [x, *y], x=(), y=3, backend="llvm")
    with pytest.raises(InputError, match=r"what is bound to y must be a tidy float64 array of shape \(3,\)"):
        kernel.shortcut(kernel.general, bound=[wrong])


def arrays_in(result: Any) -> list[np.ndarray]:
    return [x for x in (result if isinstance(result, tuple) else (result,)) if isinstance(x, np.ndarray)]


def test_every_call_makes_new_outputs(kernel: Kernel) -> None:
    arguments = drawn(kernel)
    first, second = arrays_in(kernel.call(*arguments)), arrays_in(kernel.call(*arguments))
    memory = [*first, *second, *(x for x in arguments if isinstance(x, np.ndarray))]
    assert not any(np.shares_memory(x, y) for k, x in enumerate(memory) for y in memory[:k])
    assert all(x.flags.owndata and x.flags.writeable for x in (*first, *second))


def test_an_input_may_be_given_twice() -> None:
    kernel = compile(lambda q, v: [a - b for a, b in zip(q, reversed(v), strict=True)], q=4, v=4, backend="llvm")
    x = RNG.normal(size=4)
    assert_same(kernel.call(x, x), kernel.general(x, x.copy()))


def test_calls_leave_nothing_behind(kernel: Kernel) -> None:
    arguments, odd = drawn(kernel), drawn(kernel)[1:]
    call = kernel.call
    watched = [*arguments, call, kernel.general, kernel._record, np.ndarray, np.float64, np.dtype(np.float64), float]

    def many(count: int) -> list[int]:
        for _ in range(count):
            call(*arguments)
        for _ in range(count // 1000):
            outcome(lambda: call(*odd))
        gc.collect()
        return [sys.getrefcount(x) for x in watched]

    before = many(1000)
    tracemalloc.start()
    try:
        many(1000)
        start = tracemalloc.get_traced_memory()[0]
        after = many(20_000)
        grown = tracemalloc.get_traced_memory()[0] - start
    finally:
        tracemalloc.stop()
    # a byte forgotten in each call would be 20,000
    assert grown < 10_000 and max(abs(x - y) for x, y in zip(after, before, strict=True)) < 100


def test_a_million_calls_take_no_more_memory_than_a_thousand(kernel: Kernel) -> None:
    arguments, call = drawn(kernel), kernel.call

    def blocks_after(count: int) -> int:
        for _ in range(count):
            call(*arguments)
        return sys.getallocatedblocks()

    assert abs(blocks_after(1_000_000) - blocks_after(1000)) < 1000


def test_a_call_outlives_its_kernel_and_a_kernel_goes_when_it_is_let_go() -> None:
    gc.disable()
    try:
        kernel = compile(lambda q: [2 * x for x in q], q=3, backend="llvm")
        call, gone = kernel.call, weakref.ref(kernel)
        del kernel
        assert gone() is None
        np.testing.assert_array_equal(call(np.arange(3.0)), [0, 2, 4])
        np.testing.assert_array_equal(call([[0, 1, 2]]), [[0, 2, 4]])
        orphan = compile(lambda q: [3 * x for x in q], q=3, backend="llvm").shortcut(Spy())
        np.testing.assert_array_equal(orphan(np.arange(3.0)), [0, 3, 6])
    finally:
        gc.enable()


def test_overflow_is_not_reported_by_what_numpy_does_next() -> None:
    kernel = compile(lambda x, y: [x * x, x / y, x - x, y / y], x=(), y=(), backend="llvm")
    with np.errstate(all="raise"):
        for x in (1e308, np.inf, np.nan, 1e-308):
            kernel.call(x, 0.0)
            assert (np.ones(3) + np.ones(3) == 2).all() and np.float64(2.0) * 2.0 == 4.0
            assert np.linalg.solve(np.eye(2), np.ones(2)).sum() == 2.0 and np.sqrt(4.0) == 2.0


def test_threads_may_call_at_once(kernel: Kernel) -> None:
    sides = [drawn(kernel) for _ in range(4)]
    expected = [kernel.general(*arguments) for arguments in sides]
    wrong: list[Any] = []

    def work(k: int) -> None:
        for _ in range(2000):
            outcome_now = kernel.call(*sides[k])
            try:
                assert_same(outcome_now, expected[k])
            except AssertionError as error:
                wrong.append(error)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_call_says_what_it_takes() -> None:
    def damped(x: Any, rate: Any) -> Any:
        return [-rate * y for y in x]

    call = compile(damped, x=3, rate=(), backend="llvm").call
    assert (call.__name__, call.__doc__) == ("damped", "damped(x, rate)")


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize(
    ("function", "inputs"),
    [
        (lambda q: [2.0, q[0]], {"q": 3}),
        (lambda q, w: [2.0, q[0]], {"q": 3, "w": 0}),
        (lambda q: [0 * x for x in q], {"q": 0}),
        (lambda: [2.0, 1.0], {}),
    ],
    ids=["plain", "an empty input", "an empty output", "no input"],
)
def test_every_kernel_has_a_call(backend: str, function: Callable[..., Any], inputs: dict[str, int]) -> None:
    kernel = compile(function, backend=backend, **inputs)
    arguments = [RNG.normal(size=n) for n in inputs.values()]
    assert_same(kernel.call(*arguments), kernel.general(*arguments))


def test_without_the_numpy_and_python_it_knows_calls_are_general(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_arguments, "is_possible", lambda: False)
    kernel = compile(lambda q: [2 * x for x in q], q=3, backend="llvm")
    assert kernel.call is kernel.general
    np.testing.assert_array_equal(kernel(np.arange(3.0)), [0, 2, 4])


@pytest.mark.parametrize("field", ["DATA", "RANK", "SHAPE", "TYPE", "FLAGS"])
def test_an_array_that_lies_otherwise_in_memory_is_noticed(field: str, monkeypatch: pytest.MonkeyPatch) -> None:
    others = {"DATA": numpy_api.SHAPE, "RANK": numpy_api.RANK + 4, "SHAPE": numpy_api.SHAPE + 8,
              "TYPE": numpy_api.TYPE - 8, "FLAGS": numpy_api.RANK}  # fmt: skip
    monkeypatch.setattr(numpy_api, field, others[field])
    assert not numpy_api.arrays_are_as_expected.__wrapped__()


def test_a_numpy_of_another_abi_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numpy_api, "_VERSIONS", (0x03000000,))
    assert not numpy_api.arrays_are_as_expected.__wrapped__()


@pytest.mark.parametrize("sizes", [{"q": 2, "e": 0}, {"e": 0, "q": 2}, {"e": 0, "q": 2, "f": (3, 0)}])
def test_arguments_and_results_without_numbers_go_the_short_way_too(sizes):
    """Laws without memory have them."""

    class Both(NamedTuple):
        twice: Any
        nothing: Any
        sum: Any

    def both(q: Any, e: Any, **_: Any) -> Both:
        return Both([2 * q[0], 2 * q[1]], [*e], q[0] + q[1])

    kernel = compile(both, **sizes)
    given = [np.arange(1.0, 3.0) if name == "q" else np.zeros(size) for name, size in sizes.items()]
    for call in (kernel.call, kernel.general):
        found = call(*given)
        assert np.array_equal(found.twice, [2.0, 4.0])
        assert found.nothing.shape == (0,)
        assert found.sum == 3.0


def test_records_of_outputs_pickle_and_stay_what_they_are():
    kernel = compile(jacobian_of(lambda q: [q[0] * q[1]]), q=2)
    found = kernel(np.ones(2))
    again = pickle.loads(pickle.dumps(found))
    assert type(again) is type(found) and np.array_equal(again[0], found[0])
    assert type(pickle.loads(pickle.dumps(kernel))(np.ones(2))) is type(found)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_masked_numbers_are_refused_and_masks_that_hide_nothing_are_none(backend):
    kernel = compile(lambda q: [q[0] + q[1]], q=2, name="sum", backend=backend)
    numbers = [[1.0, 2.0], [3.0, 4.0]]
    found = kernel(np.ma.masked_array(numbers))
    assert type(found) is np.ndarray and found.tolist() == [[3.0], [7.0]]
    with pytest.raises(InputError, match=r"^sum: q has masked numbers: fill them in"):
        kernel(np.ma.masked_array(numbers, mask=[[0, 1], [0, 0]]))

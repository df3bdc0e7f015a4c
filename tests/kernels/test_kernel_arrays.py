"""Kernels on arrays: NumPy's gufunc semantics, on every backend."""

import copy
import math
import pickle
import sys
import threading
from collections import namedtuple
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from graph_recipes import Step, cook, steps
from hypothesis import given, settings
from hypothesis import strategies as st
from running_error import Bounded

from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.arrays import backends
from cutpoint.kernels.machine.batch_loop import WORTH_MAKING_PACKS
from cutpoint.scalars import cos, exp, sin, sqrt, where

BACKENDS = ("llvm", "numpy")
RNG = np.random.default_rng(3)
FINITE = st.floats(-3, 3)


def mixed(q: Any, v: Any, M: Any) -> Any:
    """A vector, a scalar and a matrix in; a matrix out."""
    return [[sin(q[0]) * M[i][j] + v * q[1] if j < 2 else i - M[0][j] for j in range(3)] for i in range(2)]


def mixed_array(q: np.ndarray, v: np.ndarray, M: np.ndarray) -> np.ndarray:
    full = np.sin(q[..., :1, None]) * M + (v * q[..., 1])[..., None, None]
    rows = np.arange(2.0)[:, None] - M[..., :1, 2:]
    return np.concatenate([full[..., :2], np.broadcast_to(rows, (*full.shape[:-2], 2, 1))], axis=-1)


def batch(*shape: int) -> list[np.ndarray]:
    return [RNG.normal(size=(*shape, *core)) for core in ((2,), (), (2, 3))]


@pytest.fixture(params=BACKENDS)
def kernel(request: pytest.FixtureRequest) -> Kernel:
    return compile(mixed, q=2, v=(), M=(2, 3), backend=request.param)


@given(st.lists(steps, min_size=1, max_size=25), st.tuples(FINITE, FINITE, FINITE))
@settings(deadline=None, max_examples=60)
def test_all_backends_agree_with_plain_floats(recipe: list[Step], x: tuple[float, ...]) -> None:
    expected = cook(recipe, [Bounded(e) for e in x])
    for backend in BACKENDS:
        found = compile(lambda x: cook(recipe, x), x=3, backend=backend)(np.array(x))
        for y, bound in zip(found, expected, strict=True):
            assert abs(y - bound.value) <= 2 * bound.error


@pytest.mark.parametrize("shape", [(), (1,), (7,), (2, 3), (0,), (4, 0)])
def test_leading_axes_are_a_batch(kernel: Kernel, shape: tuple[int, ...]) -> None:
    q, v, M = batch(*shape)
    np.testing.assert_allclose(kernel(q, v, M), mixed_array(q, v, M), rtol=1e-14, atol=1e-15)
    assert kernel(q, v, M).shape == (*shape, 2, 3)


def test_leading_axes_broadcast(kernel: Kernel) -> None:
    q, v, M = batch(5, 1)[0], batch(4)[1], batch()[2]
    np.testing.assert_allclose(kernel(q, v, M), mixed_array(q, v, M), rtol=1e-14, atol=1e-15)
    assert kernel(q, v, M).shape == (5, 4, 2, 3)


def test_any_strides_give_the_same_bits(kernel: Kernel) -> None:
    q, v, M = batch(6, 5)
    expected = kernel(q, v, M)
    views = [
        (q.T.copy().T, v.T.copy().T, M.T.copy().T),
        (np.repeat(q, 2, axis=-1)[..., ::2], np.repeat(v, 3, axis=0)[::3], M[..., ::-1, :].copy()[..., ::-1, :]),
        (q, v, np.asfortranarray(M)),
    ]
    for view in views:
        assert np.array_equal(kernel(*view), expected)


def test_out_is_filled_whatever_its_strides(kernel: Kernel) -> None:
    arguments = batch(6, 5)
    expected = kernel(*arguments)
    for out in (np.empty((6, 5, 2, 3)), np.empty((3, 2, 5, 6)).T, np.empty((6, 10, 2, 6))[:, ::2, :, ::-2]):
        assert kernel(*arguments, out=out) is out
        assert np.array_equal(out, expected)


def test_out_may_overlap_an_input(kernel: Kernel) -> None:
    q, v, M = batch(9)
    expected = kernel(q, v, M)
    kernel(q, v, M, out=M)
    assert np.array_equal(M, expected)


def test_inputs_go_by_position_or_name(kernel: Kernel) -> None:
    q, v, M = batch(3)
    assert np.array_equal(kernel(q, M=M, v=v), kernel(q, v, M))


@pytest.mark.parametrize("kind", [np.float32, np.int32, list, bool])
def test_numbers_of_other_kinds_are_cast(kernel: Kernel, kind: Any) -> None:
    q, v, M = ((x * 3).round() for x in batch(4))
    cast = [x.tolist() if kind is list else x.astype(kind) for x in (q, v, M)]
    assert np.array_equal(kernel(*cast), kernel(*(np.asarray(x, float) for x in cast)))


@pytest.mark.parametrize("backend", BACKENDS)
def test_size_and_place_in_a_batch_change_no_bit(backend: str) -> None:
    kernel = compile(mixed, q=2, v=(), M=(2, 3), backend=backend)
    q, v, M = batch(37)
    whole = kernel(q, v, M)
    if backend == "llvm":  # NumPy's own sin is not that strict
        for k in range(37):
            assert np.array_equal(kernel(q[k], v[k], M[k]), whole[k])
    assert np.array_equal(kernel(q[::-1], v[::-1], M[::-1]), whole[::-1])


class Motor(namedtuple("Motor", "torque angle")):
    __slots__ = ()


@dataclass
class Wrench:
    force: Any
    moment: Any


@dataclass
class Alone:
    value: Any


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("kind", [Motor, Wrench])
def test_records_become_named_outputs(backend: str, kind: Any) -> None:
    kernel = compile(lambda q: kind([q[0], 2.0, q[1]], q[0] + q[1]), q=2, backend=backend)
    result = kernel(np.ones((4, 2)))
    assert type(result).__name__ == kind.__name__ and len(result._fields) == 2
    assert result[0].shape == (4, 3) and np.array_equal(result[1], [2.0] * 4)
    out = (np.empty((4, 3)), np.empty(4))
    assert kernel(np.ones((4, 2)), out=out)[1] is out[1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_record_of_one_field_is_a_record(backend: str) -> None:
    result = compile(lambda q: Alone(q[0]), q=2, backend=backend)(np.ones(2))
    assert result._fields == ("value",) and result.value == 1


@pytest.mark.parametrize("backend", BACKENDS)
def test_ports_of_size_zero_are_no_special_case(backend: str) -> None:
    kernel = compile(lambda q, e: Wrench([q[0]], [x + 1 for x in e]), q=1, e=0, backend=backend)
    force, moment = kernel(np.ones((3, 1, 1)), np.empty((2, 0)))
    assert force.shape == (3, 2, 1) and moment.shape == (3, 2, 0) and (force == 1).all()
    out = (np.zeros((3, 1)), np.zeros((3, 0)))
    assert kernel(np.ones((3, 1)), [], out=out)[0] is out[0] and (out[0] == 1).all()
    assert compile(lambda e: [], e=(3, 0), backend=backend)(np.empty((5, 3, 0))).shape == (5, 0)
    assert compile(lambda e: 7, e=0, backend=backend)(np.empty((5, 0))).tolist() == [7.0] * 5
    assert compile(lambda: [1, 2], backend=backend)().tolist() == [1, 2]


LONG = 2 * WORTH_MAKING_PACKS

WAYS_TO_CALL: dict[str, Callable[[Kernel, Sequence[np.ndarray]], Any]] = {
    "a batch": lambda kernel, given: kernel(*given),
    "in Fortran's order": lambda kernel, given: kernel(*map(np.asfortranarray, given)),
    "by several threads": lambda kernel, given: kernel(*given, threads=2),
    "into arrays": lambda kernel, given: kernel(*given, out=tuple(np.empty_like(x) for x in kernel(*given))),
    "in blocks": lambda kernel, given: kernel.blocks.rows(kernel.blocks(*map(kernel.blocks.of, given)), LONG),
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("way", WAYS_TO_CALL.values(), ids=WAYS_TO_CALL)
def test_ports_of_size_zero_change_nothing_of_the_others(way: Callable[..., Any], backend: str) -> None:
    kernel = compile(lambda e, q, M, t: Wrench([], [q[0] * t, sin(q[1])]), e=0, q=2, M=(3, 0), t=(), backend=backend)
    given = [RNG.normal(size=(LONG, *p.shape)) for p in kernel.graph.inputs]
    force, moment = way(kernel, given)
    one_by_one = np.stack([kernel(*x).moment for x in zip(*given, strict=True)])
    assert force.shape == (LONG, 0) and moment.tobytes() == one_by_one.tobytes()


@pytest.mark.parametrize("backend", BACKENDS)
def test_finite_numbers_never_raise_a_warning(backend: str) -> None:
    def function(x: Any) -> Any:
        return [where(x > 0, sqrt(x), 0), where(x > 0, 1 / x, 0), exp(x), sin(x), x * x]

    kernel = compile(function, x=(), backend=backend)
    with np.errstate(all="raise"):
        result = kernel(np.array([0.0, -0.0, 5e-324, -1.0, 1e308, -1e308, 1e5]))
    assert result[0].tolist() == [0, 0, 1, 0, 0] and result[3, 2] == pytest.approx(math.exp(-1))


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_not_finite_propagates(backend: str) -> None:
    kernel = compile(lambda x, y: [x + y, cos(x), where(x < y, 1, 2)], x=(), y=(), backend=backend)
    assert np.isnan(kernel(math.nan, 1.0)[:2]).all() and kernel(math.nan, 1.0)[2] == 2
    assert kernel(math.inf, 1.0)[0] == math.inf


def test_the_interpreter_runs_while_a_kernel_does() -> None:
    kernel = compile(mixed, q=2, v=(), M=(2, 3), backend="llvm")
    arguments = batch(400_000)
    counted, stop = [0], threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    interval = sys.getswitchinterval()
    thread.start()
    sys.setswitchinterval(0.5)  # the other thread gets its turn only when the kernel lets go
    try:
        before = counted[0]
        kernel(*arguments, out=np.zeros((400_000, 2, 3)))
        after = counted[0]
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()
    assert after > before


@pytest.fixture
def without_llvm(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for module in [m for m in sys.modules if m.startswith(("llvmlite", "cutpoint.kernels.machine.jit"))]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "llvmlite", None)
    monkeypatch.delattr("cutpoint.kernels.machine.jit", raising=False)
    backends.llvm_is_installed.cache_clear()
    yield
    monkeypatch.undo()
    backends.llvm_is_installed.cache_clear()


def test_numpy_takes_over_where_llvm_is_missing(without_llvm: None) -> None:
    kernel = compile(mixed, q=2, v=(), M=(2, 3))
    arguments = batch(4)
    assert kernel.backend == "numpy"
    np.testing.assert_allclose(kernel(*arguments), mixed_array(*arguments), rtol=1e-14, atol=1e-15)


def test_a_kernel_says_what_it_is() -> None:
    kernel = compile(mixed, q=2, v=(), M=(2, 3))
    assert kernel.name == "mixed" and kernel.backend == "llvm" and 0 < kernel.compile_seconds < 10
    assert kernel.operations == kernel.graph.operations and kernel.operations["sin"] == 1
    assert "mixed" in repr(kernel) and "q(2,)" in repr(kernel)
    assert compile(lambda x: x, x=(), name="same").name == "same"


COPIES: dict[str, Callable[[Kernel], Kernel]] = {
    "pickled": lambda x: pickle.loads(pickle.dumps(x)), "copied": copy.copy, "copied deep": copy.deepcopy
}  # fmt: skip


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES)
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_copy_gives_the_bits_of_the_kernel(backend: str, copied: Callable[[Kernel], Kernel]) -> None:
    pair = namedtuple("Pair", "slow fast")

    def deep(x: Any) -> Any:
        y = x
        for _ in range(400):
            y = where(y < x, y * 0.5, x - y)
        return pair(sin(y), -0.0)

    made = compile(deep, x=(), backend=backend)
    for kernel in made, made.float32:
        twin, x = copied(kernel), np.linspace(-1, 1, 5)
        assert repr(twin) == repr(kernel)
        assert twin(x).slow.dtype == kernel(x).slow.dtype
        assert [a.tobytes() for a in twin(x)] == [a.tobytes() for a in kernel(x)]

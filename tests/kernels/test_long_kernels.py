"""Functions so long that compiling them would take many minutes are refused, with a remedy."""

from typing import Any

import numpy as np
import pytest

from cutpoint.errors import InputError
from cutpoint.kernels import Loop, Region, Stage, compile_program
from cutpoint.kernels import compile as compile_kernel
from cutpoint.kernels.arrays import backends
from cutpoint.kernels.graphs import nodes
from cutpoint.scalars import sin


def sums(x: Any) -> Any:
    total = x[0]
    for k in range(200):
        total = total * x[1] + k
    return total


def test_a_function_too_long_for_machine_code_runs_without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backends, "MOST_COMPILED", 100)
    with pytest.raises(
        InputError, match=r"sums: 4\d\d operations per call, at most 100 compile .*; use backend='numpy'"
    ):
        compile_kernel(sums, x=2, backend="llvm")
    with pytest.raises(InputError, match=r"a stepping program: 4\d\d operations per call, at most 100 compile"):
        compile_program(Loop(1, [Stage(lambda x: [sums(x), x[1]], ("x",), ("x",))]), [Region("x", 2)], backend="llvm")
    with pytest.raises(
        InputError, match=r"three: 1\d\d operations per call, at most 100 compile \(a sine counts for 50\)"
    ):
        compile_kernel(lambda x: [sin(sin(sin(x)))], name="three", x=())
    x = np.array([0.5, 0.25])
    assert compile_kernel(sums, x=2, backend="numpy")(x) == pytest.approx(sums(x), rel=1e-13)


def test_a_function_of_too_many_numbers_is_refused_and_before_it_is_traced_where_it_takes_so_many(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(backends, "MOST_NUMBERS", 100)

    def squares(x: Any) -> Any:
        calls.append(x)
        return [[a * b for a in x] for b in x]

    calls: list[Any] = []
    with pytest.raises(InputError, match=r"squares: 110 numbers in and out, at most 100 compile; use backend"):
        compile_kernel(squares, x=10, backend="llvm")
    with pytest.raises(InputError, match=r"squares: 101 numbers"):
        compile_kernel(squares, x=101, backend="llvm")
    assert len(calls) == 1
    assert compile_kernel(squares, x=9, backend="llvm")(np.arange(9.0))[2, 3] == 6
    assert compile_kernel(squares, x=10, backend="numpy")(np.arange(10.0))[2, 3] == 6


def test_a_function_too_long_to_trace_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nodes, "MOST_TRACED", 100)
    with pytest.raises(InputError, match="more than 100 operations in one function are too many to trace; split it"):
        compile_kernel(sums, x=2, backend="numpy")

"""Functions so long that compiling them would take many minutes are refused, and told what to do."""

from typing import Any

import numpy as np
import pytest

from cutpoint.errors import InputError
from cutpoint.kernels import Loop, Region, Stage, backends, compile_program, nodes
from cutpoint.kernels import compile as compile_kernel


def sums(x: Any) -> Any:
    total = x[0]
    for k in range(200):
        total = total * x[1] + k
    return total


def test_a_function_too_long_for_machine_code_runs_without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backends, "MOST_OPERATIONS", 100)
    with pytest.raises(InputError, match=r"sums: 4\d\d operations a call, at most 100 compile; use backend='numpy'"):
        compile_kernel(sums, x=2, backend="llvm")
    with pytest.raises(InputError, match=r"a stepping program: 4\d\d operations a call, at most 100 compile"):
        compile_program(Loop(1, [Stage(lambda x: [sums(x), x[1]], ("x",), ("x",))]), [Region("x", 2)], backend="llvm")
    x = np.array([0.5, 0.25])
    assert compile_kernel(sums, x=2, backend="numpy")(x) == pytest.approx(sums(x), rel=1e-13)


def test_a_function_too_long_to_trace_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nodes, "MOST_OPERATIONS", 100)
    with pytest.raises(InputError, match="more than 100 operations in one function are too many to trace; split it"):
        compile_kernel(sums, x=2, backend="numpy")

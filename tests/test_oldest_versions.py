"""What other libraries compute is the same in the oldest versions that `pyproject.toml` allows."""

import ast
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cutpoint
from cutpoint.identification.drives.two_masses import TwoMasses

PACKAGE = Path(cutpoint.__file__).parent


def test_least_squares_state_which_singular_values_are_zero() -> None:
    # the default of NumPy 1.26 warns, and keeps what NumPy 2 takes for zero
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.linalg.lstsq":
                assert "rcond" in {each.arg for each in node.keywords}, f"{path}:{node.lineno}"


def test_right_hand_sides_are_columns_in_every_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    solve = np.linalg.solve

    def strict(A: Any, b: Any) -> Any:
        # with one dimension less than A, b is a stack of vectors in NumPy 1.26, and of columns in NumPy 2
        assert b.ndim in (1, A.ndim)
        return solve(A, b)

    monkeypatch.setattr(np.linalg, "solve", strict)
    assert TwoMasses(1.0, 0.1, 1e4, 1.0, 0.1, 0.1).position_response(np.array([5.0, 20.0, 60.0]), 1e-3).shape == (3,)

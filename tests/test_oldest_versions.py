"""What other libraries compute is the same in the oldest versions that `pyproject.toml` allows."""

import ast
from pathlib import Path

import cutpoint

PACKAGE = Path(cutpoint.__file__).parent


def test_least_squares_state_which_singular_values_are_zero() -> None:
    # the default of NumPy 1.26 warns, and keeps what NumPy 2 takes for zero
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.linalg.lstsq":
                assert "rcond" in {each.arg for each in node.keywords}, f"{path}:{node.lineno}"

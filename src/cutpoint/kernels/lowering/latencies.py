"""Approximate latencies of operations: they decide the order of operations, never their values."""

from cutpoint.kernels.graphs.nodes import ELEMENTARY

_CYCLES = {
    "input": 5, "div": 16, "sqrt": 20, "add": 3, "sub": 3, "neg": 1, "select": 2, "not": 1, "and": 1, "or": 1,
    **dict.fromkeys(ELEMENTARY, 60),
}  # fmt: skip
_OTHERS = 4


def cycles(op: str) -> int:
    """Latency of one operation."""
    return _CYCLES.get(op, _OTHERS)

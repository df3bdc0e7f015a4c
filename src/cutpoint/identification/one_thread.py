"""Linear algebra in one thread.

The matrices of a log are small, and threads wait for one another: a log of 12 s of the paper's arm took 18 s with one
thread and 27 s with two; with one of two cores busy, 26 s and 255 s.
"""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

P = ParamSpec("P")
R = TypeVar("R")


def by_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """The function, during which the BLAS of the whole process uses one thread."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with threadpool_limits(1, "blas"):
            return function(*args, **kwargs)

    return limited

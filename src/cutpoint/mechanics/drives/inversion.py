"""Inverting increasing laws in a fixed number of steps: without a branch, so that it runs on every scalar."""

from collections.abc import Callable

from cutpoint.scalars import Scalar

Law = Callable[[Scalar], Scalar]


def increasing_root(law: Law, slope: Law, value: Scalar, guess: Scalar, steps: int) -> Scalar:
    """x with law(x) = value, by Newton's method from a guess; slope must be positive wherever it leads.

    On jets each step doubles the number of derivatives that are right, beside the digits of the value.
    """
    x = guess
    for _ in range(steps):
        x = x + (value - law(x)) / slope(x)
    return x

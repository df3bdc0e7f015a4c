"""Inverting increasing laws in a fixed number of steps: without a branch, so that it runs on every scalar."""

from collections.abc import Callable

from cutpoint.scalars import Jet, Scalar, value_of

Law = Callable[[Scalar], Scalar]


def increasing_root(law: Law, slope: Law, value: Scalar, guess: Scalar, steps: int) -> Scalar:
    """x with law(x) = value, by Newton's method from a guess; slope must be positive wherever it leads.

    Of a jet the value is found first; then each further step doubles the number of derivatives that are right.
    """
    x = value_of(guess)
    for _ in range(steps):
        x = x + (value_of(value) - law(x)) / slope(x)
    orders = len(value.derivatives) - 1 if isinstance(value, Jet) else 0
    for _ in range(orders.bit_length()):
        x = x + (value - law(x)) / slope(x)
    return x

"""The completed fraction of an exponential approach."""

from cutpoint.scalars import Scalar, tanh


def saturation(x: Scalar) -> Scalar:
    """1 - exp(-x), with all digits of a small x."""
    t = tanh(x / 2)
    return 2 * t / (1 + t)

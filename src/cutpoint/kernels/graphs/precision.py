"""Precisions: the IEEE 754 formats that graphs are computed in, and their names in each target."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np


class Precision(NamedTuple):
    """A binary floating-point format.

    Attributes:
        dtype: NumPy's.
        number: a Python float in this format, rounded once.
        fraction: number of fraction bits, after the leading one.
        real: its name in LLVM.
        c: its name in C.
        suffix: C's suffix for constants, and for the names of its functions of such numbers.
    """

    dtype: np.dtype[Any]
    number: Callable[[float], Any]
    fraction: int
    real: str
    c: str
    suffix: str

    def __reduce__(self) -> str:
        return f"FLOAT{self.bits}"  # unpickles to one of those below, not to a copy

    @property
    def item(self) -> int:
        """Size of a number, bytes."""
        return self.dtype.itemsize

    @property
    def bits(self) -> int:
        return 8 * self.item

    @property
    def bias(self) -> int:
        """The exponent bias: added to an exponent it gives the bits of it; 2**(1 - bias) is the least normal number."""
        return 2 ** (self.bits - self.fraction - 2) - 1

    @property
    def magic(self) -> float:
        """Added to a number of at most 2**(fraction - 2) it rounds to an integer, whose bits are the sum's lowest."""
        return 1.5 * 2.0**self.fraction

    def rounded(self, x: float) -> float:
        """A constant in this format; infinite on overflow, zero on underflow."""
        with np.errstate(all="ignore"):
            return float(self.number(x))


FLOAT64 = Precision(np.dtype(np.float64), float, 52, "double", "double", "")
FLOAT32 = Precision(np.dtype(np.float32), np.float32, 23, "float", "float", "f")
PRECISIONS = {"float64": FLOAT64, "float32": FLOAT32}

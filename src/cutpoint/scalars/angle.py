"""An angle whose sine and cosine are at hand."""

from dataclasses import dataclass
from typing import Any

from cutpoint.scalars.functions import Scalar, cos, sin


@dataclass(frozen=True, slots=True)
class Angle:
    """A scalar to `sin` and `cos`; other angles (rad) may be added to it, and it does nothing else."""

    sine: Any
    cosine: Any

    def sin(self) -> Any:
        return self.sine

    def cos(self) -> Any:
        return self.cosine

    def __add__(self, other: Scalar) -> "Angle":
        c, s = cos(other), sin(other)
        return Angle(self.sine * c + self.cosine * s, self.cosine * c - self.sine * s)

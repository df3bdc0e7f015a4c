"""An angle with precomputed sine and cosine."""

from dataclasses import dataclass
from typing import Any

from cutpoint.scalars.functions import Scalar, cos, sin


@dataclass(frozen=True, slots=True)
class Angle:
    """A scalar for `sin` and `cos` only, to which other angles (rad) may be added."""

    sine: Any
    cosine: Any

    def sin(self) -> Any:
        return self.sine

    def cos(self) -> Any:
        return self.cosine

    def __add__(self, other: Scalar) -> "Angle":
        c, s = cos(other), sin(other)
        return Angle(self.sine * c + self.cosine * s, self.cosine * c - self.sine * s)

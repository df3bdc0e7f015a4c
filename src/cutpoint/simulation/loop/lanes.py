"""Layout of the numbers of uniform drives, side by side: field by field, each padded to the SIMD width."""

from dataclasses import dataclass
from typing import Any

WIDEST = 8
"""Numbers that a wide register holds; more drives take several."""


@dataclass(frozen=True)
class Lanes:
    """n drives in `width` lanes.  A width of 1: drives are not uniform, and nothing is padded."""

    n: int
    width: int

    @classmethod
    def of(cls, n: int, alike: bool) -> "Lanes":
        """The narrowest padding for n drives."""
        if not alike:
            return cls(n, 1)
        width = next((k for k in (1, 2, 4, WIDEST) if k >= n), WIDEST * -(-n // WIDEST))
        return cls(n, width)

    @property
    def are_wide(self) -> bool:
        return self.width > 1

    def size(self, count: int) -> int:
        """Length of `count` fields, padding included."""
        return count // self.n * self.width if self.are_wide else count

    def dense(self, numbers: Any) -> list[Any]:
        """Without padding."""
        if not self.are_wide:
            return [*numbers]
        return [x for start in range(0, len(numbers), self.width) for x in numbers[start : start + self.n]]

    def padded(self, numbers: Any, *, repeat: bool = False) -> list[Any]:
        """With it: zeros, or the last drive's numbers again."""
        if not self.are_wide:
            return [*numbers]
        fields = [[*numbers[start : start + self.n]] for start in range(0, len(numbers), self.n)]
        return [x for field in fields for x in (*field, *[field[-1] if repeat else 0.0] * (self.width - self.n))]

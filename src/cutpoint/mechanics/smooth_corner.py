"""A slope that goes from 0 to 1 over a corner as a cubic, so that what it is the slope of has two derivatives more."""

from dataclasses import dataclass

from cutpoint.scalars import Scalar, clip, maximum


@dataclass(frozen=True)
class SmoothCorner:
    """start: the deflection where the slope begins to rise, rad (m).  width: over which it does, rad (m)."""

    start: Scalar
    width: Scalar

    def progress(self, x: Scalar) -> Scalar:
        """u: 0 before the corner, 1 behind it."""
        return clip((x - self.start) * (1 / self.width), 0, 1)

    def slope(self, x: Scalar) -> Scalar:
        """3 u^2 - 2 u^3."""
        u = self.progress(x)
        return u * u * (3 - 2 * u)

    def ramp(self, x: Scalar) -> Scalar:
        """The slope's integral, which goes on with slope 1."""
        u = self.progress(x)
        return self.width * (u * u * u) * (1 - u / 2) + maximum(x - self.start - self.width, 0)

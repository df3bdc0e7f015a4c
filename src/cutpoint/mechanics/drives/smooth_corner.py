"""A slope that rises from 0 to 1 over a corner as a cubic, so that its integral has two continuous derivatives."""

from dataclasses import dataclass

from cutpoint.scalars import Scalar, clip, maximum


@dataclass(frozen=True)
class SmoothCorner:
    """start: the deflection where the slope begins to rise, rad (m).  width: of the rise, rad (m)."""

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
        """The slope's integral, which continues with slope 1."""
        u = self.progress(x)
        return self.width * (u * u * u) * (1 - u / 2) + maximum(x - self.start - self.width, 0)

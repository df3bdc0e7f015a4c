"""A drive's stiffness curve from its catalogue: K1 up to T1, K2 up to T2, K3 beyond, with rounded corners."""

from collections.abc import Iterator
from dataclasses import dataclass

from cutpoint.mechanics.drives.inversion import increasing_root
from cutpoint.mechanics.drives.smooth_corner import SmoothCorner
from cutpoint.scalars import Scalar, absolute, clip, maximum, where

BLEND = 0.25
"""Half the width over which both corners are rounded, in units of the shorter of the two segments before the second."""


@dataclass(frozen=True)
class CatalogueSpring:
    """Stiffness k1, k2, k3 in N m/rad (N/m) in the torque ranges below t1, up to t2 and beyond, in N m (N).

    The straight segments are the catalogue's; around their corners a cubic blends the stiffnesses, so that the torque
    has two continuous derivatives.  Harmonic Drive, engineering data, section "torsional stiffness".
    """

    k1: Scalar
    k2: Scalar
    k3: Scalar
    t1: Scalar
    t2: Scalar

    def torque(self, deflection: Scalar) -> Scalar:
        """Torque, N m (N), at a deflection in rad (m)."""
        size = absolute(deflection)
        torque = self.k1 * size
        for gain, corner in self._corners():
            torque = torque + gain * corner.ramp(size)
        return where(deflection < 0, -torque, torque)

    def deflection(self, torque: Scalar) -> Scalar:
        """The inverse law: five Newton steps from the straight segments; to 1e-13 for stiffness ratios up to 15."""
        return increasing_root(self.torque, self.tangent, torque, self.straight_deflection(torque), steps=5)

    def straight_deflection(self, torque: Scalar) -> Scalar:
        """Deflection by the catalogue's straight segments, rad (m)."""
        deflection = torque / self.k1
        for t, stiffness, before in ((self.t1, self.k2, self.k1), (self.t2, self.k3, self.k2)):
            deflection = deflection + (torque - clip(torque, -t, t)) * (1 / stiffness - 1 / before)
        return deflection

    @property
    def steepest_corner(self) -> float:
        """The largest stiffness ratio of neighbouring segments."""
        return float(max(self.k1 / self.k2, self.k2 / self.k1, self.k2 / self.k3, self.k3 / self.k2))

    def tangent(self, deflection: Scalar) -> Scalar:
        """d torque / d deflection, N m/rad."""
        size, stiffness = absolute(deflection), self.k1
        for gain, corner in self._corners():
            stiffness = stiffness + gain * corner.slope(size)
        return stiffness

    def energy(self, deflection: Scalar) -> Scalar:
        """Stored energy, J."""
        size = absolute(deflection)
        energy = self.k1 * size * size / 2
        for gain, corner in self._corners():
            width = corner.width
            u, beyond = corner.progress(size), maximum(size - corner.start - width, 0)
            within = width * width * (u * u * u * u) * (5 - 2 * u) / 20
            energy = energy + gain * (within + beyond * (width + beyond) / 2)
        return energy

    @property
    def fit_error(self) -> Scalar:
        """Largest departure from the catalogue's straight segments, N m: at the corners."""
        gaps = [absolute(gain) * corner.width * 3 / 32 for gain, corner in self._corners()]
        return maximum(gaps[0], gaps[1])

    def _corners(self) -> Iterator[tuple[Scalar, SmoothCorner]]:
        """The change of stiffness at each corner, and its rounding over deflections, rad."""
        first, second = self.t1 / self.k1, (self.t2 - self.t1) / self.k2
        half = BLEND * where(first < second, first, second)
        yield self.k2 - self.k1, SmoothCorner(first - half, 2 * half)
        yield self.k3 - self.k2, SmoothCorner(first + second - half, 2 * half)

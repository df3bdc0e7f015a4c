"""The wave generator's compliance, and that of flexspline and wave generator in series.  Xia (2019) eqs. (2)-(3)."""

import math
from dataclasses import dataclass

from cutpoint.mechanics.drives.compliance import Flexspline
from cutpoint.mechanics.drives.inversion import increasing_root
from cutpoint.mechanics.drives.saturation import saturation
from cutpoint.scalars import Scalar, absolute, clip, exp, maximum, minimum, where

TERMS = 20
"""Of a series up to 1; the first that is left out is 20 / 21!, a hundredth of the last bit."""


@dataclass(frozen=True)
class WaveGenerator:
    """sgn(tau_w) (1 - exp(-c_w |tau_w|)) / (c_w l K_w0) at the joint's side, tau_w = tau_f / l.  Xia (2019) eq. (3).

    stiffness is K_w0 (N m/rad at the wave generator, at rest), hardening c_w (1/(N m)), ratio l.  The printed law has a
    kink in its slope at zero; below `blend` (N m at the wave generator) it is replaced by an odd quintic that
    matches its value and two derivatives.
    """

    stiffness: Scalar
    hardening: Scalar
    ratio: Scalar
    blend: Scalar

    def deflection(self, torque: Scalar) -> Scalar:
        """Deflection at the joint's side, rad, under a joint torque, N m."""
        x, u = self._scaled(torque)
        a, b, c = self._quintic()
        inside, outside = u * (a + u * u * (b + u * u * c)), saturation(maximum(absolute(x), self._edge))
        whole = where(absolute(x) < self._edge, inside, where(x < 0, -outside, outside))
        return whole / (self.hardening * self.ratio * self.stiffness)

    def compliance(self, torque: Scalar) -> Scalar:
        """d deflection / d torque, rad/(N m)."""
        x, u = self._scaled(torque)
        a, b, c = self._quintic()
        inside = (a + u * u * (3 * b + u * u * (5 * c))) / self._edge
        slope = where(absolute(x) < self._edge, inside, exp(-maximum(absolute(x), self._edge)))
        return slope / (self.ratio * self.ratio * self.stiffness)

    def energy(self, torque: Scalar) -> Scalar:
        """Energy stored at a joint torque, J: the integral of torque over deflection."""
        _, u = self._scaled(torque)
        a, b, c = self._quintic()
        size = maximum(absolute(torque / self.ratio), self.blend)
        within = self.blend * (u * u) * (a / 2 + u * u * (3 * b / 4 + u * u * (5 * c / 6))) / self.hardening
        beyond = size * size * _stored(self.hardening * size) - self.blend * self.blend * _stored(self._edge)
        return (within + beyond) / self.stiffness

    @property
    def _edge(self) -> Scalar:
        """Where the blend ends, in units of c_w tau_w."""
        return self.hardening * self.blend

    def _scaled(self, torque: Scalar) -> tuple[Scalar, Scalar]:
        """c_w tau_w, and its fraction of the blend, -1 to 1."""
        x = torque * (self.hardening / self.ratio)
        return x, clip(x / self._edge, -1, 1)

    def _quintic(self) -> tuple[Scalar, Scalar, Scalar]:
        """Coefficients of u, u^3, u^5 that meet 1 - exp(-x) at the edge with two derivatives."""
        edge = self._edge
        slope, value = edge * exp(-edge), saturation(edge)
        c = -(edge * slope + 3 * (slope - value)) / 8
        b = (slope - value) / 2 - 2 * c
        return value - b - c, b, c


def _stored(x: Scalar) -> Scalar:
    """The integral of t exp(-t) from 0 to x, over x^2: by its series where 1 - (1 + x) exp(-x) would cancel."""
    near, far, series = minimum(x, 1), maximum(x, 1), 0
    for k in range(TERMS, 1, -1):
        series = (k - 1) / math.factorial(k) - near * series
    return where(x < 1, series, (1 - (1 + far) * exp(-far)) / (far * far))


@dataclass(frozen=True)
class HarmonicSpring:
    """Flexspline (2) and wave generator (3) in series, at the joint's side.  Xia (2019) eqs. (2)-(3)."""

    flexspline: Flexspline
    wave_generator: WaveGenerator

    def deflection(self, torque: Scalar) -> Scalar:
        """Deflection, rad, at a torque in N m: the sum of both.  Xia (2019) eqs. (2)-(3)."""
        return self.flexspline.deflection(torque) + self.wave_generator.deflection(torque)

    def torque(self, deflection: Scalar) -> Scalar:
        """Torque, N m, at a deflection in rad, in eight Newton steps: compliance falls with load, so none overshoots.

        Lower bounds are the line with the slope at rest, and the flexspline's torque at the deflection less the wave
        generator's largest one.  Eight steps suffice for a wave generator at least a tenth as stiff as the flexspline
        at rest.
        """
        wave, size = self.wave_generator, absolute(deflection)
        most = 1 / (wave.hardening * wave.ratio * wave.stiffness)
        least = maximum(size / self._compliance(0 * deflection), self.flexspline.torque(maximum(size - most, 0)))
        start = where(deflection < 0, -least, least)
        return increasing_root(self.deflection, self._compliance, deflection, start, steps=8)

    def tangent(self, deflection: Scalar) -> Scalar:
        """d torque / d deflection, N m/rad."""
        return 1 / self._compliance(self.torque(deflection))

    def energy(self, deflection: Scalar) -> Scalar:
        """Stored energy of both, J, at their common torque."""
        torque = self.torque(deflection)
        return self.flexspline.energy(self.flexspline.deflection(torque)) + self.wave_generator.energy(torque)

    def _compliance(self, torque: Scalar) -> Scalar:
        return 1 / self.flexspline.tangent(self.flexspline.deflection(torque)) + self.wave_generator.compliance(torque)

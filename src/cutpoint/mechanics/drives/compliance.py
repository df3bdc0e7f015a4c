"""Spring laws between motor and link, at the joint's side: torque as a function of deflection, and its inverse.

Deflection in rad (m), torque in N m (N).  Every law is odd and strictly increasing, and its inverse is exact.
Divisions by a drive's numbers are written as factors, whose reciprocals are computed once.
"""

from dataclasses import dataclass

from cutpoint.scalars import Scalar, atan, clip, log, tan, tanh

POLE_GUARD = 1.5
"""Where law (2) is continued by its tangent, in units of c_f K_f0 deflection; the pole is at pi/2."""

_TAN, _SECANT2 = 14.101419947171719, 199.85004452649767
"""tan(POLE_GUARD) and 1 + its square, as literals: tan differs in its last bit from one C library to another."""


@dataclass(frozen=True)
class LinearSpring:
    """tau_f = stiffness * deflection; stiffness in N m/rad (N/m).  Spong (1987)."""

    stiffness: Scalar

    def torque(self, deflection: Scalar) -> Scalar:
        """Torque, N m, at a deflection in rad."""
        return self.stiffness * deflection

    def deflection(self, torque: Scalar) -> Scalar:
        """Deflection, rad, at a torque in N m."""
        return torque * (1 / self.stiffness)

    def tangent(self, deflection: Scalar) -> Scalar:
        """d torque / d deflection, N m/rad."""
        return self.stiffness + 0 * deflection

    def energy(self, deflection: Scalar) -> Scalar:
        """Stored energy, J."""
        return self.stiffness * deflection * deflection / 2


@dataclass(frozen=True)
class Flexspline:
    """Hardening flexspline, tau_f = tan(deflection c_f K_f0) / c_f.  Xia (2019) eq. (2).

    stiffness is K_f0 (N m/rad, at rest), hardening is c_f (1/(N m)): how fast it stiffens with load.
    Beyond POLE_GUARD the law continues along its tangent: 200 times the rest stiffness is beyond any real drive, and a
    simulation that strays there stays finite.
    """

    stiffness: Scalar
    hardening: Scalar

    def torque(self, deflection: Scalar) -> Scalar:
        """tau_f of the deflection.  Xia (2019) eq. (2)."""
        x = deflection * (self.hardening * self.stiffness)
        inside = clip(x, -POLE_GUARD, POLE_GUARD)
        return (tan(inside) + _SECANT2 * (x - inside)) * (1 / self.hardening)

    def deflection(self, torque: Scalar) -> Scalar:
        """The inverse law, atan(c_f tau_f) / (c_f K_f0).  Xia (2019) eq. (2)."""
        y = torque * self.hardening
        inside = clip(y, -_TAN, _TAN)
        return (atan(inside) + (y - inside) * (1 / _SECANT2)) * (1 / (self.hardening * self.stiffness))

    def tangent(self, deflection: Scalar) -> Scalar:
        """d torque / d deflection, N m/rad."""
        x = tan(clip(deflection * (self.hardening * self.stiffness), -POLE_GUARD, POLE_GUARD))
        return self.stiffness * (1 + x * x)

    def energy(self, deflection: Scalar) -> Scalar:
        """Stored energy, J: the integral of the torque, -ln cos(c_f K_f0 deflection) / (c_f^2 K_f0)."""
        x = deflection * (self.hardening * self.stiffness)
        inside = clip(x, -POLE_GUARD, POLE_GUARD)
        beyond, slope = x - inside, tan(inside)
        stored = _log1p(slope * slope) / 2 + slope * beyond + _SECANT2 * beyond * beyond / 2
        return stored / (self.hardening * self.hardening * self.stiffness)


def _log1p(y: Scalar) -> Scalar:
    """ln(1 + y), y not negative, with all digits of a small y: one Newton step on tanh(x/2) = y / (2 + y)."""
    x = log(1 + y)
    half = tanh(x / 2)
    return x - 2 * (half - y / (2 + y)) / (1 - half * half)

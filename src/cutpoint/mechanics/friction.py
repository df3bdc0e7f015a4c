"""Friction laws: the torque that opposes a speed, at the joint's side.

sgn is smoothed to tanh(speed / smoothing): it creeps below that speed and never holds; a larger value is gentler on
integrators, a smaller one truer.  Speeds in rad/s (m/s), torques in N m (N).
"""

from dataclasses import dataclass

from cutpoint.scalars import Scalar, exp, tanh


@dataclass(frozen=True)
class Stribeck:
    """xi = [f_c + (f_s - f_c) exp(-(speed/v_s)^2)] sgn(speed) + f_v speed.  Xia (2019) eq. (54).

    coulomb f_c and static f_s in N m, viscous f_v in N m s/rad, stribeck_velocity v_s and smoothing in rad/s.
    """

    coulomb: Scalar
    static: Scalar
    viscous: Scalar
    stribeck_velocity: Scalar
    smoothing: Scalar

    def torque(self, speed: Scalar) -> Scalar:
        x = speed / self.stribeck_velocity
        dry = self.coulomb + (self.static - self.coulomb) * exp(-(x * x))
        return dry * tanh(speed / self.smoothing) + self.viscous * speed


@dataclass(frozen=True)
class Coulomb:
    """xi = f_c sgn(speed) + f_v speed.  Xia (2019) eq. (55), with a viscous part.

    coulomb f_c in N m, viscous f_v in N m s/rad, smoothing in rad/s.
    """

    coulomb: Scalar
    viscous: Scalar
    smoothing: Scalar

    def torque(self, speed: Scalar) -> Scalar:
        return self.coulomb * tanh(speed / self.smoothing) + self.viscous * speed

"""Kinematic error: what a drive's output deviates from ratio-true rotation, a sum of harmonics of the wave generator.

Its reaction on the motor follows from power: the spring's torque works on the deflection theta - q - e(theta), so the
motor bears tau_f (1 - e'(theta)).  Tuttle and Seering (1996); theta_err in Xia (2019) eq. (3).
"""

from dataclasses import dataclass

from cutpoint.mechanics.inversion import increasing_root
from cutpoint.scalars import Scalar, cos, sin


@dataclass(frozen=True)
class Harmonic:
    """amplitude (rad at the joint's side) of sin(order theta_w + phase), theta_w being the wave generator's angle."""

    order: int
    amplitude: Scalar
    phase: Scalar = 0.0


@dataclass(frozen=True)
class KinematicError:
    """e(theta) in rad at the joint's side.  Two waves a turn of the wave generator dominate in harmonic drives."""

    harmonics: tuple[Harmonic, ...]

    def value(self, theta: Scalar, ratio: Scalar) -> Scalar:
        """e(theta), with the wave generator at ratio * theta."""
        parts = [h.amplitude * sin(h.order * (ratio * theta) + h.phase) for h in self.harmonics]
        return sum(parts[1:], parts[0])

    def slope(self, theta: Scalar, ratio: Scalar) -> Scalar:
        """e'(theta)."""
        parts = [(h.order * ratio * h.amplitude) * cos(h.order * (ratio * theta) + h.phase) for h in self.harmonics]
        return sum(parts[1:], parts[0])

    def steepest(self, ratio: float) -> float:
        """A bound of |e'|: at 1 the output could stand still while the motor turns."""
        return sum(abs(h.order * ratio * h.amplitude) for h in self.harmonics)

    def motor_position(self, output: Scalar, ratio: Scalar) -> Scalar:
        """theta with theta - e(theta) = output, in eight Newton steps."""
        return increasing_root(
            lambda theta: theta - self.value(theta, ratio),
            lambda theta: 1 - self.slope(theta, ratio),
            output,
            output,
            steps=8,
        )

"""Kinematic error: how far a drive's unloaded output lags ratio-true rotation, harmonics of the wave generator.

Its reaction on the motor follows from power: the spring's torque works on the deflection theta - q - e(theta), so the
motor's load is tau_f (1 - e'(theta)).  Tuttle and Seering (1996); theta_err in Xia (2019) eq. (3).
"""

from dataclasses import dataclass

from cutpoint.mechanics.drives.harmonics import series, series_slope
from cutpoint.mechanics.drives.inversion import increasing_root
from cutpoint.model.drive import Harmonic
from cutpoint.scalars import Scalar


@dataclass(frozen=True)
class KinematicError:
    """e(theta) in rad at the joint's side.  Two waves per turn of the wave generator dominate in harmonic drives.

    The harmonics' amplitudes are in rad at the joint's side.
    """

    harmonics: tuple[Harmonic, ...]

    def value(self, theta: Scalar, ratio: Scalar) -> Scalar:
        """e(theta), rad, with the wave generator at ratio * theta."""
        return series(self.harmonics, ratio * theta)

    def slope(self, theta: Scalar, ratio: Scalar) -> Scalar:
        """e'(theta), rad/rad."""
        return ratio * series_slope(self.harmonics, ratio * theta)

    def steepest(self, ratio: float) -> float:
        """An upper bound of |e'|: at 1 the output could stand still while the motor turns."""
        return sum(abs(h.order * ratio * h.amplitude) for h in self.harmonics)

    def motor_position(self, output: Scalar, ratio: Scalar) -> Scalar:
        """theta, rad, with theta - e(theta) = output, in eight Newton steps."""
        return increasing_root(
            lambda theta: theta - self.value(theta, ratio),
            lambda theta: 1 - self.slope(theta, ratio),
            output,
            output,
            steps=8,
        )

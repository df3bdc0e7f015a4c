"""One joint's channels, and the rotor that they show with a known torque on its link."""

from dataclasses import dataclass

from cutpoint.arrays import Array
from cutpoint.identification.drives.joint_torques import transmitted_share
from cutpoint.identification.drives.rotor import RotorEstimate, motor_side
from cutpoint.identification.drives.spring_estimate import SpringEstimate


@dataclass(frozen=True, eq=False)
class Channels:
    """One joint's, each (N,): theta, q in rad; effort, the motor's torque in N m less its known friction beyond
    Coulomb's, or current in A.

    link_torque: required by the link, and link_friction: as stated, N m.
    sliding: (N, 2), the link's direction of motion, and its speed in rad/s.  period, delay: s.
    """

    theta: Array
    q: Array
    effort: Array
    link_torque: Array
    link_friction: Array
    sliding: Array
    period: float
    delay: float
    is_current: bool

    def rotor(
        self, ratio: float, spring: SpringEstimate, load: Array, cutoff: float, delay: float | None
    ) -> RotorEstimate:
        """The rotor from the motor's torque or current.  load: (N,), N m, of the drive on the link."""
        effort = {"current" if self.is_current else "torque": self.effort}
        share = transmitted_share(spring, self.theta, ratio)
        return motor_side(
            self.theta, load, self.period, ratio, transmission=share, cutoff=cutoff, delay=delay, **effort
        )

    def motor_torque(self, rotor: RotorEstimate) -> Array:
        """(N,), N m at the joint."""
        constant = rotor.torque_constant
        return self.effort if constant is None else self.effort * constant * rotor.ratio

"""Backlash: play in a gear before its spring is loaded.  Harmonic drives have none; gears before or after them may."""

from dataclasses import dataclass

from cutpoint.mechanics.drives.inversion import increasing_root
from cutpoint.mechanics.drives.smooth_corner import SmoothCorner
from cutpoint.model.drive import Compliance
from cutpoint.scalars import Scalar, absolute, where

SLACK = 0.03
"""What of a deflection within the play reaches the spring; of its stiffness there is left the square of that."""

EDGE = 0.1
"""Half the width over which contact sets in, in units of half the play."""


@dataclass(frozen=True)
class Backlash:
    """A spring behind a play of `gap` (rad from flank to flank, at the joint's side).

    The spring is wound by w(deflection), which is nearly constant within the play and follows the deflection beyond
    it; the torque is spring.torque(w) w', so that the spring's energy is the drive's.  w has a small slope within the
    play too; otherwise the torque would not determine the deflection there.
    """

    spring: Compliance
    gap: Scalar

    def torque(self, deflection: Scalar) -> Scalar:
        """Torque, N m, at a deflection in rad: spring.torque(w) w'."""
        wound, passed = self._wound(deflection)
        return self.spring.torque(wound) * passed

    def deflection(self, torque: Scalar) -> Scalar:
        """The inverse law: exact within and beyond the play, by Newton's method over its edge."""
        within, beyond = self.spring.deflection(torque / SLACK) / SLACK, self.spring.deflection(torque)
        shift = (1 - SLACK) * self.gap / 2
        crossed = where(torque < 0, beyond - shift, beyond + shift)
        guess = where(absolute(within) < self.gap * (1 - EDGE) / 2, within, crossed)
        return increasing_root(self.torque, self.tangent, torque, guess, steps=12)

    def tangent(self, deflection: Scalar) -> Scalar:
        """d torque / d deflection, N m/rad."""
        wound, passed = self._wound(deflection)
        return self.spring.tangent(wound) * passed * passed + self.spring.torque(wound) * self._bend(deflection)

    def energy(self, deflection: Scalar) -> Scalar:
        """Stored energy, J."""
        return self.spring.energy(self._wound(deflection)[0])

    def _wound(self, deflection: Scalar) -> tuple[Scalar, Scalar]:
        """w and w', an odd function: a cubic blends slope SLACK into slope 1 at the edge."""
        size, edge = absolute(deflection), self._edge
        wound = SLACK * size + (1 - SLACK) * edge.ramp(size)
        return where(deflection < 0, -wound, wound), SLACK + (1 - SLACK) * edge.slope(size)

    def _bend(self, deflection: Scalar) -> Scalar:
        """w''."""
        u = self._edge.progress(absolute(deflection))
        bend = (1 - SLACK) * 6 * u * (1 - u) / self._edge.width
        return where(deflection < 0, -bend, bend)

    @property
    def _edge(self) -> SmoothCorner:
        """The deflection where the play ends."""
        width = self.gap * EDGE
        return SmoothCorner(self.gap / 2 - width / 2, width)


def spring_of(law: Compliance | None) -> Compliance | None:
    """The spring behind the play, if there is play before it."""
    return law.spring if isinstance(law, Backlash) else law

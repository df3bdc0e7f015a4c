"""Hysteresis of a drive's spring: elements that stretch with its deflection and slip, in parallel to it.

Rate-independent: the torque depends on the path of the deflection, not on its speed.  Minor loops close, and what an
element gives back is never more than what wound it up.  Strains in rad (m), torques in N m (N), at the joint's side.
"""

from dataclasses import dataclass
from typing import Any

from cutpoint.errors import InputError
from cutpoint.model.drive import Compliance, Hysteresis
from cutpoint.scalars import Scalar, clip, where


@dataclass(frozen=True)
class MaxwellSlip:
    """Elements of `stiffness` (N m/rad) that slip beyond a strain of `reach` (rad).  Iwan (1966).

    In parallel to a spring K they open its loop by `loss` = 2 sum(stiffness reach) / K at zero torque, if both ends of
    the loop are beyond all reaches: what catalogues call hysteresis loss.
    """

    stiffness: tuple[Scalar, ...]
    reach: tuple[Scalar, ...]

    @classmethod
    def smooth(cls, torque: float, reach: float, elements: int = 4) -> "MaxwellSlip":
        """Elements whose torque grows as W (2 x - x^2), x = strain / reach, to W = `torque` (N m) at `reach` (rad).

        Its chords between the elements' reaches: the last element is half as stiff as the others.
        Raises InputError for a reach that is not positive, or a number of elements that is not whole or below 1.
        """
        if not (reach > 0 and elements >= 1 and elements % 1 == 0):
            told = f"MaxwellSlip.smooth: reach {reach} must be positive, elements {elements} a whole number from 1"
            raise InputError(told, reach=reach, elements=elements)
        elements = int(elements)
        each = 2 * torque / (reach * elements)
        stiffness = (*[each] * (elements - 1), each / 2)
        return cls(stiffness, tuple(reach * ((k + 1) / elements) for k in range(elements)))

    def strains(self, before: tuple[Scalar, ...], displacement: Scalar) -> tuple[Scalar, ...]:
        """Strains after the deflection has changed by this much, in one direction, rad."""
        return tuple(clip(s + displacement, -r, r) for s, r in zip(before, self.reach, strict=True))

    def torque(self, strains: tuple[Scalar, ...]) -> Scalar:
        """What the elements add to the spring's torque, N m."""
        return _sum([k * s for k, s in zip(self.stiffness, strains, strict=True)])

    def sticking(self, strains: tuple[Scalar, ...], direction: Scalar) -> Scalar:
        """Stiffness of the elements that do not slip when the deflection goes on in a direction, 1 or -1; N m/rad."""
        parts = zip(self.stiffness, self.reach, strains, strict=True)
        return _sum([where(direction * s < r, k, 0) for k, r, s in parts])

    def energy(self, strains: tuple[Scalar, ...]) -> Scalar:
        """Energy that the elements hold, J."""
        return _sum([k * s * s / 2 for k, s in zip(self.stiffness, strains, strict=True)])

    @property
    def friction(self) -> Scalar:
        """Torque when all elements slip, N m."""
        return self.torque(self.reach)


def loss_of(law: Hysteresis, spring: Compliance) -> Scalar:
    """How wide the loops of a spring are at zero torque, rad, if both ends are beyond all reaches."""
    return 2 * spring.deflection(law.torque(law.reach))


def _sum(parts: list[Any]) -> Any:
    return sum(parts[1:], parts[0])

"""Hysteresis of a drive's spring: slipping elastic elements in parallel to it.

Rate-independent: the torque depends on the path of the deflection, not on its speed.  Minor loops close, and an element
never returns more energy than was put in.  Strains in rad (m), torques in N m (N), at the joint's side.
"""

from dataclasses import dataclass
from typing import Any

from cutpoint.door import number, whole
from cutpoint.errors import InputError
from cutpoint.model.drive import Compliance, Hysteresis
from cutpoint.scalars import Scalar, clip, where

MOST_ELEMENTS = 1000


@dataclass(frozen=True)
class MaxwellSlip:
    """Elements of `stiffness` (N m/rad) that slip beyond a strain of `reach` (rad).  Iwan (1966).

    In parallel to a spring K they give its loop the width `loss` = 2 sum(stiffness reach) / K at zero torque, if both
    ends of the loop are beyond all reaches: the hysteresis loss of catalogues.
    """

    stiffness: tuple[Scalar, ...]
    reach: tuple[Scalar, ...]

    @classmethod
    def smooth(cls, torque: float, reach: float, elements: int = 4) -> "MaxwellSlip":
        """Elements whose torque grows as W (2 x - x^2), x = strain / reach, to W = `torque` (N m) at `reach` (rad).

        Approximated by chords between the elements' reaches: the last element is half as stiff as the others.
        Raises InputError for a torque or reach that is not positive, or elements that are no whole number from 1 to
        MOST_ELEMENTS.
        """
        torque = number("MaxwellSlip.smooth", "torque", torque, "N m")
        reach = number("MaxwellSlip.smooth", "reach", reach, "rad")
        elements = whole("MaxwellSlip.smooth", "elements", elements)
        if not (torque > 0 and reach > 0 and elements <= MOST_ELEMENTS):
            told = f"torque {torque} N m and reach {reach} rad must be positive, elements {elements} at most"
            raise InputError(
                f"MaxwellSlip.smooth: {told} {MOST_ELEMENTS}", torque=torque, reach=reach, elements=elements
            )
        each = 2 * torque / (reach * elements)
        stiffness = (*[each] * (elements - 1), each / 2)
        return cls(stiffness, tuple(reach * ((k + 1) / elements) for k in range(elements)))

    def strains(self, before: tuple[Scalar, ...], displacement: Scalar) -> tuple[Scalar, ...]:
        """Strains after the deflection has changed by this much, in one direction, rad."""
        return tuple(clip(s + displacement, -r, r) for s, r in zip(before, self.reach, strict=True))

    def torque(self, strains: tuple[Scalar, ...]) -> Scalar:
        """Torque of the elements, added to the spring's, N m."""
        return _sum([k * s for k, s in zip(self.stiffness, strains, strict=True)])

    def sticking(self, strains: tuple[Scalar, ...], direction: Scalar) -> Scalar:
        """Stiffness of the elements that stick while the deflection moves in a direction, 1 or -1; N m/rad."""
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
    """Width of a spring's loops at zero torque, rad, if both ends are beyond all reaches."""
    return 2 * spring.deflection(law.torque(law.reach))


def _sum(parts: list[Any]) -> Any:
    return sum(parts[1:], parts[0])

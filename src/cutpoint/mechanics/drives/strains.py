"""Internal states of drives: strains of friction bristles and hysteresis elements, and their update by motion.

Strains follow displacements.  Over a short motion between two states they are functions of both ends and of the strains
at the first: an integrator updates them without a derivative.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from cutpoint.mechanics.drives.harmonic_drive import DriveState, deflection, transmitted_torque
from cutpoint.mechanics.drives.presliding import Presliding
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar


class Strains(NamedTuple):
    """Strains of one drive, rad (m): link-side and motor-side friction, and the spring's elements; None if unknown."""

    link: Any = None
    motor: Any = None
    spring: tuple[Any, ...] | None = None


UNKNOWN = Strains()
"""Friction as in steady sliding, and no hysteresis."""


def or_unknown(strains: Sequence[Strains] | None, drives: Sequence[Any]) -> Sequence[Strains]:
    """Those of each drive, or none known."""
    return [UNKNOWN] * len(drives) if strains is None else strains


def count(drive: Drive) -> int:
    """How many strains a drive has."""
    return len(names(drive))


def names(drive: Drive) -> list[str]:
    """Names of a drive's strains, in order."""
    sides = (("link friction", drive.link_friction), ("motor friction", drive.motor_friction))
    found = [side for side, law in sides if isinstance(law, Presliding)]
    return found + [f"hysteresis {k + 1}" for k in range(len(drive.hysteresis.reach) if drive.hysteresis else 0)]


def taken(drive: Drive, numbers: Iterator[Scalar]) -> Strains:
    """A drive's strains from a flat list."""
    laws = drive.link_friction, drive.motor_friction
    link, motor = (next(numbers) if isinstance(law, Presliding) else None for law in laws)
    spring = tuple(next(numbers) for _ in drive.hysteresis.reach) if drive.hysteresis else None
    return Strains(link, motor, spring)


def flat(strains: Strains) -> list[Scalar]:
    """A drive's strains in one list."""
    return [x for x in (strains.link, strains.motor, *(strains.spring or ())) if x is not None]


def moved(drive: Drive, before: Strains, start: DriveState, end: DriveState) -> Strains:
    """Strains after a motion without reversal.

    Exact for elements of hysteresis; for bristles exact if the breakaway strain varies linearly along the motion, and
    otherwise to second order in its length.
    """
    spring = before.spring
    if drive.hysteresis and spring is not None:
        wound = deflection(drive, end.theta, end.q) - deflection(drive, start.theta, start.q)
        spring = drive.hysteresis.strains(spring, wound)
    link, motor = before.link, before.motor
    if isinstance(drive.link_friction, Presliding):
        link = drive.link_friction.strain(link, end.q - start.q, end.v, halfway=((start.v + end.v) / 2, 0))
    if isinstance(drive.motor_friction, Presliding):
        load = half = 0
        if drive.is_elastic:
            load = transmitted_torque(drive, end, spring)
            half = (transmitted_torque(drive, start, before.spring) + load) / 2
        halfway = (start.theta_dot + end.theta_dot) / 2, half
        motor = drive.motor_friction.strain(motor, end.theta - start.theta, end.theta_dot, load, halfway)
    return Strains(link, motor, spring)


def rates(drive: Drive, strains: Strains, at: DriveState, load: Scalar) -> list[Scalar]:
    """d strain / dt of the bristles, rad/s; 0 for elements of hysteresis, which `moved` updates exactly."""
    found: list[Scalar] = []
    if isinstance(drive.link_friction, Presliding):
        found.append(drive.link_friction.winding(strains.link, at.v) * at.v)
    if isinstance(drive.motor_friction, Presliding):
        found.append(drive.motor_friction.winding(strains.motor, at.theta_dot, load) * at.theta_dot)
    return found + [0] * len(strains.spring or ())


def strain_energy(drive: Drive, strains: Strains) -> Scalar:
    """Energy stored in bristles and elements of hysteresis, J."""
    total: Scalar = 0
    for law, strain in ((drive.link_friction, strains.link), (drive.motor_friction, strains.motor)):
        if isinstance(law, Presliding) and strain is not None:
            total = total + law.stiffness * strain * strain / 2
    if drive.hysteresis and strains.spring is not None:
        total = total + drive.hysteresis.energy(strains.spring)
    return total


def drive_by_drive(drives: Sequence[Drive], numbers: Sequence[Scalar]) -> list[Strains]:
    """All strains of a robot by drive, from a flat list: see `dealt`."""
    hands = dealt([*map(count, drives)], numbers)
    return [taken(drive, iter(hand)) for drive, hand in zip(drives, hands, strict=True)]


def dealt(counts: Sequence[int], numbers: Sequence[Scalar]) -> list[list[Scalar]]:
    """Each drive's numbers: the first go to all that have one, the next to all that have two, and so on."""
    stream, hands = iter(numbers), [[] for _ in counts]
    for k in range(max(counts, default=0)):
        for hand, wanted in zip(hands, counts, strict=True):
            if wanted > k:
                hand.append(next(stream))
    return hands


def gathered(hands: Sequence[Sequence[Scalar]]) -> list[Scalar]:
    """The inverse of `dealt`."""
    return [hand[k] for k in range(max(map(len, hands), default=0)) for hand in hands if len(hand) > k]

"""Friction of the link, which winds the spring as the motor's does not: how much there is, and what contradicts it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.conditioning.filtering import low_pass_together
from cutpoint.identification.drives.rotor import RotorEstimate
from cutpoint.identification.drives.scatter import SIGNIFICANT, covariance
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.mechanics.friction import Coulomb
from cutpoint.model.drive import Drive

Array = NDArray[np.float64]

PUSHES = 0.05
"""Of all viscous friction: less than that is not one side's push, but what models leave out."""

MOST = 2.0
"""Times the other side's: dry friction by which a drive is taken to have it on one side."""


@dataclass(frozen=True)
class LinkFriction:
    """coulomb: N m, viscous: N m s/rad, each with its standard deviation."""

    coulomb: tuple[float, float]
    viscous: tuple[float, float]

    def law(self, smoothing: float) -> Coulomb | None:
        """None where it cannot be told from zero."""
        coulomb, viscous = (x if x > SIGNIFICANT * s else 0.0 for x, s in (self.coulomb, self.viscous))
        return Coulomb(coulomb, viscous, smoothing) if coulomb or viscous else None


def link_friction(torque: Array, sliding: Array, period: float, cutoff: float) -> LinkFriction:
    """Of what the drive exerts beside what the link asks for, torque (N,), N m, found from the motor.

    sliding: (N, 2), direction of motion, and speed, rad/s.  period: s.  cutoff: Hz, of the filter for all.
    """
    passed = np.column_stack(low_pass_together([*sliding.T, np.ones_like(torque), torque], period, cutoff))
    passed = passed[np.isfinite(passed).all(axis=1)]
    columns = passed[:, :-1]
    values = np.linalg.lstsq(columns, passed[:, -1])[0]
    spread = np.sqrt(np.diag(covariance(columns, passed[:, -1] - columns @ values)))
    coulomb, viscous, *_ = zip(values.tolist(), spread.tolist(), strict=True)
    return LinkFriction(coulomb, viscous)


def clocks_differ(spring: SpringEstimate, rotor: RotorEstimate, link: LinkFriction | None) -> str:
    """Why nothing that goes by speed is told, where viscous friction of one side surely drives it; or nothing.

    An encoder of the link that is late by d adds d q_dot to the deflection: so does viscous friction of d times the
    stiffness that is the link's instead of the motor's.
    """
    sides = {"link": (rotor["viscous"], rotor.deviations["viscous"])} | ({"motor": link.viscous} if link else {})
    whole = sum(value for value, _ in sides.values())
    for late, (value, deviation) in sides.items():
        if -value > max(SIGNIFICANT * deviation, PUSHES * whole):
            pushed = {"link": "motor", "motor": "link"}[late]
            least = f"{_late(-value, spring):.2g} ms at least"
            if link and late == "link":
                least = f"{least}, {_late(link.viscous[0], spring):.2g} ms if the link has no viscous friction"
            return (
                f"viscous friction of the {pushed} comes out as {value:.3g} +- {deviation:.2g} N m s/rad and would "
                f"drive it, as where the {late}'s encoder is late by {least}: align the clocks, see `aligned`"
            )
    return ""


def _late(viscous: float, spring: SpringEstimate) -> float:
    """ms by which one encoder is late if that shows as viscous friction, N m s/rad."""
    return 1e3 * viscous / spring["stiffness" if "stiffness" in spring.names else "k2"]


def remarks(drive: Drive, spring: SpringEstimate, rotor: RotorEstimate, link: LinkFriction) -> tuple[str, ...]:
    """On which side the encoders see friction, a sentence each."""
    stated: Literal["motor", "link"] = "motor" if drive.motor_friction and not drive.link_friction else "link"
    on_link, on_motor = (max(x, 0.0) for x in (link.coulomb[0], rotor["coulomb"]))
    found: list[str] = []
    if on_link > SIGNIFICANT * link.coulomb[1] or stated == "link":
        side = {"motor": "link", "link": "motor"}[stated]
        outweighs = on_motor > MOST * on_link if side == "motor" else on_link > MOST * on_motor
        remedy = "" if not outweighs else f": state its friction under `friction: {{{side}: ...}}`"
        found.append(f"of dry friction {on_motor:.3g} N m are the motor's and {on_link:.3g} N m the link's{remedy}")
    value, deviation = link.viscous
    if value > SIGNIFICANT * deviation and on_motor > on_link:
        late = f"its encoder is late by {_late(value, spring):.2g} ms"
        found.append(f"viscous friction of {value:.3g} N m s/rad is the link's, or {late}")
    return tuple(found)

"""Link friction, which unlike the motor's deflects the spring: its size, and evidence against it."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import low_pass_together
from cutpoint.identification.drives.rotor import RotorEstimate
from cutpoint.identification.drives.scatter import SIGNIFICANT, covariance
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.mechanics.drives.friction import Coulomb, Stribeck
from cutpoint.mechanics.drives.presliding import sliding_of
from cutpoint.model.drive import Drive, Friction

PUSHES = 0.05
"""Share of all viscous friction: a smaller negative one is model error, not evidence."""


@dataclass(frozen=True)
class LinkFriction:
    """coulomb: N m, viscous: N m s/rad, each with its standard deviation."""

    coulomb: tuple[float, float]
    viscous: tuple[float, float]

    def law(self, stated: Friction | None, smoothing: float) -> Coulomb | Stribeck | None:
        """The law: a stated one's peak at rest is kept.  None if there is no peak and nothing differs from zero."""
        coulomb, viscous = (x if x > SIGNIFICANT * s else 0.0 for x, s in (self.coulomb, self.viscous))
        known = sliding_of(stated)
        if isinstance(known, Stribeck):
            return replace(known, coulomb=coulomb, static=coulomb + known.static - known.coulomb, viscous=viscous)
        return Coulomb(coulomb, viscous, smoothing) if coulomb or viscous else None


def link_friction(torque: Array, sliding: Array, period: float, cutoff: float) -> LinkFriction:
    """Link friction from the drive's torque in excess of the link's and of known friction beyond Coulomb's, (N,), N m.

    sliding: (N, 2), direction of motion, and speed, rad/s.  period: s.  cutoff: Hz, of the filter for all.
    """
    passed = np.column_stack(low_pass_together([*sliding.T, np.ones_like(torque), torque], period, cutoff))
    passed = passed[np.isfinite(passed).all(axis=1)]
    columns = passed[:, :-1]
    values = np.linalg.lstsq(columns, passed[:, -1], rcond=None)[0]
    spread = np.sqrt(np.diag(covariance(columns, passed[:, -1] - columns @ values)))
    coulomb, viscous, *_ = zip(values.tolist(), spread.tolist(), strict=True)
    return LinkFriction(coulomb, viscous)


def clocks_differ(spring: SpringEstimate, rotor: RotorEstimate, link: LinkFriction | None) -> str:
    """Why nothing proportional to speed is reported, if one side's viscous friction is significantly negative; else "".

    A delay d of the link's encoder adds d q_dot to the deflection, like a viscous friction of d times the stiffness on
    the link's side instead of the motor's.
    """
    sides = {"link": (rotor["viscous"], rotor.deviations["viscous"])} | ({"motor": link.viscous} if link else {})
    whole = sum(value for value, _ in sides.values())
    for late, (value, deviation) in sides.items():
        if -value > max(SIGNIFICANT * deviation, PUSHES * whole):
            pushed = {"link": "motor", "motor": "link"}[late]
            least = f"at least {_late(-value, spring):.2g} ms"
            if link and late == "link":
                least = f"{least}, {_late(link.viscous[0], spring):.2g} ms if the link has no viscous friction"
            return (
                f"viscous friction of the {pushed} comes out as {value:.3g} +- {deviation:.2g} N m s/rad, which would "
                f"drive it, as if the {late}'s encoder were late by {least}: align the clocks, see `aligned`"
            )
    return ""


def _late(viscous: float, spring: SpringEstimate) -> float:
    """Delay of one encoder, ms, that would look like this viscous friction, N m s/rad."""
    return 1e3 * viscous / spring["stiffness" if "stiffness" in spring.names else "k2"]


def friction_notes(drive: Drive, spring: SpringEstimate, rotor: RotorEstimate, link: LinkFriction) -> tuple[str, ...]:
    """On which side the encoders see friction, a sentence each."""
    on_link, on_motor = (max(x, 0.0) for x in (link.coulomb[0], rotor["coulomb"]))
    found: list[str] = []
    if on_link > SIGNIFICANT * link.coulomb[1] or not (drive.motor_friction and not drive.link_friction):
        found.append(f"of the dry friction, {on_motor:.3g} N m is the motor's and {on_link:.3g} N m the link's")
    value, deviation = link.viscous
    if value > SIGNIFICANT * deviation and on_motor > on_link:
        late = f"its encoder is late by {_late(value, spring):.2g} ms"
        found.append(f"viscous friction of {value:.3g} N m s/rad is the link's, or {late}")
    return tuple(found)


def on_sides_seen(stated: Drive, seen: Drive) -> Drive:
    """The stated drive with friction on the sides, and in the shares, in which the encoders saw it.

    seen: the same drive with Coulomb and viscous friction of either side, none where nothing differs from zero.  Shapes
    stay as stated, on either side if only one is; so does friction of which some is in another form.
    """
    link, motor = stated.link_friction, stated.motor_friction
    if not all(isinstance(law, Coulomb | Stribeck | None) for law in (link, motor)):
        return stated
    on_link, on_motor = _sized(link or motor, seen.link_friction), _sized(motor or link, seen.motor_friction)
    return replace(stated, link_friction=on_link and replace(on_link, per_load=None), motor_friction=on_motor)


def _sized(law: Any, seen: Any) -> Coulomb | Stribeck | None:
    """A law, or if there is none what was seen, with the coefficients of the latter; at rest in the same proportion."""
    if seen is None or not (seen.coulomb or seen.viscous):
        return None
    law = law or seen
    at_rest = {"static": seen.coulomb * law.static / law.coulomb} if isinstance(law, Stribeck) and law.coulomb else {}
    return replace(law, coulomb=seen.coulomb, viscous=seen.viscous, **at_rest)

"""One joint's drive from its own channels, and from what its links show of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.identification.drives.deflections import TorqueReading
from cutpoint.identification.drives.joint_channels import Channels
from cutpoint.identification.drives.joint_torques import beyond_coulomb, smoothing_of, torque_left, transmitted_share
from cutpoint.identification.drives.link_friction import LinkFriction, clocks_differ, friction_notes, link_friction
from cutpoint.identification.drives.rotor import RotorEstimate, late
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.identification.drives.stated_parts import as_wide, not_sought, with_spring
from cutpoint.identification.drives.torque_delay import Delay
from cutpoint.identification.drives.turns import SHAPE, Turn, Turns, is_seen
from cutpoint.identification.drives.two_encoders import two_encoders
from cutpoint.mechanics.drives.backlash import Backlash, spring_of
from cutpoint.model.drive import Drive, Motor, Rotor

NAMES = ("link coulomb", "link viscous")

BETTER = 0.9
"""The stated link friction is kept unless freeing it leaves less than this share of the error."""

NARROWER = 3.0
"""The band for rotors is this many times narrower than that of the links' motion: when friction changes sign within it,
the filtered speed no longer shows the friction."""


@dataclass(frozen=True, eq=False)
class DriveEstimate:
    """One joint's drive: as identified, otherwise unchanged.

    spring, rotor: estimates with uncertainties.  unidentifiable: what was not determined or not sought, and why.
    apart: whether the spring separated the rotor from the link; otherwise the known link did.
    clocks: evidence that the encoders' clocks differ, if any.
    notes: the side of friction, if it differs from the drive's files, one sentence each.
    delay: s by which the motor's torque acts later than its time stamp; None if the spring does not determine it.
    period: s between samples.
    """

    drive: Drive
    spring: SpringEstimate
    rotor: RotorEstimate
    unidentifiable: Mapping[str, str]
    apart: bool
    clocks: str = ""
    notes: tuple[str, ...] = ()
    delay: Delay | None = None
    period: float = 0.0


class _Links(NamedTuple):
    """The spring from the links' torque, and that torque (N,), N m; and whether its friction is as stated."""

    spring: SpringEstimate
    load: Array
    stated: bool


def drive_of(joint: Channels, drive: Drive, resolution: float, cutoff: float) -> DriveEstimate:
    """From the links' torque to the spring, to the rotor, to the motor's torque, to the spring again.

    resolution: of both encoders together, rad at the joint's side.  cutoff: Hz, for the rotor.
    Raises InputError: currents without a determinable torque constant, or channels that do not identify the drive.
    """
    ratio, period = drive.ratio, joint.period
    joint, shows_play = _beyond_play(joint, drive, resolution)
    (spring, rotor, apart), stated = _told_apart(
        joint, drive, _from_links(joint, ratio, resolution), resolution, cutoff
    )
    link = None
    if apart and not stated:
        share = transmitted_share(spring, joint.theta, ratio)
        left, _ = torque_left(rotor, joint.theta, joint.motor_torque(rotor), period, joint.delay, share)
        speed = joint.sliding[:, 1]
        sliding = np.column_stack([np.tanh(speed / smoothing_of(drive, rotor.smoothing)), speed])
        beyond = beyond_coulomb(drive.link_friction, speed, np.zeros_like(speed))  # else its peak pushes at speed
        link = link_friction(left - joint.link_torque - beyond, sliding, period, cutoff)
    delay = None if not apart or "stiffness" in spring.unidentifiable else _delay(joint, ratio, spring, cutoff)
    return replace(_estimate(drive, spring, rotor, apart, link, shows_play), delay=delay, period=period)


def _told_apart(
    joint: Channels, drive: Drive, sides: Sequence[_Links], resolution: float, cutoff: float
) -> tuple[Turn, bool]:
    """Spring and rotor from what links show, the likelier first, and whether their friction is as stated.

    Where nothing tells them apart, the rotor is as the last of the links shows it.
    """
    links, *others = sides
    rotor = joint.rotor(drive.ratio, links.spring, links.load, cutoff, joint.delay)
    if why := rotor.unidentifiable.get("torque constant"):
        raise InputError(f"motor_side: {why}, or give torques")
    turns = Turns(joint, drive.ratio, links.spring, rotor, resolution, spring_of(drive.compliance))
    if found := turns.taken():
        return found, links.stated
    if others:
        return _told_apart(joint, drive, others, resolution, cutoff)
    return turns.with_links_rotor(), links.stated


def _delay(joint: Channels, ratio: float, spring: SpringEstimate, cutoff: float) -> Delay:
    aligned = replace(joint, effort=late(joint.effort, joint.period, joint.delay))
    further = aligned.rotor(ratio, spring, spring.torque(joint.theta, joint.q, ratio), cutoff, None)
    return Delay(joint.delay + further["delay"], further.deviations["delay"])


def _beyond_play(joint: Channels, drive: Drive, resolution: float) -> tuple[Channels, bool]:
    """Channels without the play that the drive states, if that reduces the residual; and whether it does."""
    if not isinstance(drive.compliance, Backlash):
        return joint, False
    load = joint.link_torque + joint.link_friction
    play = np.asarray(drive.compliance.deflection(load) - drive.compliance.spring.deflection(load))
    beyond = replace(joint, q=joint.q + play)
    as_read, without = (
        two_encoders(
            each.theta, each.q, load, joint.period, drive.ratio,
            resolution=resolution, laws=SHAPE, hysteresis=False, damping=False,
        ).scatter
        for each in (joint, beyond)
    )  # fmt: skip
    return (beyond, True) if without < as_read else (joint, False)


def _from_links(joint: Channels, ratio: float, resolution: float) -> list[_Links]:
    """With the link friction that the spring shows, if it differs from the stated one, and with that."""
    load = joint.link_torque + joint.link_friction
    unknowns: dict[str, Array] = dict(zip(NAMES, joint.sliding.T, strict=True))
    theta, q, period = joint.theta, joint.q, joint.period
    known = two_encoders(theta, q, load, period, ratio, resolution=resolution, laws=SHAPE)
    # for a curved law, a whole friction is too large for its tangent
    freed = two_encoders(
        theta, q, joint.link_torque, period, ratio,
        resolution=resolution, laws=["linear"], reading=TorqueReading(unknowns),
    )  # fmt: skip
    stated = _Links(known, load, True)
    better = freed.prediction[freed.law] < BETTER * known.prediction[known.law]
    # an unresolved spring explains any friction
    if not (better and is_seen(freed)):
        return [stated]
    return [_Links(freed, joint.link_torque + joint.sliding @ [freed[name] for name in NAMES], False), stated]


def _of_a_deflection(clocks: str) -> dict[str, str]:
    """What cannot be determined if the encoders' clocks differ, each with the reason."""
    shorter = "the encoders' clocks differ, as motor friction shows"
    others = ("rotor inertia", "damping", "stiffness", "kinematic_error", "hysteresis")
    return {"motor friction": clocks, **dict.fromkeys(others, shorter)}


def _estimate(
    drive: Drive,
    spring: SpringEstimate,
    rotor: RotorEstimate,
    apart: bool,
    link: LinkFriction | None,
    shows_play: bool,
) -> DriveEstimate:
    """The drive with all that was determined; a drive that stays rigid has no parts that act on a deflection."""
    clocks = clocks_differ(spring, rotor, link)
    link = None if clocks else link
    why = {**spring.unidentifiable, **rotor.unidentifiable, **(_of_a_deflection(clocks) if clocks else {})}
    notes = friction_notes(drive, spring, rotor, link) if link else ()
    changes: dict[str, object] = {}
    if link or (rotor.friction is not None and not clocks):
        changes["motor_friction"] = rotor.friction
    if link:
        changes["link_friction"] = link.law(drive.link_friction, smoothing_of(drive, rotor.smoothing))
    if "rotor inertia" not in why:
        changes["rotor"] = replace(drive.rotor, inertia=rotor.inertia) if drive.rotor else Rotor(rotor.inertia)
    if rotor.torque_constant is not None:
        constant = rotor.torque_constant
        changes["motor"] = replace(drive.motor, torque_constant=constant) if drive.motor else Motor(constant)
    if "stiffness" not in why:
        why |= not_sought(drive, shows_play)
        drive = with_spring(drive, spring.compliance)
    if drive.is_elastic:
        parts = {name: getattr(spring, name) for name in ("kinematic_error", "damping")}
        parts["hysteresis"] = as_wide(spring.hysteresis, spring.compliance, drive.compliance)
        changes.update({name: part for name, part in parts.items() if part is not None and name not in why})
    return DriveEstimate(replace(drive, **changes), spring, rotor, why, apart, clocks, notes)  # type: ignore[arg-type]

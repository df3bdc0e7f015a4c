"""One joint's drive from its own channels: spring, rotor, and the spring again from the remaining torque."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.filtering import HIGHEST, low_pass_together, noise_cutoff
from cutpoint.identification.drives.acceleration_noise import clear_acceleration, noise_density
from cutpoint.identification.drives.deflections import TorqueReading
from cutpoint.identification.drives.joint_torques import (
    beyond_coulomb,
    corrected,
    smoothing_of,
    torque_left,
    transmitted_share,
)
from cutpoint.identification.drives.link_friction import LinkFriction, clocks_differ, friction_notes, link_friction
from cutpoint.identification.drives.rotor import RotorEstimate, motor_side
from cutpoint.identification.drives.scatter import SIGNIFICANT
from cutpoint.identification.drives.spring_estimate import UNCERTAIN, SpringEstimate
from cutpoint.identification.drives.spring_laws import LAWS
from cutpoint.identification.drives.stated_parts import as_wide, not_sought, with_spring
from cutpoint.identification.drives.torque_delay import Delay
from cutpoint.identification.drives.two_encoders import two_encoders
from cutpoint.mechanics.drives.backlash import Backlash, spring_of
from cutpoint.model.drive import Compliance, Drive, Motor, Rotor

SHAPE = ("flexspline",)
"""The law used for springs until the best one is chosen: it includes the linear one."""

NAMES = ("link coulomb", "link viscous")

BETTER = 0.9
"""The stated link friction is kept unless freeing it leaves less than this share of the error."""

NARROWER = 3.0
"""The band for rotors is this many times narrower than that of the links' motion: when friction changes sign within it,
the filtered speed no longer shows the friction."""

WIDER = 2.0
"""Times the frequency at which the deflection or the torque falls below its noise: springs are identified up to there.

Noise of the torque beyond makes springs appear stiffer and less damped.
"""

TURNS = 8
"""Largest number of alternations between spring and rotor; initially wrong friction takes several."""

CONVERGED = 0.5
"""Standard deviations of a rotor: after a smaller change both have converged."""

SAMPLED, ENOUGH = 10.0, 2_000
"""Samples that are kept of filtered channels, per period of the cut-off, and in all at least: more say nothing new."""


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


class _Turn(NamedTuple):
    """A spring, a rotor, and whether the spring separated it from the links."""

    spring: SpringEstimate
    rotor: RotorEstimate
    apart: bool

    @property
    def runs_away(self) -> bool:
        """Whether the rotor is clearly negative: the torques of links without weight have the shape of their rotors',
        and with noise they fix only the ratio of stiffness and inertia."""
        return self.rotor["inertia"] < -SIGNIFICANT * self.rotor.deviations["inertia"]


def drive_of(joint: Channels, drive: Drive, resolution: float, cutoff: float) -> DriveEstimate:
    """From the links' torque to the spring, to the rotor, to the motor's torque, to the spring again.

    resolution: of both encoders together, rad at the joint's side.  cutoff: Hz, for the rotor.
    Raises InputError: currents without a determinable torque constant, or channels that do not identify the drive.
    """
    ratio, period = drive.ratio, joint.period
    joint, shows_play = _beyond_play(joint, drive, resolution)
    spring, load, stated = _from_links(joint, ratio, resolution)
    rotor = _rotor(joint, ratio, spring, load, cutoff, joint.delay)
    if why := rotor.unidentifiable.get("torque constant"):
        raise InputError(f"motor_side: {why}, or give torques")
    spring, rotor, apart = _from_motor(joint, ratio, spring, rotor, resolution, spring_of(drive.compliance))
    link = None
    if apart and not stated:
        share = transmitted_share(spring, joint.theta, ratio)
        left, _ = torque_left(rotor, joint.theta, _torque(joint, rotor), period, joint.delay, share)
        speed = joint.sliding[:, 1]
        sliding = np.column_stack([np.tanh(speed / smoothing_of(drive, rotor.smoothing)), speed])
        beyond = beyond_coulomb(drive.link_friction, speed, np.zeros_like(speed))  # else its peak pushes at speed
        link = link_friction(left - joint.link_torque - beyond, sliding, period, cutoff)
    delay = None if not apart or "stiffness" in spring.unidentifiable else _delay(joint, ratio, spring, cutoff)
    return replace(_estimate(drive, spring, rotor, apart, link, shows_play), delay=delay, period=period)


def _delay(joint: Channels, ratio: float, spring: SpringEstimate, cutoff: float) -> Delay:
    found = _rotor(joint, ratio, spring, spring.torque(joint.theta, joint.q, ratio), cutoff, None)
    return Delay(found["delay"], found.deviations["delay"])


def _rotor(
    joint: Channels, ratio: float, spring: SpringEstimate, load: Array, cutoff: float, delay: float | None
) -> RotorEstimate:
    """The rotor from the motor's torque or current.  load: (N,), N m, of the drive on the link."""
    effort = {"current" if joint.is_current else "torque": joint.effort}
    share = transmitted_share(spring, joint.theta, ratio)
    return motor_side(joint.theta, load, joint.period, ratio, transmission=share, cutoff=cutoff, delay=delay, **effort)


def _torque(joint: Channels, rotor: RotorEstimate) -> Array:
    """The motor's torque, N m at the joint."""
    constant = rotor.torque_constant
    return joint.effort if constant is None else joint.effort * constant * rotor.ratio


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


def _from_links(joint: Channels, ratio: float, resolution: float) -> tuple[SpringEstimate, Array, bool]:
    """The spring from the links' torque, and that torque (N,), with the stated friction, or with that which the spring
    shows if it differs; and whether it is as stated."""
    load = joint.link_torque + joint.link_friction
    unknowns: dict[str, Array] = dict(zip(NAMES, joint.sliding.T, strict=True))
    theta, q, period = joint.theta, joint.q, joint.period
    known = two_encoders(theta, q, load, period, ratio, resolution=resolution, laws=SHAPE)
    # for a curved law, a whole friction is too large for its tangent
    freed = two_encoders(
        theta, q, joint.link_torque, period, ratio,
        resolution=resolution, laws=["linear"], reading=TorqueReading(unknowns),
    )  # fmt: skip
    better = freed.prediction[freed.law] < BETTER * known.prediction[known.law]
    # an unresolved spring explains any friction
    if not (better and _is_seen(freed)):
        return known, load, True
    return freed, joint.link_torque + joint.sliding @ [freed[name] for name in NAMES], False


def _from_motor(
    joint: Channels,
    ratio: float,
    spring: SpringEstimate,
    rotor: RotorEstimate,
    resolution: float,
    stated: Compliance | None,
) -> _Turn:
    """The spring from the motor's torque, and the rotor from the spring, in turns until they stand still.

    stated: the spring of the file, without play.
    """
    torque, period = _torque(joint, rotor), joint.period
    lead, highest = joint.theta - joint.q, HIGHEST / joint.period
    still, told = (min(WIDER * noise_cutoff(x, period, otherwise=highest), highest) for x in (lead, torque))
    band, shaking = clear_acceleration(joint.theta, period, min(still, told), still)
    noise = noise_density(lead, period, still) * np.sqrt(band)
    every = max(1, min(int(1.0 / (SAMPLED * band * period)), lead.size // ENOUGH))

    def turned(spring: SpringEstimate, rotor: RotorEstimate, laws: Sequence[str]) -> _Turn:
        """The spring from the torque that the rotor leaves, and the rotor from that spring."""
        share = transmitted_share(spring, joint.theta, ratio)
        left, unknowns = torque_left(rotor, joint.theta, torque, period, joint.delay, share)
        channels = joint.theta, joint.q, left, *unknowns.values()
        angle = np.where(np.isfinite(channels).all(axis=0), joint.theta, np.nan)
        theta, q, left, *columns = (x[::every] for x in low_pass_together(channels, period, band))
        seen = _is_seen(spring)
        unknown = dict(zip(unknowns, columns, strict=True)) if seen else {}
        shared = {"inertia": rotor["inertia"] * shaking**2}
        reading = TorqueReading(unknown, shared, share[::every], noise, band, angle, every)
        found = two_encoders(
            theta, q, left, period * every, ratio,
            resolution=resolution, laws=laws, reading=reading, stated=None if laws is SHAPE else stated,
        )  # fmt: skip
        return _Turn(found, corrected(rotor, found) if seen else rotor, seen)

    before = [(spring, rotor)]
    for _ in range(TURNS - 1):
        found = turned(*before[-1], SHAPE)
        if found.runs_away:
            before = before[:-1] or before  # the last turn that did not is repeated
            break
        settled = len(before) > 1 and any(_is_near(found.rotor, own) for _, own in before)  # or returns to one before
        before.append((found.spring, found.rotor))
        if settled:
            break
    found = turned(*before[-1], tuple(LAWS))
    return _Turn(*before[-1], False) if found.runs_away else found


def _is_near(rotor: RotorEstimate, before: RotorEstimate) -> bool:
    """Whether it changed by less than CONVERGED of its standard deviations."""
    return bool((np.abs(rotor.values - before.values) <= CONVERGED * np.sqrt(np.diag(rotor.covariance))).all())


def _is_seen(spring: SpringEstimate) -> bool:
    """Whether a spring with too small a deflection to be stated still separates the rotor from the links."""
    return spring.deviations["stiffness"] < UNCERTAIN * spring["stiffness"]


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

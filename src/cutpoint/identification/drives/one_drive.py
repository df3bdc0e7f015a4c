"""One joint's drive from its own channels: spring, rotor, and the spring again by what is left of the torque."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.conditioning.filtering import low_pass, low_pass_together, noise_cutoff
from cutpoint.identification.drives.joint_torques import corrected, torque_left, transmitted_share
from cutpoint.identification.drives.rotor import RotorEstimate, motor_side
from cutpoint.identification.drives.spring_estimate import UNCERTAIN, SpringEstimate
from cutpoint.identification.drives.spring_laws import LAWS
from cutpoint.identification.drives.two_encoders import smallest_step, two_encoders
from cutpoint.model.drive import Drive, Motor, Rotor

Array = NDArray[np.float64]

SHAPE = ("flexspline",)
"""The law from which springs are read until the best one is chosen: it can be straight too."""

NARROWER = 3.0
"""Times that the band in which rotors are found is narrower than that of the links' motion: friction that changes sign
within it is no longer what the filtered speed says."""

WIDER = 2.0
"""Times the frequency at which the deflection sinks into its noise: up to there springs are told."""

HIGHEST = 0.4
"""Of the sampling rate."""


@dataclass(frozen=True, eq=False)
class DriveEstimate:
    """One joint's drive: as far as the recording tells, otherwise as it was.

    spring, rotor: what was found, with its uncertainty.  unidentifiable: what was not, each with the sentence why.
    apart: whether the spring told the rotor from the link; otherwise they are told apart by what was known of the link.
    """

    drive: Drive
    spring: SpringEstimate
    rotor: RotorEstimate
    unidentifiable: Mapping[str, str]
    apart: bool


@dataclass(frozen=True, eq=False)
class Channels:
    """One joint's, each (N,): theta, q in rad; effort, the motor's torque in N m or current in A; link_torque, N m.

    period, delay: s.
    """

    theta: Array
    q: Array
    effort: Array
    link_torque: Array
    period: float
    delay: float
    is_current: bool


def drive_of(joint: Channels, drive: Drive, resolution: float | None, cutoff: float) -> DriveEstimate:
    """From the links' torque to the spring, to the rotor, to the motor's torque, to the spring again.

    resolution: rad at the joint's side, None for the smallest steps that the samples show.  cutoff: Hz, for the rotor.
    """
    ratio, period, kind = drive.ratio, joint.period, "current" if joint.is_current else "torque"
    spring = two_encoders(joint.theta, joint.q, joint.link_torque, period, ratio, resolution=resolution, laws=SHAPE)
    rotor = motor_side(
        joint.theta,
        joint.link_torque,
        period,
        ratio,
        transmission=transmitted_share(spring, joint.theta, ratio),
        cutoff=cutoff,
        delay=joint.delay,
        **{kind: joint.effort},
    )
    if resolution is None:
        resolution = float(np.hypot(smallest_step(joint.theta), smallest_step(joint.q)))
    return _estimate(drive, *_from_motor(joint, ratio, spring, rotor, resolution))


def _from_motor(
    joint: Channels, ratio: float, spring: SpringEstimate, rotor: RotorEstimate, resolution: float
) -> tuple[SpringEstimate, RotorEstimate, bool]:
    """The spring by the motor's torque, and the rotor by the spring; whether that told the rotor from the links."""
    torque, period = joint.effort, joint.period
    if rotor.torque_constant is not None:
        torque = joint.effort * rotor.torque_constant * ratio
    lead = joint.theta - joint.q
    band = min(WIDER * noise_cutoff(lead, period, otherwise=HIGHEST / period), HIGHEST / period)
    noise = _noise_below(lead - low_pass(lead, period, band), period, band)
    seen = False
    for laws in (SHAPE, SHAPE, tuple(LAWS)):
        share = transmitted_share(spring, joint.theta, ratio)
        left, unknowns = torque_left(rotor, joint.theta, torque, period, joint.delay, share)
        channels = joint.theta, joint.q, left, *unknowns.values()
        theta, q, left, *columns = low_pass_together(channels, period, band)
        # a spring that is wound by too little to be stated can still tell the rotor from the links
        seen = spring.deviations["stiffness"] < UNCERTAIN * spring["stiffness"]
        spring = two_encoders(
            theta, q, left, period, ratio,
            resolution=resolution, laws=laws, noise=noise, band=band,
            torque_unknowns=dict(zip(unknowns, columns, strict=True)) if seen else None,
        )  # fmt: skip
        if seen:
            rotor = corrected(rotor, spring)
    return spring, rotor, seen


def _noise_below(rest: Array, period: float, band: float) -> float:
    """RMS of white noise below a frequency, Hz, from what is left above it (N,)."""
    return float(np.nanstd(rest) * np.sqrt(band / (0.5 / period - band)))


def _estimate(drive: Drive, spring: SpringEstimate, rotor: RotorEstimate, apart: bool) -> DriveEstimate:
    """The drive with what was told; a drive that stays rigid has no parts that act on a deflection."""
    why = {**spring.unidentifiable, **rotor.unidentifiable}
    changes: dict[str, object] = {}
    if "rotor inertia" not in why:
        changes["rotor"] = replace(drive.rotor, inertia=rotor.inertia) if drive.rotor else Rotor(rotor.inertia)
    if rotor.friction is not None:
        changes["motor_friction"] = rotor.friction
    if rotor.torque_constant is not None:
        constant = rotor.torque_constant
        changes["motor"] = replace(drive.motor, torque_constant=constant) if drive.motor else Motor(constant)
    if "stiffness" not in why:
        changes["compliance"] = spring.compliance
    if "compliance" in changes or drive.is_elastic:
        parts = {name: getattr(spring, name) for name in ("kinematic_error", "hysteresis", "damping")}
        changes.update({name: part for name, part in parts.items() if part is not None})
    return DriveEstimate(replace(drive, **changes), spring, rotor, why, apart)  # type: ignore[arg-type]

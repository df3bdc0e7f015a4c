"""All drives of a robot from one recording: what encoders on both sides and the motors' torques tell."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.errors import InputError
from cutpoint.identification.conditioning.filtering import low_pass, noise_cutoff
from cutpoint.identification.drives.joint_torques import (
    corrected,
    link_torque,
    torque_left,
    transmitted_share,
)
from cutpoint.identification.drives.rotor import RotorEstimate, motor_side
from cutpoint.identification.drives.spring_estimate import UNCERTAIN, SpringEstimate
from cutpoint.identification.drives.spring_laws import LAWS
from cutpoint.identification.drives.two_encoders import smallest_step, two_encoders
from cutpoint.identification.logs.recording import Recording
from cutpoint.model.drive import Drive, Motor, Rotor
from cutpoint.robot import Robot

Array = NDArray[np.float64]

SHAPE = ("flexspline",)
"""The law from which springs are read until the best one is chosen: it can be straight too."""

NARROWER = 3.0
"""Times that the band in which rotors are found is narrower than that of the links' motion: friction that changes sign
within it is no longer what the filtered speed says."""


WIDER = 2.0
"""Times the frequency at which the deflection sinks into its noise: up to there springs are told.  Noise beyond, of
torques and accelerations, would make springs seem stiffer and rotors lighter than they are."""

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
class DriveEstimates:
    """robot: with the drives that were found.  joints: each joint's estimate, by name."""

    robot: Robot
    joints: Mapping[str, DriveEstimate]

    @property
    def notes(self) -> tuple[str, ...]:
        """What could not be told, a sentence each."""
        return tuple(
            f"{joint}: {thing} cannot be told: {why}"
            for joint, estimate in self.joints.items()
            for thing, why in estimate.unidentifiable.items()
        )


def identify_drives(
    robot: Robot, recording: Recording, resolution: ArrayLike | None = None, torque_delay: float = 0.0
) -> DriveEstimates:
    """Springs, kinematic errors, hysteresis, rotors and motor friction of all drives.

    robot: its links and their friction are taken as known; its drives state ratios, and what the recording cannot tell.
    recording: q, theta, and torque or current of all of its joints, on a uniform time and on one clock.
    resolution: of both encoders together, rad at the joint's side, one or one for each joint; by default the smallest
    steps that the samples show.
    torque_delay: s by which torque or current acts later than it is stamped: half a period for commands that are held.

    The links' motion gives each joint's torque, which calibrates its spring; torques read from the springs give the
    rotors; and the motors' torques, less what rotors and motor friction take, reach to frequencies that differentiated
    link encoders do not: from these come the springs in the end.

    Raises:
        InputError: joints or channels that are missing, times that are not uniform, a floating base.
    """
    names = robot.joints
    if robot.nq != len(names) or set(names) - set(recording.joints):
        missing = sorted(set(names) - set(recording.joints))
        raise InputError(f"identify_drives: every joint of a fixed-base robot must be recorded; missing: {missing}")
    columns = [recording.joints.index(name) for name in names]
    q, theta = recording["q"][:, columns], recording["theta"][:, columns]
    given = "torque" if "torque" in recording.channels else "current"
    effort = recording[given][:, columns]
    delay = float(torque_delay)
    steps = [None] * len(names) if resolution is None else np.broadcast_to(resolution, len(names)).tolist()
    cutoff = noise_cutoff(q, recording.period)
    torques = link_torque(robot, q, recording.period, cutoff)
    found = {
        name: _joint(
            Channels(theta[:, k], q[:, k], effort[:, k], torques[:, k], recording.period, delay, given == "current"),
            robot.drives[name],
            steps[k],
            cutoff / NARROWER,
        )
        for k, name in enumerate(names)
    }
    return DriveEstimates(robot.with_drives({name: each.drive for name, each in found.items()}), found)


@dataclass(frozen=True, eq=False)
class Channels:
    """One joint's, each (N,): theta, q in rad; effort, the motor's torque in N m or current in A; link_torque, N m."""

    theta: Array
    q: Array
    effort: Array
    link_torque: Array
    period: float
    delay: float
    is_current: bool


def _joint(joint: Channels, drive: Drive, resolution: float | None, cutoff: float) -> DriveEstimate:
    """From the links' torque to the spring, to the rotor, to the motor's torque, to the spring again."""
    ratio, period = drive.ratio, joint.period
    torque, kind = joint.effort, "current" if joint.is_current else "torque"
    spring = two_encoders(joint.theta, joint.q, joint.link_torque, period, ratio, resolution=resolution, laws=SHAPE)
    share = transmitted_share(spring, joint.theta, ratio)
    rotor = motor_side(
        joint.theta,
        joint.link_torque,
        period,
        ratio,
        transmission=share,
        cutoff=cutoff,
        delay=joint.delay,
        **{kind: joint.effort},
    )
    if rotor.torque_constant is not None:
        torque = joint.effort * rotor.torque_constant * ratio
    band = min(WIDER * noise_cutoff(joint.theta - joint.q, period), HIGHEST / period)
    if resolution is None:
        resolution = float(np.hypot(smallest_step(joint.theta), smallest_step(joint.q)))
    theta, q = (low_pass(x, period, band) for x in (joint.theta, joint.q))
    noise = _noise_below(joint.theta - joint.q - (theta - q), period, band)
    seen = False
    for laws in (SHAPE, SHAPE, tuple(LAWS)):
        left, unknowns = torque_left(rotor, joint.theta, torque, period, joint.delay, share)
        left, unknowns = low_pass(left, period, band), {k: low_pass(x, period, band) for k, x in unknowns.items()}
        # a spring that is wound by too little to be stated can still tell the rotor from the links
        seen = spring.deviations["stiffness"] < UNCERTAIN * spring["stiffness"]
        spring = two_encoders(
            theta, q, left, period, ratio,
            resolution=resolution, laws=laws, torque_unknowns=unknowns if seen else None, noise=noise,
        )  # fmt: skip
        share = transmitted_share(spring, joint.theta, ratio)
        if seen:
            rotor = corrected(rotor, spring)
    return _estimate(drive, spring, rotor, seen)


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

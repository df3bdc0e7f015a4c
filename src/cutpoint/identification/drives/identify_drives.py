"""Identification of all drives of a robot from one recording with encoders on both sides and motor torques."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import checked_numbers, number, refused
from cutpoint.errors import CutpointError, InputError
from cutpoint.identification.conditioning.filtering import derivative, low_pass, noise_cutoff
from cutpoint.identification.conditioning.motion import check_friction
from cutpoint.identification.drives.joint_channels import Channels
from cutpoint.identification.drives.joint_torques import beyond_coulomb, link_torque
from cutpoint.identification.drives.one_drive import NARROWER, DriveEstimate, drive_of
from cutpoint.identification.drives.rotor import late
from cutpoint.identification.drives.two_encoders import smallest_step
from cutpoint.identification.logs.recording import Recording, check_recording
from cutpoint.identification.one_thread import by_one_thread
from cutpoint.joint_units import words_at
from cutpoint.mechanics.drives.friction import Coulomb, Stribeck
from cutpoint.mechanics.drives.presliding import Presliding
from cutpoint.robot import Robot
from cutpoint.robot_arguments import STANDS, check_all_driven, check_robot

INTERRUPTED = "Ctrl-C was pressed during the search"

LONGEST_DELAY = 0.1
"""s, of torques; a longer one is in ms."""


@dataclass(frozen=True, eq=False)
class DriveEstimates:
    """robot: with the identified drives.  joints: the estimates of elastic drives, by joint name.

    failed: reasons for elastic joints that were not identified; their drives are unchanged.
    """

    robot: Robot
    joints: Mapping[str, DriveEstimate]
    failed: Mapping[str, str] = field(default_factory=dict)

    @property
    def doubts(self) -> tuple[str, ...]:
        """A sentence if the encoders' clocks differ."""
        late = [joint for joint, estimate in self.joints.items() if estimate.clocks]
        if not late:
            return ()
        words = f"the encoders' clocks differ at {', '.join(late)}, and so perhaps at the others"
        return (f"{words}: no drive's numbers can be relied on; identify again with align=True (--align)",)

    @property
    def notes(self) -> tuple[str, ...]:
        """Differences from the robot's files, and what was not identified, one sentence each."""
        kept = "its spring was not identified and stays as it was"
        failed = (f"{joint}: {kept}: {why}" for joint, why in self.failed.items())
        if self.doubts:
            return tuple(failed)
        own = (
            f"{joint}: {words_at(self.robot, joint, words)}"
            for joint, estimate in self.joints.items()
            for words in estimate.notes
        )
        return (*failed, *own)

    @property
    def untold(self) -> tuple[str, ...]:
        """What could not be determined, one sentence each."""
        return tuple(
            f"{joint}: {thing} cannot be told: {words_at(self.robot, joint, why)}"
            for joint, estimate in self.joints.items()
            for thing, why in estimate.unidentifiable.items()
        )


@by_one_thread
def identify_drives(
    robot: Robot,
    recording: Recording,
    resolution: ArrayLike | None = None,
    torque_delay: float = 0.0,
    say: Callable[[str], object] = lambda joint: None,
) -> DriveEstimates:
    """Identifies springs, kinematic errors, hysteresis, rotors and motor friction of all elastic drives.

    If no drive is elastic in the robot's files, all are assumed to be: their springs were unknown.

    robot: its links are taken as known, and their friction unless springs show otherwise; its drives give ratios, and
    whatever the recording cannot determine.
    recording: q, theta, and torque or current of all of its joints, on a uniform time and on one clock.
    resolution: of both encoders together, rad at the joint's side, one or one for each joint; by default from the
    samples, see `encoder_steps`.
    torque_delay: s by which torque or current acts later than its time stamp: half a period for held commands.
    say: called with each joint's name when its turn comes.  Ctrl-C ends the search, and keeps what was found.

    The links' motion gives each joint's torque, which calibrates its spring; spring torques then give the rotors; and
    motor torques, less those of rotors and motor friction, reach frequencies that differentiated link encoders do not:
    they give the final springs.

    Raises:
        InputError: joints or channels that are missing, times that are not uniform, joints without drives, a resolution
            of another shape.
    """
    check_robot("identify_drives", robot)
    check_friction("identify_drives", robot, on_motors=Coulomb | Stribeck | Presliding)
    check_recording("identify_drives", recording)
    names = robot.joints
    check_all_driven("identify_drives", robot, STANDS)
    if missing := sorted(set(names) - set(recording.joints)):
        raise InputError(f"identify_drives: every joint must be recorded; missing: {missing}")
    recording = recording.in_order(names)
    torque_delay = checked_delay("identify_drives", torque_delay, recording)
    steps = encoder_steps(recording) if resolution is None else _resolution_of(resolution, len(names))
    cutoff = noise_cutoff(recording["q"], recording.period)
    channels = _channels(robot, recording, cutoff, torque_delay)
    found: dict[str, DriveEstimate] = {}
    failed: dict[str, str] = {}
    sought = joints_that_bend(robot)
    for name in sought:
        k = names.index(name)
        try:
            say(name)
            estimate = drive_of(channels[k], robot.drives[name], float(steps[k]), cutoff / NARROWER)
            robot = robot.with_drives({name: estimate.drive})
        except CutpointError as error:  # a failure of one joint does not affect the others
            failed[name] = re.sub(r"^(two_encoders|motor_side): ", "", str(error))
        except KeyboardInterrupt:
            failed |= dict.fromkeys(sought[sought.index(name) :], INTERRUPTED)
            break
        else:
            found[name] = estimate
    return DriveEstimates(robot, found, failed)


def checked_delay(function: str, delay: float, recording: Recording) -> float:
    """s by which torques act late.  Raises InputError for more than a log, or any machine, can show."""
    delay, span = number(function, "torque_delay", delay, "s"), float(np.ptp(recording.time))
    if not abs(delay) < min(LONGEST_DELAY, span):
        longest = f"the log, {span:g} s by its times" if span < LONGEST_DELAY else f"{LONGEST_DELAY:g} s"
        rule = f"must be shorter than {longest}; 0.0005 is half a millisecond"
        raise InputError(f"{function}: torque_delay {delay} s {rule}", delay=delay)
    return delay


def _resolution_of(given: ArrayLike, joints: int) -> Array:
    """(n,) rad, the user's.  Raises InputError."""
    found = checked_numbers("identify_drives", "resolution", given)
    if found.shape not in ((), (1,), (joints,)) or not (np.isfinite(found) & (found >= 0.0)).all():
        rule = "one number, or one for each joint, rad (m), not negative"
        raise refused("identify_drives", "resolution", given, rule)
    return np.broadcast_to(found, joints)


def encoder_steps(recording: Recording) -> Array:
    """(n,) rad, of both encoders together: the finest differences between samples.

    Interpolation hides them: call this before a recording is resampled.
    """
    pairs = zip(recording["theta"].T, recording["q"].T, strict=True)
    return np.array([np.hypot(smallest_step(theta), smallest_step(q)) for theta, q in pairs])


def _channels(robot: Robot, recording: Recording, cutoff: float, delay: float) -> list[Channels]:
    """Of each joint.  cutoff: Hz, for the links' motion.  delay: s by which torque or current acts later."""
    given = "torque" if "torque" in recording.channels else "current"
    q, theta, effort, period = recording["q"], recording["theta"], recording[given], recording.period
    torque, friction, sliding = link_torque(robot, q, period, cutoff)
    if given == "torque":  # of a current it is not known yet how much torque it is
        speed, load = derivative(low_pass(theta, period, cutoff), period), torque + friction
        laws = (drive.motor_friction for drive in robot.drives.values())
        beyond = [beyond_coulomb(law, *own) for law, *own in zip(laws, speed.T, load.T, strict=True)]
        effort = effort - np.column_stack([late(_filled(x), period, -delay) for x in beyond])
    measured = (theta, q, effort, torque, friction, sliding)
    columns = ((x[:, k] for x in measured) for k in range(len(recording.joints)))
    return [Channels(*own, period=period, delay=delay, is_current=given == "current") for own in columns]


def _filled(values: Array) -> Array:
    """Values (N,), linear where filters leave none: at the ends and beside gaps, where the channels are known."""
    known = np.flatnonzero(np.isfinite(values))
    return np.interp(np.arange(values.size), known, values[known]) if known.size else values


def joints_that_bend(robot: Robot) -> tuple[str, ...]:
    """Joints with elastic drives; all joints, if there are none."""
    return tuple(joint for joint, drive in robot.drives.items() if drive.is_elastic) or robot.joints

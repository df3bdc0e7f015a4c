"""Estimates of links and drives from one recording, each by the help of the other."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from cutpoint.errors import CutpointError, InputError
from cutpoint.identification.drives.identify_drives import DriveEstimates, identify_drives
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.steps import Steps
from cutpoint.identification.rigid.identify_rigid import FrictionWish, RigidEstimate, identify_rigid
from cutpoint.model.drive import Rotor
from cutpoint.robot import Robot


class Estimates(NamedTuple):
    """drives: None if not sought, or not found, as remarks say.  apart: whether rotors come from there."""

    rigid: RigidEstimate
    drives: DriveEstimates | None
    apart: bool = False
    remarks: tuple[str, ...] = ()


def estimates(
    before: Robot,
    fitted: Recording,
    friction: FrictionWish,
    springs: bool,
    how: Mapping[str, Any],
    say: Steps,
) -> Estimates:
    """Links first, then springs by these, then links again by the rotors that the motors' sides tell.

    how: further arguments of `identify_rigid`.  say: told what is done now.  Errors are those of `identify_rigid`.
    """
    say("links, rotors and friction")
    rigid = identify_rigid(before, fitted, friction=friction, **how)
    if not springs:
        return Estimates(rigid, None)
    say.expect(2)
    say("springs of the drives")
    try:
        drives = identify_drives(rigid.robot, fitted)
    except (CutpointError, KeyboardInterrupt) as error:  # what was found of the links is worth having without
        why = error if isinstance(error, CutpointError) else "Ctrl-C was pressed while they were sought"
        return Estimates(rigid, None, remarks=(f"springs were not identified: {why}",))
    if any("rotor inertia" in each.unidentifiable for each in drives.joints.values()):
        return Estimates(rigid, drives)
    say("links again, by the rotors that the motors tell")
    again = _with_rotors(before, drives, fitted, friction=rigid.friction or friction, **how)
    return Estimates(again, drives, apart=True)


def springs_wanted(before: Robot, recording: Recording, springs: bool | None) -> bool:
    """Whether springs are sought: by default if they can be found, and there are any.

    Raises InputError where they are asked for without encoders on both sides.
    """
    both = {"q", "theta"} <= set(recording.channels)
    if springs and not both:
        there = ", ".join(recording.channels)
        raise InputError(f"springs need positions of both sides, q and theta; the recording holds {there}")
    if springs is None:
        return both and any(drive.is_elastic for drive in before.drives.values())
    return springs


def _with_rotors(before: Robot, sprung: DriveEstimates, fitted: Recording, **how: Any) -> RigidEstimate:
    """Links and friction where rotors are known: torques tell sums of both, the motors' sides tell them apart."""
    drives = {
        joint: replace(drive, rotor=replace(drive.rotor or Rotor(0.0), inertia=sprung.joints[joint].rotor.inertia))
        for joint, drive in before.drives.items()
    }
    errors = {joint: each.rotor.deviations["inertia"] for joint, each in sprung.joints.items()}
    return identify_rigid(before.with_drives(drives), fitted, rotors=False, rotor_errors=errors, **how)

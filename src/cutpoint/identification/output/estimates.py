"""Estimates of links and drives from one recording, refined alternately."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import CutpointError, InputError
from cutpoint.identification.conditioning.motion import torques_of
from cutpoint.identification.drives.encoder_gains import gain_notes
from cutpoint.identification.drives.identify_drives import (
    INTERRUPTED,
    DriveEstimates,
    identify_drives,
    joints_that_bend,
)
from cutpoint.identification.drives.link_friction import on_sides_seen
from cutpoint.identification.drives.torque_delay import delay_notes
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.steps import Steps
from cutpoint.identification.rigid.identify_rigid import FrictionWish, RigidEstimate, identify_rigid
from cutpoint.identification.rigid.rigid_robot import stated_coefficient
from cutpoint.identification.rigid.uncertainty import FRICTION
from cutpoint.joint_units import at_joints
from cutpoint.model.drive import Drive, Rotor
from cutpoint.robot import Robot

FINE = 200.0
"""Encoder steps in half of a deflection's range: with fewer, estimates from turning points are biased."""


ZEROS = 2e-3
"""rad (m): a larger difference of the encoders' zeros is reported, as gravity acts at a pose off by as much."""

BENDS = 1e-4
"""rad (m): a larger range of what a motor leads its link by is not that of a rigid drive."""


class Estimates(NamedTuple):
    """drives: None if not sought, or not found, see notes.  rotors: joints whose rotors come from there.

    doubts: gears, clocks and delays that differ from what was stated.
    """

    rigid: RigidEstimate
    drives: DriveEstimates | None
    rotors: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def estimates(
    before: Robot,
    fitted: Recording,
    friction: FrictionWish,
    stamped: Recording | None,
    resolution: Array | None,
    torque_delay: float,
    how: Mapping[str, Any],
    say: Steps,
) -> Estimates:
    """Links first, then springs from these, then links again with rotors and kinematic errors from the motors' sides.

    fitted: torques at the times at which they act.  stamped: as stamped, since springs need to know how they were held
    until then; None if no springs are sought.  resolution: rad, see `encoder_steps`.
    how: further arguments of `identify_rigid`.  say: called with each step.  Errors are those of `identify_rigid`.
    """
    say("links, rotors and friction")
    rigid = identify_rigid(before, fitted, friction=friction, **how)
    gains = gain_notes(before, fitted, how.get("torque_constants"), how.get("cutoff"))
    if stamped is None:
        return Estimates(rigid, None, doubts=gains)
    say.expect(1 + len(joints_that_bend(before)))
    stamped = _with_torques(before, stamped, how.get("torque_constants"))
    try:
        drives = identify_drives(
            rigid.robot, stamped, resolution, torque_delay, lambda joint: say(f"spring of {joint}")
        )
    except (CutpointError, KeyboardInterrupt) as error:  # the links' estimates are useful without springs
        why = error if isinstance(error, CutpointError) else INTERRUPTED
        return Estimates(rigid, None, doubts=gains, notes=(f"springs were not identified: {why}",))
    found = drives.joints.items()
    doubts = (*gains, *drives.doubts, *_late(drives, torque_delay))
    notes = (*_coarse(drives), *_zeros(before, drives), *drives.notes)
    rotors = tuple(joint for joint, each in found if each.apart and "rotor inertia" not in each.unidentifiable)
    errors = {joint: each.spring.kinematic_error for joint, each in found if not each.clocks}
    errors = {joint: error for joint, error in errors.items() if error is not None}
    seen = {joint: each.drive for joint, each in found if each.apart and not each.clocks and friction != "stated"}
    if not rotors and not errors and not seen:
        return Estimates(rigid, drives, (), doubts, notes)
    say("links again, with what the motors tell")
    # friction laws chosen while waves disturbed the torques are chosen again without them
    chosen = friction if errors else rigid.friction or friction
    how = {**how, "friction": chosen, "kinematic_errors": errors}
    sided = before.with_drives({joint: on_sides_seen(before.drives[joint], drive) for joint, drive in seen.items()})
    again = _with_rotors(sided, drives, rotors, fitted, **how)
    return Estimates(_with_priors_of(before, again), drives, rotors, doubts, notes)


def _with_torques(robot: Robot, recording: Recording, constants: Mapping[str, float] | None) -> Recording:
    """With torques from currents, if used: data that identified the links cannot identify the constants again."""
    if "current" not in recording.channels or ("torque" in recording.channels and constants is None):
        return recording
    recording = recording.in_order(robot.joints)
    return replace(recording, torque=torques_of(robot, recording, constants), current=None)


def _coarse(drives: DriveEstimates) -> tuple[str, ...]:
    """A sentence if encoders are coarse compared with the springs' deflections."""
    counts = {joint: each.spring.counts for joint, each in drives.joints.items() if 1.0 <= each.spring.counts < FINE}
    if not counts:
        return ()
    shown = ", ".join(f"{joint} {count:.0f}" for joint, count in counts.items())
    few = f"half a deflection's range is only a few encoder steps ({shown})"
    then = "rotors came out up to 5 % off and damping up to twice too large, both beyond their intervals"
    return (f"{few}: below {FINE:g}, {then}",)


def _zeros(robot: Robot, drives: DriveEstimates) -> tuple[str, ...]:
    """A sentence if the encoders of motors and links have different zeros; without a spring nothing tells them."""
    springs = {joint: each.spring for joint, each in drives.joints.items() if "stiffness" not in each.unidentifiable}
    found = {joint: spring.offset for joint, spring in springs.items() if abs(spring.offset) > ZEROS}
    if not found:
        return ()
    units = at_joints(robot, "rad")
    shown = ", ".join(f"{joint} {offset:.3g} {units[joint]}" for joint, offset in found.items())
    then = "weights come from the links' encoders, and are as wrong as their zeros"
    return (f"motors' encoders lead the links' where springs carry no load ({shown}): do their zeros agree?  {then}",)


def _late(drives: DriveEstimates, supposed: float) -> tuple[str, ...]:
    delays = {joint: each.delay for joint, each in drives.joints.items() if each.delay}
    damped = [joint for joint, each in drives.joints.items() if "damping" not in each.unidentifiable]
    return delay_notes(delays, supposed, damped)


def springs_wanted(before: Robot, recording: Recording, springs: bool | None) -> bool:
    """Whether springs are sought: by default if they can be found, and there are any.

    Raises InputError if they are requested without encoders on both sides.
    """
    both = {"q", "theta"} <= set(recording.channels)
    if springs and not both:
        there = ", ".join(recording.channels)
        raise InputError(f"springs need positions of both sides, q and theta; the recording holds {there}")
    if springs is None:
        return both and any(drive.is_elastic for drive in before.drives.values())
    return springs


def unsought(before: Robot, recording: Recording, springs: bool | None) -> tuple[str, ...]:
    """A sentence if motors lead their links as springs let them, but no drive of the files has one, so that none was
    sought."""
    recorded = recording.in_order(before.joints)
    if springs is not None or recorded.q is None or recorded.theta is None or springs_wanted(before, recording, None):
        return ()
    lead = recorded.theta - recorded.q
    known = lead[np.isfinite(lead).all(axis=1)]
    ranges = dict(zip(before.joints, np.ptp(known, axis=0).tolist() if len(known) else (), strict=False))
    units = at_joints(before, "rad")
    shown = ", ".join(f"{joint} {size:.2g} {units[joint]}" for joint, size in ranges.items() if size > BENDS)
    if not shown:
        return ()
    words = f"what theta leads q by changes ({shown}), though no drive of the files bends"
    return (f"{words}: springs=True, --springs, identifies springs",)


def _with_rotors(
    before: Robot, sprung: DriveEstimates, known: Sequence[str], fitted: Recording, **how: Any
) -> RigidEstimate:
    """Links and friction with known rotors: torques determine sums of both, the motors' sides separate them."""
    rotors = {joint: sprung.joints[joint].rotor for joint in known}
    drives = {joint: _turning(before.drives[joint], rotor.inertia) for joint, rotor in rotors.items()}
    errors = {joint: rotor.deviations["inertia"] for joint, rotor in rotors.items()}
    sides = {joint: sprung.joints[joint].drive.link_friction for joint in known}
    rubs = {joint: law for joint, law in sides.items() if law is not None}
    sought = [joint for joint in before.joints if joint not in known]
    how |= {"rotors": sought if how["rotors"] else False, "rotor_errors": errors, "link_friction": rubs}
    return identify_rigid(before.with_drives(drives), fitted, **how)


def _with_priors_of(files: Robot, found: RigidEstimate) -> RigidEstimate:
    """The estimate whose priors of friction are the files', not what encoders saw."""

    def prior(name: str, own: float) -> float:
        return stated_coefficient(files, name) if name.partition(".")[0] in FRICTION else own

    return replace(found, parameters=tuple(p._replace(prior=prior(p.name, p.prior)) for p in found.parameters))


def _turning(drive: Drive, inertia: float) -> Drive:
    return replace(drive, rotor=replace(drive.rotor or Rotor(0.0), inertia=inertia))

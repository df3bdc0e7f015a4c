"""`identify`: from a log to an identified robot, with uncertainties, and files of both."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import check_kind, check_truths, number, path_of
from cutpoint.errors import InputError
from cutpoint.formats.drives.file_writing import worded
from cutpoint.identification.conditioning.alignment import aligned
from cutpoint.identification.conditioning.bridging import bridged
from cutpoint.identification.conditioning.other_sides import with_other_sides
from cutpoint.identification.drives.identify_drives import DriveEstimates, checked_delay, encoder_steps
from cutpoint.identification.logs.doubts import Cause, Doubt
from cutpoint.identification.logs.even_times import evenly_stamped
from cutpoint.identification.logs.joining import joined
from cutpoint.identification.logs.read_recording import read_recording
from cutpoint.identification.logs.recording import EFFORTS, UNEVEN, Recording
from cutpoint.identification.logs.repeats import only_new_rows, without_repeats
from cutpoint.identification.logs.spikes import without_spikes
from cutpoint.identification.logs.stuck import side_notes
from cutpoint.identification.logs.suspicions import refuse_other_units, suspicions
from cutpoint.identification.logs.table import placed
from cutpoint.identification.one_thread import by_one_thread
from cutpoint.identification.output.drive_numbers import drive_numbers
from cutpoint.identification.output.error_warnings import unit_notes, warnings_of
from cutpoint.identification.output.estimates import Estimates, estimates, springs_wanted, unsought
from cutpoint.identification.output.identification import Identification
from cutpoint.identification.output.numbers import Number, rigid_numbers
from cutpoint.identification.output.steps import Steps
from cutpoint.identification.output.swaps import swap_notes
from cutpoint.identification.output.torque_errors import TorqueErrors, torque_errors
from cutpoint.identification.rigid.arguments import check_method
from cutpoint.identification.rigid.identify_rigid import FrictionWish, Method
from cutpoint.identification.rigid.physical import Solver, check_solver
from cutpoint.joint_units import at_joints, words_at
from cutpoint.loading import load
from cutpoint.robot import Robot

SPRING_PARTS = ("compliance", "damping", "kinematic_error", "hysteresis", "motor")
"""Parts of a drive that two encoders determine; rotors and friction come with the links."""

MOST_HELD = 0.9

OneLog = Recording | str | Path


@by_one_thread
def identify(
    robot: Robot | str | Path,
    log: OneLog | Sequence[OneLog],
    mapping: str | Path | Mapping[str, Any] | None = None,
    drives: str | Path | None = None,
    *,
    hold_out: float = 0.3,
    springs: bool | None = None,
    rotors: bool = True,
    friction: FrictionWish = "choose",
    method: Method = "huber",
    solver: Solver = "lmi",
    cutoff: float | None = None,
    bandwidth: float | None = None,
    torque_delay: float = 0.0,
    align: bool = False,
    torque_constants: Mapping[str, float] | None = None,
    source: str | Path | None = None,
    xacro: Mapping[str, str] | None = None,
    progress: bool = False,
) -> Identification:
    """Inertias, rotors, friction and, from encoders on both sides, springs of a robot's drives, from a log.

    robot: as its files have it, or its file with `drives`.
    log, mapping: a recording, or as for `read_recording`; of several logs all are used, see `joined`.
    hold_out: share of the log, at its end, that is not fitted: the model's errors there show whether it generalises.
    springs: whether to identify them; by default if both `q` and `theta` were recorded and a drive is elastic.
    rotors: whether to estimate rotor inertias: not from torques measured at the gears' output.
    friction, method, solver, cutoff, bandwidth, torque_constants: as in `identify_rigid`.
    torque_delay: s by which torques act later than their time stamps: half a control period for held commands.
    align: whether the links' encoders are aligned with the motors' clock first, see `aligned`.
    source: the file of a robot given as an object, with joints locked for example: `save` rewrites it.
    xacro: arguments of the robot's .xacro file, as for `load`.
    progress: whether to show a progress bar on stderr.  Ctrl-C during the search for springs leaves out those
    that are not found yet.

    Raises:
        ModelError, InputError: an error in a file or an argument, files that do not match, or a log named twice.
    """
    torque_delay = number("identify", "torque_delay", torque_delay, "s")
    if not 0.0 <= number("identify", "hold_out", hold_out) <= MOST_HELD:
        raise InputError(f"hold_out {hold_out} must be a share of the log, 0 to {MOST_HELD}", hold_out=hold_out)
    check_truths("identify", rotors=rotors, align=align, progress=progress)
    if springs is not None:
        check_truths("identify", springs=springs)
    check_kind("identify", "robot", robot, (Robot, str, PathLike), "a Robot, or the path of a robot file")
    file = path_of("identify", source) if source is not None else None if isinstance(robot, Robot) else Path(robot)
    check_method(method)
    check_solver(solver)
    how: dict[str, Any] = {"rotors": rotors, "method": method, "solver": solver, "cutoff": cutoff}
    how |= {"bandwidth": bandwidth, "torque_constants": torque_constants}
    with Steps(3, progress) as say:
        say("reading the log")
        logs = _each_once(log)
        before, stamped, resolution = _read(robot, logs, mapping, drives, xacro)
        with placed(_files(logs)):
            stamped = aligned(stamped) if align else stamped
            recording = _acting(stamped, torque_delay)
            fitted, held_from = _fitted(recording, hold_out)
            drives_see = _fitted(stamped, hold_out)[0] if springs_wanted(before, fitted, springs) else None
            found = estimates(before, fitted, friction, drives_see, resolution, torque_delay, how, say)
            found = found._replace(notes=(*found.notes, *unsought(before, fitted, springs)))
            say("torques on the part held out")
            errors = torque_errors(before, found.rigid, recording, held_from, torque_constants, bandwidth)
    return _identification(before, file, xacro or {}, recording, found, errors)


def _each_once(log: OneLog | Sequence[OneLog]) -> list[OneLog]:
    """One log or several as a list.  Raises InputError for one that is named twice."""
    logs = [*log] if isinstance(log, Sequence) and not isinstance(log, str) else [log]
    seen: set[object] = set()
    for each in logs:
        is_file = isinstance(each, (str, Path))
        key = Path(each).resolve() if is_file else id(each)
        if key in seen:
            what = repr(str(each)) if is_file else "a recording"
            raise InputError(f"identify: {what} is named twice; name each log once", log=each)
        seen.add(key)
    return logs


def _files(logs: Sequence[OneLog]) -> str:
    """Names of the logs' files, for errors in what was read."""
    return ", ".join(str(log) for log in logs if not isinstance(log, Recording))


def _read(
    robot: Robot | str | Path,
    logs: Sequence[OneLog],
    mapping: str | Path | Mapping[str, Any] | None,
    drives: str | Path | None,
    xacro: Mapping[str, str] | None,
) -> tuple[Robot, Recording, Array | None]:
    """The robot as its files state it, and the recording at uniform times, without spikes, repeats and short gaps.

    Last, the resolution of the encoders on both sides, see `encoder_steps`, in the order of the robot's joints.
    """
    before = robot if isinstance(robot, Robot) else load(robot, drives, xacro=xacro)
    recordings = [_recorded(log, mapping, before) for log in logs]
    with placed(_files(logs)):
        recording = recordings[0] if len(recordings) == 1 else joined([*map(_named, logs, recordings)])
        bend = [joint for joint, drive in before.drives.items() if drive.is_elastic]
        recording = with_other_sides(recording.with_notes(side_notes(recording, bend)))
    are_both = {"q", "theta"} <= recording.channels.keys() and {*before.joints} <= {*recording.joints}
    resolution = encoder_steps(recording.in_order(before.joints)) if are_both else None
    clean = without_spikes(without_repeats(recording))
    return before, bridged(clean, _at_uniform_times(clean)), resolution


def _recorded(log: OneLog, mapping: str | Path | Mapping[str, Any] | None, robot: Robot) -> Recording:
    found = _suspected(log, robot) if isinstance(log, Recording) else read_recording(log, mapping, robot)
    return evenly_stamped(only_new_rows(found))


def _named(log: OneLog, recording: Recording) -> Recording:
    """The recording, whose notes name its file."""
    if isinstance(log, Recording):
        return recording
    notes = (type(note)(f"{Path(log).name}: {note}") for note in recording.notes)
    return replace(recording, notes=tuple(notes))


def _identification(
    before: Robot,
    source: Path | None,
    xacro: Mapping[str, str],
    recording: Recording,
    found: Estimates,
    errors: TorqueErrors,
) -> Identification:
    """All results, in the numbers and words of a report."""
    rigid, sprung = found.rigid, found.drives
    after, words = _with_springs(rigid.robot, sprung)
    words += _one_sided(before, recording)
    of_log = [note for note in recording.notes if isinstance(note, Cause)]
    # such channels explain torques that are unlike the files'
    swapped = [] if of_log else swap_notes(before, recording, errors, rigid.cutoff)
    unit = unit_notes(errors, before.drives, from_currents="torque" not in recording.channels)
    causes = (*of_log, *swapped, *unit)
    odd = [note for note in recording.notes if isinstance(note, Doubt) and not isinstance(note, Cause)]
    notes = (*found.notes, *rigid.notes, *map(str, rigid.friction), *words)
    return Identification(
        robot=after,
        before=before,
        source=source,
        xacro=xacro,
        rigid=rigid,
        drives=sprung,
        numbers=_numbers(before, after, found),
        errors=errors,
        recording=recording,
        untold=(*rigid.untold, *_untold(found)),
        causes=causes,
        doubts=(*causes, *odd, *found.doubts, *rigid.doubts, *warnings_of(errors, at_joints(after, "N m"))),
        notes=tuple(note for note in notes if not isinstance(note, Doubt)),
    )


def _one_sided(robot: Robot, recording: Recording) -> list[str]:
    """On encoders on only one side of elastic drives."""
    missing = {"q", "theta"} - recording.channels.keys()
    if not missing or not any(drive.is_elastic for drive in robot.drives.values()):
        return []
    there, other = ("motors", "links") if "q" in missing else ("links", "motors")
    words = f"only the {there}' positions were recorded and stand in for the {other}', though drives bend"
    return [f"{words}: no interval covers their difference"]


def _fitted(recording: Recording, hold_out: float) -> tuple[Recording, float]:
    """The fitted part, and the time, s, after which samples are held out."""
    start, end = recording.time[[0, -1]].tolist()
    held_from = end - hold_out * (end - start) if hold_out else np.inf
    return recording.between(start, held_from), held_from


def _numbers(before: Robot, after: Robot, found: Estimates) -> tuple[Number, ...]:
    numbers = rigid_numbers(after, found.rigid)
    for joint, each in found.drives.joints.items() if found.drives else ():
        own = drive_numbers(joint, before.drives[joint], each, joint in found.rotors)
        numbers += tuple(
            replace(each, unit=at_joints(before, each.unit)[joint], why=words_at(before, joint, each.why))
            for each in own
        )
    return numbers


def _untold(found: Estimates) -> tuple[str, ...]:
    """What the drives' own channels do not determine, except rotors that the torques of all joints determine."""
    rotors = {p.name.removeprefix("I_m.") for p in found.rigid.parameters if p.name.startswith("I_m.") and p.told}
    told = tuple(f"{joint}: rotor inertia " for joint in rotors)
    return tuple(words for words in found.drives.untold if not words.startswith(told)) if found.drives else ()


def _suspected(recording: Recording, robot: Robot) -> Recording:
    """The recording with the notes that a log file would get, unless it has them already.  InputError as for a file."""
    refuse_other_units(recording, robot)
    return recording.with_notes([words for words in suspicions(recording) if words not in recording.notes])


def _at_uniform_times(recording: Recording) -> Recording:
    steps = np.diff(recording.time)
    if np.abs(steps - steps.mean()).max() > UNEVEN * steps.mean():
        return recording.resampled(float(np.median(steps)))
    return recording


def _acting(recording: Recording, torque_delay: float) -> Recording:
    """Torques at the times at which they act."""
    torque_delay = checked_delay("identify", torque_delay, recording)
    channels = [name for name in EFFORTS if name in recording.channels]
    if not torque_delay or not channels:
        return recording
    # a torque that acts later than its stamp is stamped too early
    moved = aligned(recording, dict.fromkeys(recording.joints, -torque_delay), channels)
    when = f"{'later' if torque_delay > 0.0 else 'earlier'} by {1e3 * abs(torque_delay):.3f} ms"
    return replace(moved, notes=(*recording.notes, f"{', '.join(channels)} moved {when}, for all joints alike"))


def _with_springs(robot: Robot, sprung: DriveEstimates | None) -> tuple[Robot, list[str]]:
    """The robot with the springs, in terms of a drive file; and what had to change for that."""
    notes: list[str] = []
    drives = {}
    for joint, drive in robot.drives.items():
        if sprung and joint in sprung.joints:
            found = sprung.joints[joint].drive
            parts = SPRING_PARTS if drive.rotor else ("rotor", *SPRING_PARTS)
            drive = replace(drive, **{name: getattr(found, name) for name in parts})
        drives[joint], changed = worded(drive)
        notes += [f"{joint}: {words}" for words in changed]
    return robot.with_drives(drives), notes

"""Warnings from torque errors, in sentences."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.output.block_bootstrap import Ratio
from cutpoint.identification.output.torque_errors import TorqueErrors, mean_known
from cutpoint.model.drive import Drive

WORSE = 2.0
"""Times the error on the fitted part: with a larger one on the rest, the model does not generalise."""

STILL = 0.1
"""Share of the RMS speed on the fitted part."""

POOR = 0.5
"""Share of the torque itself: with a larger error, the model was fitted to something else."""

TURNED = -0.8
"""Correlation of a torque with the files' model: below, a sign is reversed; noise or wrong masses do not cause it."""

LEAST_ERROR_SHARE = 0.02
"""Share of the torque itself: a smaller error is not mentioned, whichever model is better."""

MORE = 1.05
"""Times the error of the files' model: up to this, both explain the torques equally well."""

UNLIKE = 30.0
"""Ratio to the torques of the files' model: no mass is that wrong, not even one that is missing."""

SMALL = 0.2
"""The same where files predict more than was measured: masses that are too large are so by less."""

ALIKE = 0.5
"""Least correlation with these of a joint whose torques alone are that large: else friction may be."""

EXPLAINED = 2.0
"""Times, or its inverse, that may be left of such a ratio by a unit that explains it: masses and friction are."""

DRIFTS = 1.0
"""Times the error on the fitted part: a larger change of friction causes most of it."""

BRIEF = 0.05
"""Share of the fitted part: half of the squared error within less is due to an event."""

TINY = float(np.finfo(float).tiny)

UNEVEN = 1.1
"""Least ratio of the share of errors at rest to the share of time at rest, if rest is the cause."""

STEADY = 0.5
"""Share of the squared held-out error: a larger one of its mean is named."""

MOST_OF_ERROR = 0.5
"""Share of the squared error that counts as most of it."""


def warnings_of(errors: TorqueErrors, units: Mapping[str, str]) -> list[str]:
    """On joints whose held-out torques carry no information, or are explained much worse than the fitted ones, or than
    by plain least squares.  units: of their torques, by joint."""
    notes = [*_of_rest(errors, [*units]), *_of_events(errors, [*units]), *_of_still(errors, [*units])]
    for j, ((joint, unit), ratio) in enumerate(zip(units.items(), errors.to_plain(), strict=True)):
        notes += [f"{joint}: {note}" for note in _of_joint(errors, j, ratio, unit)]
    return notes


def unit_notes(errors: TorqueErrors, drives: Mapping[str, Drive], from_currents: bool = False) -> list[str]:
    """A sentence on torques of a size that no masses explain: of all joints, or of those whose are like the files'; and
    on what explains it.  drives: by joint.  from_currents: whether torques are those of recorded currents."""
    measured, files = (np.sqrt(mean_known(x**2)) for x in (errors.measured, errors.before))
    times = measured / np.maximum(files, TINY)
    unlike = (times > UNLIKE) | (times < SMALL)
    if not unlike[np.isfinite(times)].all():
        unlike &= np.abs(np.diag(errors.likeness())) > ALIKE
    if not unlike.any():
        return []
    ratios = dict(zip(drives, times.tolist(), strict=True))
    far = [joint for joint, each in zip(drives, unlike, strict=True) if each]
    which = ", ".join(f"{joint} {ratios[joint]:.3g} times" for joint in far)
    words = "torques are far from what the robot's files predict for this motion"
    return [f"{words}, {which}: {_cause(ratios, far, drives, from_currents)}"]


def _cause(ratios: Mapping[str, float], far: list[str], drives: Mapping[str, Drive], from_currents: bool) -> str:
    """What explains ratios to the files' torques, by joint, and what to do.  far: joints that need an explanation."""
    gears = {joint: abs(drive.ratio) for joint, drive in drives.items()}
    in_amperes = {j: abs(d.motor.torque_constant * d.ratio) for j, d in drives.items() if d.motor}
    of_torques = {
        "in amperes, by the drives' torque constants and ratios: map them as 'current: {channels: ..., unit: A}', or "
        "as 'torque: {channels: ..., unit: A, gain: ...}'": in_amperes,
        "in N m at the motor's shaft: map them as 'torque: {channels: ..., side: motor}'": gears,
        "in mN m: map them as 'torque: {channels: ..., unit: mN m}'": dict.fromkeys(drives, 1e-3),
    }
    of_currents = {"if the torque constants given are those at the motor's shaft: multiply them by the ratios": gears}
    told: list[str] = []
    for words, worth in (of_currents if from_currents else of_torques).items():
        named = [joint for joint, each in worth.items() if _explains(float(each), ratios[joint])]
        if not set(named).isdisjoint(far):
            some = "" if from_currents or len(named) == len(drives) else ", with a list that states it for each joint"
            told.append(f"{'they' if named == far else ', '.join(named)} would fit {words}{some}")
    unit = "unit and the torque constants" if from_currents else "unit, such as amperes"
    return "; ".join(told) or f"check their {unit}, and whether they are at the motor's shaft or at the joint"


def _explains(worth: float, ratio: float) -> bool:
    """Whether a ratio to the files' torques is due to a unit of this worth, and not to masses and friction."""
    return 1.0 / EXPLAINED < worth * ratio < EXPLAINED and not 1.0 / EXPLAINED < ratio < EXPLAINED


def _of_rest(errors: TorqueErrors, joints: Sequence[str]) -> list[str]:
    """Joints with most of their error at rest, in one sentence."""
    times, squares = errors.resting()
    is_large = errors.rms("after", held_out=True) > LEAST_ERROR_SHARE * errors.size()
    found = [j for j in range(len(joints)) if is_large[j] and squares[j] > max(MOST_OF_ERROR, UNEVEN * times[j])]
    if not found:
        return []
    which = ", ".join(f"{joints[j]} {squares[j]:.0%} in {times[j]:.0%} of the time" for j in found)
    what = "most of the squared torque error on the part held out occurs at rest"
    return [f"{what}, where friction is whatever holds the joint and no law predicts it: {which}"]


def _of_events(errors: TorqueErrors, joints: Sequence[str]) -> list[str]:
    """Joints most of whose error on the fitted part occurs in a brief time, and not on the part held out."""
    start, length = errors.burst()
    fitted, held = errors.rms("after"), errors.rms("after", held_out=True)
    whole = float(np.ptp(errors.time[~errors.held_out]))
    is_event = (length < BRIEF * whole) & (fitted > LEAST_ERROR_SHARE * errors.size()) & (fitted > WORSE * held)
    is_event &= ~_stand_still(errors)
    found = np.flatnonzero(is_event).tolist()
    if not found:
        return []
    which = ", ".join(f"{joints[j]} within {length[j]:.2g} s from {start[j]:.4g} s on" for j in found)
    cause = "a contact, or a clock that jumped: leave that time out, or end the log before it"
    return [f"half of the squared torque error on the fitted part occurs in a short time, as by {cause}: {which}"]


def _of_still(errors: TorqueErrors, joints: Sequence[str]) -> list[str]:
    """Joints that stand still on the part held out and not on the fitted one, in one sentence."""
    found = np.flatnonzero(_stand_still(errors)).tolist()
    words = "errors on the part held out prove nothing of joints that hardly move there"
    return [f"{words}: {', '.join(joints[j] for j in found)}"] if found else []


def _stand_still(errors: TorqueErrors) -> NDArray[np.bool_]:
    return errors.speed(held_out=True) < STILL * errors.speed()


def _of_joint(errors: TorqueErrors, j: int, ratio: Ratio, unit: str) -> list[str]:
    if errors.speed()[j] == 0.0:
        return []  # it stood still, of which there is a note: its torque is whatever holds it
    fitted, held, before = errors.rms("after")[j], errors.rms("after", True)[j], errors.rms("before")[j]
    size = errors.size()[j]
    least = LEAST_ERROR_SHARE * size
    notes: list[str] = []
    if fitted > POOR * size:
        what = f"the model misses its torque by {fitted:.3g} {unit} RMS, out of {size:.3g}"
        turned = "is the sign of the torque or of the position reversed?"
        asked = f"it opposes what the files predict: {turned}" if errors.likeness()[j, j] < TURNED else ""
        notes.append(f"{what}: {asked or 'check its columns, signs and units'}")
    if held > max(WORSE * fitted, least):
        times = f"{held / fitted:.1f} times that on the fitted part"
        bias, reason = float(errors.bias()[j]), "it moves differently there, or the machine changed"
        if bias**2 > STEADY * held**2:
            what = f"{abs(bias):.3g} {unit} {'more' if bias > 0.0 else 'less'}"
            reason = f"its torque there is {what} in the mean, by a payload, or an offset that drifts"
        rule = "intervals are for one machine that stays as it is, and do not include this"
        notes.append(f"torque error on the part held out is {times}: {reason}; {rule}")
    if ratio.is_more and held > least:
        times = f"{ratio.low:.2f} to {ratio.high:.2f} times that of plain least squares"
        notes.append(f"torque error on the part held out is {times}: check signs and units, or record longer")
    drift = float(errors.drift()[j])
    if abs(drift) > max(DRIFTS * fitted, least):
        what = f"{abs(drift):.3g} {unit} {'more' if drift > 0.0 else 'less'}"
        remedy = "as if warming up: the result lies in between; record it warm, or for a shorter time"
        notes.append(f"friction takes {what} at the end of the log than at its beginning, {remedy}")
    if fitted > MORE * before:
        notes.append("the identified model explains its torque worse than the files did")
    return notes

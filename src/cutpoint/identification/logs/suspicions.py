"""Plausibility checks of a recording: channels that are constant, clipped, or not in the stated units."""

import math
from collections.abc import Callable, Collection, Iterator

import numpy as np
from scipy.ndimage import binary_erosion

from cutpoint.arrays import Array
from cutpoint.errors import InputError, counted
from cutpoint.identification.logs.doubts import Cause, Doubt
from cutpoint.identification.logs.jumps import MOST_DEFLECTION, jump_notes
from cutpoint.identification.logs.recording import Recording, travel
from cutpoint.identification.logs.resampling import longest_step
from cutpoint.identification.logs.spikes import SELDOM, without_spikes
from cutpoint.identification.logs.stuck import copy_notes, stuck_notes
from cutpoint.identification.logs.time_stamps import check_period
from cutpoint.model.limits import check_configuration
from cutpoint.robot import Robot

CUT_OFF = 0.01
"""Share of the samples: more at the same extreme are clipped, not motion."""

IN_A_ROW = 5
"""Consecutive samples at the extreme: a peak has fewer."""

TURNS = 4.0
"""Turns: positions of an arm hardly span more."""

UNLIKE = 10.0
"""Times as far as nearly all others: such samples are false."""

FITS = 0.1
"""Tolerance of a factor that should be 1: noise and deflection have a smaller effect."""

EXPLANATIONS = {
    -1.0: "a wrong sign",
    180.0 / math.pi: "degrees for radians",
    math.pi / 180.0: "radians for degrees",
    30.0 / math.pi: "rpm for rad/s",
    1.0 / (2.0 * math.pi): "turns for radians",
}


def refuse_other_units(
    recording: Recording, robot: Robot, stated: Collection[str] = (), shifted: Collection[str] = ()
) -> None:
    """Raises InputError for positions far beyond a joint's limits, such as degrees or counts taken as radians, or mm as
    metres; for motors whose positions are all the links' times one factor; and for a clock in another unit.

    Single false samples, which `identify` replaces, do not count.  stated: channels whose units the log or its mapping
    states: another is not suggested.  shifted: channels to which the mapping adds an offset.
    """
    try:
        _refuse(recording, robot, stated, shifted)
    except InputError:
        _refuse(without_spikes(recording), robot, stated, shifted)


def _refuse(recording: Recording, robot: Robot, stated: Collection[str], shifted: Collection[str]) -> None:
    check_period(recording.time, "time")
    _refuse_one_factor(recording, robot)
    for name in ("q", "theta"):
        for joint, x in _columns(recording, name):
            if joint in robot.drives and np.isfinite(x).any():
                furthest = dict.fromkeys(robot.drives, 0.0) | {joint: float(x[np.nanargmax(np.abs(x))])}
                try:
                    check_configuration(robot.mechanism, [*furthest.values()])
                except InputError as error:
                    words = _beyond(name, joint, x, recording, robot, name in stated)
                    si = "m" if joint in robot.mechanism.sliding else "rad"
                    also = f"; or the offset that is stated for it, in {si} whatever the unit" * (name in shifted)
                    raise InputError(f"{words}{also}", **error.evidence) from error


def _refuse_one_factor(recording: Recording, robot: Robot) -> None:
    pairs = [*zip(_columns(recording, "theta"), _columns(recording, "q"), strict=False)]
    ratios = [robot.drives[joint].ratio for (joint, _), _ in pairs if joint in robot.drives]
    all_of = (_factor(theta, q, recording.time) for (_, theta), (_, q) in pairs)
    factors = [factor for factor in all_of if factor is not None]
    if any(abs(factor / ratio - 1.0) < FITS for factor in factors for ratio in ratios):
        return  # rotors before their gears
    for value, words in EXPLANATIONS.items():
        if value > 0.0 and factors and all(abs(factor / value - 1.0) < FITS for factor in factors):
            found = f"theta of all joints is {factors[0]:.4g} times q: {words}?"
            remedy = "state the unit of one in a mapping, as in 'theta: {channels: ..., unit: ...}'"
            raise InputError(f"{found}  If so, {remedy}", factor=factors[0])


def _are_rotors(recording: Recording, joint: str, ratio: float) -> bool:
    """Whether a motor's position is that of its rotor, compared with the link's."""
    if "q" not in recording.channels:
        return False
    both = np.column_stack([recording[name][:, recording.joints.index(joint)] for name in ("q", "theta")])
    known = both[np.isfinite(both).all(axis=1)]
    q, theta = (known - known.mean(axis=0)).T if len(known) else known.T
    return bool(abs(q @ theta - ratio * (q @ q)) < FITS * abs(ratio) * (q @ q))


def _beyond(name: str, joint: str, x: Array, recording: Recording, robot: Robot, is_stated: bool) -> str:
    """What positions (N,) far beyond a joint's limits look like.  is_stated: whether their unit is."""
    ratio, slides = robot.drives[joint].ratio, joint in robot.mechanism.sliding
    si = "m" if slides else "rad"
    runs = f"{name} of joint {joint!r} runs from {np.nanmin(x):.4g} to {np.nanmax(x):.4g} {si}"
    false = np.flatnonzero(np.abs(x) > UNLIKE * np.nanquantile(np.abs(x), 1.0 - SELDOM))
    if false.size:
        few = f"{counted(false.size, 'sample')}, from {recording.time[false[0]]:.4g} s on"
        return f"{runs}, far beyond its limits, in only {few}: leave the cells of false samples empty"
    mapped = f"in a mapping, '{name}: {{channels: ..., "
    if name == "theta" and _are_rotors(recording, joint, ratio):
        return f"{runs}, the ratio times as far as q, so it is the rotor's: state that {mapped}side: motor}}'"
    looks, unit = _likely_unit(slides, x, recording, robot)
    causes = [f"this looks like {looks}: state that {mapped}unit: {unit}}}'"]
    if name == "theta" and "q" not in recording.channels and abs(ratio) != 1.0:
        causes.append(f"it is the rotor's, before the gear of ratio {ratio:g}: state that {mapped}side: motor}}'")
    if name == "theta" and ratio == 1.0:
        causes.append("it is the rotor's, and the gear ratio is missing: give its drive file")
    if is_stated:
        causes = [*causes[1:], "the unit that is stated for it is wrong"]
    return f"{runs}, far beyond its limits; {'; or '.join(causes)}"


def _likely_unit(slides: bool, x: Array, recording: Recording, robot: Robot) -> tuple[str, str]:
    """The unit that positions (N,) seem to be in, and what a mapping states for that."""
    if not slides and (_known(x) == np.round(_known(x))).all():
        return "counts", "counts, counts_per_turn: ..."
    own, other, looks = ("mm", "rad", "mm") if slides else ("deg", "m", "degrees")
    units = [own if (each in robot.mechanism.sliding) == slides else other for each in recording.joints]
    return looks, own if other not in units else f"[{', '.join(units)}]"


def suspicions(recording: Recording) -> list[str]:
    """A note on each thing that looks wrong, naming its joints; some are a `Doubt`, or a `Cause` of others."""
    notes: list[str] = [*copy_notes(recording), *stuck_notes(recording), *jump_notes(recording)]
    for name in recording.channels:
        notes += _noted(recording, name, "holds no numbers", lambda x: not np.isfinite(x).any())
        notes += _noted(recording, name, "lacks some samples", lambda x: 0 < int(np.isnan(x).sum()) < x.size)
        notes += _noted(recording, name, "never changes: was it measured?", _is_constant)
    for name in ("torque", "current"):
        rule = "stays at its extreme: was it clipped?  If so, leave these parts out"
        notes += map(Doubt, _noted(recording, name, rule, _is_cut_off))
    for name in ("q", "theta"):
        rule = f"spans more than {TURNS:g} turns: degrees for radians, or mm for m?"
        notes += _noted(recording, name, rule, lambda x: _span(x) > TURNS * 2.0 * math.pi)
    unlike = _unlike(recording)
    return [*notes, *(_unlike(without_spikes(recording)) if unlike else []), *_other_zeros(recording)]


def _unlike(recording: Recording) -> list[Doubt]:
    """Notes on channels that are multiples of others: of speeds, and of motors, which nothing else can explain."""
    return [*map(Doubt, _unlike_rates(recording)), *map(Cause, _unlike_sides(recording))]


def _unlike_rates(recording: Recording) -> Iterator[str]:
    """A note on each speed that is a multiple of its position's."""
    time = recording.time
    for whole, rate in (("q", "v"), ("theta", "theta_dot")):
        for (joint, x), (_, v) in zip(_columns(recording, whole), _columns(recording, rate), strict=False):
            travelled = 0.5 * (v[1:] + v[:-1]) * np.diff(time)
            factor = _multiple(*_ways(time, travelled, np.diff(x)), time[1:])
            yield from _notes_on_factor(f"{rate} of {joint!r}", f"the rate of {whole}", factor)


def _unlike_sides(recording: Recording) -> Iterator[str]:
    """A note on each motor whose position is a multiple of its link's."""
    for (joint, x), (_, theta) in zip(_columns(recording, "q"), _columns(recording, "theta"), strict=False):
        factor = _multiple(theta, x, recording.time)
        yield from _notes_on_factor(f"theta of {joint!r}", "q", factor)


def _other_zeros(recording: Recording) -> Iterator[str]:
    """A note on each joint whose encoders have different zeros."""
    for (joint, x), (_, theta) in zip(_columns(recording, "q"), _columns(recording, "theta"), strict=False):
        lead = _known(theta - x)
        if abs(float(np.median(lead))) > max(MOST_DEFLECTION, float(np.ptp(lead))):
            yield f"theta of {joint!r} leads q by about {np.median(lead):.3g} rad (m) throughout: do their zeros agree?"


def _ways(time: Array, first: Array, second: Array) -> tuple[Array, Array]:
    """Cumulated steps (N - 1,) of two channels, without those across a gap or unknown in either."""
    known = (np.diff(time) <= longest_step(time)) & np.isfinite(first) & np.isfinite(second)
    return np.cumsum(np.where(known, first, 0.0)), np.cumsum(np.where(known, second, 0.0))


def _factor(found: Array, expected: Array, time: Array) -> float | None:
    """f of found = f * expected + offset + drift * time, by least squares; None if nothing moves."""
    known = np.isfinite(found) & np.isfinite(expected)
    if known.sum() < 4 or _is_constant(found[known]) or _is_constant(expected[known]):
        return None
    regressors = np.column_stack([expected, np.ones_like(time), time])[known]
    return float(np.linalg.lstsq(regressors, found[known], rcond=None)[0][0])


def _multiple(found: Array, expected: Array, time: Array) -> float | None:
    """`_factor`, but None for two that differ by no more than springs deflect, as of a joint that stands still."""
    apart = found - expected
    known = np.isfinite(apart)
    drift = np.polynomial.Polynomial.fit(time[known], apart[known], 1)(time) if known.any() else 0.0
    return None if travel(apart - drift) < MOST_DEFLECTION else _factor(found, expected, time)


def _notes_on_factor(thing: str, other: str, factor: float | None) -> Iterator[str]:
    if factor is None or abs(factor - 1.0) < FITS:
        return
    near = [words for value, words in EXPLANATIONS.items() if abs(factor / value - 1.0) < FITS]
    yield f"{thing} is {factor:.4g} times {other}: {near[0] if near else 'another unit, side or joint'}?"


def _noted(recording: Recording, name: str, rule: str, is_wrong: Callable[[Array], bool]) -> list[str]:
    joints = [joint for joint, x in _columns(recording, name) if is_wrong(x)]
    return [f"{name} of {', '.join(joints)} {rule}"] if joints else []


def _columns(recording: Recording, name: str) -> list[tuple[str, Array]]:
    values = recording.channels.get(name)
    return [] if values is None else list(zip(recording.joints, values.T, strict=True))


def _span(x: Array) -> float:
    """Of nearly all samples: few may be false."""
    low, high = np.quantile(_known(x), [0.5 * SELDOM, 1.0 - 0.5 * SELDOM])
    return float(high - low)


def _known(x: Array) -> Array:
    found = x[np.isfinite(x)]
    return found if found.size else np.zeros(1)


def _is_constant(x: Array) -> bool:
    return bool(np.isfinite(x).any()) and travel(x) == 0.0


def _is_cut_off(x: Array) -> bool:
    if _is_constant(x) or not np.isfinite(x).any():
        return False
    extremes = x == np.nanmin(x), x == np.nanmax(x)
    return any(at.mean() > CUT_OFF and binary_erosion(at, np.ones(IN_A_ROW)).any() for at in extremes)

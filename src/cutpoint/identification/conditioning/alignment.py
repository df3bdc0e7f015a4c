"""Alignment of channels from two clocks."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import NoneType

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import check_kind, checked_names, number
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.clock_skew import Skew, clock_skew
from cutpoint.identification.logs.recording import Recording, check_recording, travel
from cutpoint.identification.logs.resampling import on_grid

LINK_SIDE = ("q", "v")
"""The channels of a link's encoder, which often has a clock of its own."""


STANDS_OUT = 2.0
"""Standard deviations: a smaller measured delay is not corrected."""


def skews(recording: Recording) -> dict[str, Skew]:
    """Delay of each link's encoder relative to its motor's, for joints that show it.

    A drive's deflection under friction looks like a delay.  If torque or current was recorded, a second fit includes
    the deflection due to it; that one is biased by friction on the motor's side, which causes no deflection.  The delay
    is their mean, and half of their difference is part of the uncertainty.

    Raises:
        InputError: times that are not uniform, a channel that was not recorded, or no joint with both sides moving.
    """
    check_recording("skews", recording)
    period, channels = recording.period, recording.channels
    torques = channels.get("torque", channels.get("current"))
    found = {
        joint: _skew(recording["q"][:, k], recording["theta"][:, k], torques, k, period)
        for k, joint in enumerate(recording.joints)
        if travel(recording["q"][:, k]) and travel(recording["theta"][:, k])
    }
    if not found:
        raise InputError("no joint moves in both 'q' and 'theta': nothing shows a delay")
    return found


def aligned(
    recording: Recording, delays: Mapping[str, Skew | float] | None = None, channels: Sequence[str] = LINK_SIDE
) -> Recording:
    """Channels shifted to earlier times by their joints' delays, s, positive for late ones; by default the link's by
    its measured delay relative to the motor's.

    Measured delays that agree are attributed to one clock, and their mean is used for all.  Joints without a
    significant delay are unchanged, and a note says so.  NaN at the ends, where nothing was sampled.
    Raises InputError as `skews` does, for a delay that is not finite or of a joint that was not recorded, and if none
    of the channels was recorded.
    """
    check_recording("aligned", recording)
    check_kind("aligned", "delays", delays, (Mapping, NoneType), "a mapping of joint names to delays, s")
    channels = checked_names("aligned", channels, "channels", "names of channels")
    measured = _of_one_clock(skews(recording)) if delays is None else delays
    unknown = set(measured) - set(recording.joints)
    if unknown:
        raise InputError(f"no joint {sorted(unknown)[0]!r} was recorded; there are: {', '.join(recording.joints)}")
    seconds = np.array([_delay(measured.get(joint, 0.0)) for joint in recording.joints])
    there = [name for name in channels if name in recording.channels]
    if not there:
        raise InputError(f"none of {', '.join(channels)} was recorded; there are: {', '.join(recording.channels)}")
    moved = {name: _earlier(recording.time, recording[name], seconds) for name in there}
    return replace(recording, **moved).with_notes(_notes(", ".join(there), measured))


def _skew(x: Array, y: Array, torques: Array | None, column: int, period: float) -> Skew:
    plain = clock_skew(x, y, period)
    if torques is None:
        return plain
    torque = torques[:, column]
    known = np.isfinite(torque)
    load = np.where(known, torque, 0.0)
    bent = clock_skew(np.where(known, x, np.nan), y, period, lambda y, *_: np.column_stack([y, load]))
    uncertainty = float(np.hypot(plain.uncertainty, 0.5 * (plain.delay - bent.delay)))
    return Skew(0.5 * (plain.delay + bent.delay), uncertainty, plain.residual)


def _of_one_clock(measured: dict[str, Skew]) -> dict[str, Skew]:
    """Their weighted mean for all, if some delay is significant and all agree with it."""
    delays, deviations = (np.array([getattr(x, name) for x in measured.values()]) for name in ("delay", "uncertainty"))
    weights = 1.0 / np.maximum(deviations, np.finfo(float).tiny) ** 2
    mean, deviation = float(np.average(delays, weights=weights)), float(1.0 / np.sqrt(weights.sum()))
    if not any(map(_delay, measured.values())) or (np.abs(delays - mean) > STANDS_OUT * deviations).any():
        return measured
    return {joint: Skew(mean, deviation, each.residual) for joint, each in measured.items()}


def _delay(given: Skew | float) -> float:
    """The delay to correct, s."""
    if isinstance(given, Skew):
        return given.delay if abs(given.delay) > STANDS_OUT * given.uncertainty else 0.0
    delay = number("aligned", "delay", given, "s")
    if not np.isfinite(delay):
        raise InputError(f"aligned: delay {delay} s must be finite", delay=delay)
    return delay


def _earlier(time: Array, values: Array, delays: Array) -> Array:
    """Each column, shifted to earlier times by its delay."""
    columns = [on_grid(time, x, time + tau) if tau else x for x, tau in zip(values.T, delays, strict=True)]
    return np.column_stack(columns)


def _notes(channels: str, measured: Mapping[str, Skew | float]) -> list[str]:
    words = {joint: _words(each) for joint, each in measured.items()}
    moved = [f"{joint} by {words[joint]}" for joint, each in measured.items() if _delay(each)]
    stayed = [f"{joint} ({words[joint]})" for joint, each in measured.items() if not _delay(each)]
    notes: list[str] = []
    if moved:
        notes.append(f"{channels} moved earlier: {', '.join(moved)}; intervals do not include the error of this")
    if stayed:
        notes.append(f"{channels} not moved, as no delay stands out: {', '.join(stayed)}")
    return notes


def _words(given: Skew | float) -> str:
    if isinstance(given, Skew):
        return f"{1e3 * given.delay:.3f} +- {1e3 * given.uncertainty:.3f} ms"
    return f"{1e3 * given:.3f} ms"

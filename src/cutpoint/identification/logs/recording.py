"""Sensor data of a machine over time, in the models' units and on their side of the joint."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.door import check_kind, checked_name, checked_names, checked_numbers, number
from cutpoint.errors import InputError, counted
from cutpoint.identification.logs.resampling import close, on_grid, uniform_times

QUANTITIES = ("q", "theta", "v", "theta_dot", "torque", "current")
"""The channels that a recording may have."""

EFFORTS = ("torque", "current")
"""Those of the motors."""

UNEVEN = 1e-3
"""Share of the period by which steps of a uniform time may differ: rounding in text files."""


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """Measured channels over common times, each (N, n) with a column per joint or None; NaN where unknown.

    time: (N,), s, increasing, from 0 at the first sample as read.
    joints: their n names, all different.
    q, v: the link's position and speed, rad, rad/s (m, m/s).
    theta, theta_dot: the motor's over ratio, rad, rad/s (m, m/s).
    torque: the motor's times ratio, N m (N), as commanded or measured.
    current: the motor's, A.
    notes: what was repaired, and what looks wrong, in words for a reader.

    Raises:
        InputError: times that do not increase, names or shapes that do not fit, infinite numbers, no channel at all.
    """

    time: Array
    joints: tuple[str, ...]
    q: Array | None = None
    theta: Array | None = None
    v: Array | None = None
    theta_dot: Array | None = None
    torque: Array | None = None
    current: Array | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        time = _frozen("time", self.time)
        if time.ndim != 1 or time.size < 2 or not np.isfinite(time).all() or (np.diff(time) <= 0.0).any():
            raise InputError(f"time of shape {time.shape} must be (N,), N at least 2, finite and increasing")
        joints = checked_names("Recording", self.joints)
        object.__setattr__(self, "notes", checked_names("Recording", self.notes, "notes", "sentences"))
        if not joints or len(set(joints)) < len(joints) or "" in joints:
            raise InputError(f"joints {joints} must be distinct names", joints=joints)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "joints", joints)
        if not self.channels:
            raise InputError(f"a recording needs at least one of {', '.join(QUANTITIES)}")
        for name, values in self.channels.items():
            object.__setattr__(self, name, _checked(name, values, (time.size, len(self.joints))))

    def __repr__(self) -> str:
        span = f"{self.time.size} samples over {self.time[-1] - self.time[0]:g} s"
        notes = counted(len(self.notes), "note")
        return f"Recording({span}: {', '.join(self.channels)} of {', '.join(self.joints)}; {notes})"

    @property
    def channels(self) -> dict[str, Array]:
        """The recorded channels, (N, n), by name."""
        found = {name: getattr(self, name) for name in QUANTITIES}
        return {name: values for name, values in found.items() if values is not None}

    def __getitem__(self, name: str) -> Array:
        """A channel, (N, n).  Raises InputError for one that was not recorded, with a list of those that were."""
        return self.channels[checked_name("recorded channel", name, self.channels)]

    @property
    def period(self) -> float:
        """s between samples.  Raises InputError where the times are not uniform: `resampled` makes them so."""
        steps = np.diff(self.time)
        period = float(self.time[-1] - self.time[0]) / steps.size
        if np.abs(steps - period).max() > UNEVEN * period:
            raise InputError(
                f"times are not uniform: steps from {steps.min():.3g} s to {steps.max():.3g} s; "
                f"use recording.resampled({np.median(steps):.3g})"
            )
        return period

    def between(self, start: float, end: float) -> "Recording":
        """The samples from `start` to `end` s, both included.  Raises InputError if there are fewer than two."""
        start, end = number("between", "start", start, "s"), number("between", "end", end, "s")
        kept = (self.time >= start) & (self.time <= end)
        if kept.sum() < 2:
            span = f"from {self.time[0]:g} s to {self.time[-1]:g} s"
            raise InputError(f"fewer than two samples from {start} s to {end} s: the recording runs {span}")
        return self.with_channels(lambda values: values[kept], time=self.time[kept])

    def resampled(self, period: float) -> "Recording":
        """On a uniform time, from the first sample on; NaN in gaps.  See `resampling.on_grid`.

        Raises InputError for a period that is not positive, or gives fewer than two samples or too many.
        """
        period = number("resampled", "period", period, "s")
        grid, steps = uniform_times(self.time, period), np.diff(self.time)
        note = f"resampled to a period of {period:g} s"
        if f"{np.median(steps):.3g}" != f"{period:.3g}":
            note += f" from one of {np.median(steps):.6g} s"
        if np.ptp(steps) > UNEVEN * np.median(steps):
            note += f", with steps from {steps.min():.3g} to {steps.max():.3g} s"
        if near := int(close(self.time).sum()):
            note += f"; averaged with the one right before: {counted(near, 'sample')}"
        return self.with_channels(lambda values: on_grid(self.time, values, grid), time=grid).with_notes([note])

    def joint(self, name: str) -> "Recording":
        """One joint's channels, (N, 1).  Raises InputError for an unknown name, with a list of the known ones."""
        return self.in_order([name])

    def in_order(self, names: Sequence[str]) -> "Recording":
        """These joints' channels, (N, n), a column for each name.  Raises InputError for an unknown name."""
        columns = [self.joints.index(checked_name("joint", name, self.joints)) for name in names]
        return self.with_channels(lambda values: values[:, columns], joints=tuple(names))

    def complete(self) -> NDArray[np.bool_]:
        """Which samples have a number in every channel of every joint, (N,) of bool."""
        return np.asarray(np.isfinite(np.column_stack([*self.channels.values()])).all(axis=1))

    def with_channels(self, change: Callable[[Array], Array], **others: Any) -> "Recording":
        """A recording with every channel changed in the same way, and other fields replaced."""
        return replace(self, **{name: change(values) for name, values in self.channels.items()}, **others)

    def with_notes(self, notes: Sequence[str]) -> "Recording":
        """A recording with further notes."""
        return replace(self, notes=(*self.notes, *checked_names("with_notes", notes, "notes", "texts")))


def _frozen(name: str, values: Any) -> Array:
    copy = checked_numbers("Recording", name, values).copy()
    copy.setflags(write=False)
    return copy


def _checked(name: str, values: Any, shape: tuple[int, int]) -> Array:
    found = _frozen(name, values)
    if found.shape != shape:
        raise InputError(f"channel {name!r} has shape {found.shape}: it must be {shape}, samples and joints")
    if np.isinf(found).any():
        raise InputError(f"channel {name!r} holds infinite numbers: mark unknown ones as NaN")
    return found


def travel(values: Array) -> float:
    """How far a joint's channel (N,) goes, NaN aside."""
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if known.size else 0.0


def check_recording(function: str, recording: Any) -> None:
    """Raises InputError for an argument that is not a recording.  function: the caller."""
    check_kind(function, "recording", recording, Recording, "a Recording (read_recording reads logs)")

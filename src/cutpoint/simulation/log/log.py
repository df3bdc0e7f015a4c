"""The log of a run: named channels with units over time."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import check_kind, checked_names, checked_numbers, number, path_of
from cutpoint.errors import InputError, unknown_name
from cutpoint.joint_units import either

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cutpoint.analysis.certificate import Certificate
    from cutpoint.robot import Robot
    from cutpoint.simulation.plant import State

Unit = str | tuple[str, ...]

RESERVED = ("time", "header")
"""Names that a file of ours gives to other things."""


class Run(NamedTuple):
    """What was simulated: robot, controller, the links' reference with four derivatives, (5, N, n), and the state at
    the last sample, if all of it was recorded."""

    robot: "Robot"
    controller: Any
    reference: Array
    end: "State | None" = None

    def __repr__(self) -> str:
        law = type(self.controller).__name__ if self.controller is not None else "no controller"
        end = "with its state at the end" if self.end else "without its state at the end"
        return f"Run({self.robot!r}, {law}, {self.reference.shape[1]} samples, {end})"


@dataclass(frozen=True, eq=False, repr=False)
class Log:
    """Channels over the same times.

    time: (N,), s, increasing.
    channels: by name, each (N, n) with a column per joint, or (N,); they may hold NaN, as in a failed run.
    units: of every channel, or one unit per joint where they differ (`("rad", "m")`); "" where there is none.
    joints: their n names, in the order of the columns.
    meta: any JSON data about the run.
    run: what was simulated; None for a log from elsewhere, such as a file.

    Raises:
        InputError: times that do not increase, shapes that do not match, a missing unit, or a meta that JSON cannot
            represent.
    """

    time: Array
    channels: Mapping[str, Array]
    units: Mapping[str, Unit]
    joints: tuple[str, ...]
    meta: Mapping[str, Any] = field(default_factory=dict[str, Any])
    run: Run | None = None

    def __post_init__(self) -> None:
        check_kind("Log", "channels", self.channels, Mapping, "arrays by name")
        check_kind("Log", "units", self.units, Mapping, "the unit of every channel, by name")
        time = _frozen("time", self.time)
        if time.ndim != 1 or not time.size or not np.isfinite(time).all() or (time[1:] <= time[:-1]).any():
            raise InputError(f"time of shape {time.shape} must be (N,), N at least 1, finite and increasing")
        joints = checked_names("Log", self.joints)
        if len(set(joints)) < len(joints) or "" in joints:
            raise InputError(f"joints {joints} must be distinct names", joints=joints)
        channels = {name: _frozen(name, values) for name, values in self.channels.items()}
        for name, values in channels.items():
            _check_channel(name, values, time.size, len(joints))
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "joints", joints)
        object.__setattr__(self, "channels", channels)
        object.__setattr__(self, "units", {name: _unit(name, self.units, len(joints)) for name in channels})
        object.__setattr__(self, "meta", _as_json(self.meta))

    def __reduce__(self) -> tuple[Any, ...]:
        """Rebuilt from its parts, so that copies are read-only too."""
        return Log, (self.time, self.channels, self.units, self.joints, self.meta, self.run)

    def __getitem__(self, name: str) -> Array:
        """A channel, (N, n) or (N,).  Raises InputError for an unknown name, with a list of the known ones."""
        check_kind("log", "channel", name, str, "a name, such as 'q'")
        if name not in self.channels:
            raise unknown_name("channel", name, self.channels)
        return self.channels[name]

    def __contains__(self, name: str) -> bool:
        return name in self.channels

    def __repr__(self) -> str:
        units = {name: unit if isinstance(unit, str) else either(unit) for name, unit in self.units.items()}
        shown = ", ".join(f"{name} [{units[name]}]" for name in self.channels)
        times = f"{self.time.size} samples from {self.time[0]:g} s to {self.time[-1]:g} s"
        return f"Log({times}{self._first_fault()}: {shown})"

    def _first_fault(self) -> str:
        """What its repr says about a law's fault: nothing without one."""
        faults = np.nan_to_num(self.channels.get("fault", np.zeros(1)))
        if faults.ndim > 1 or not faults.any():
            return ""
        from cutpoint.control import Fault

        first = int(np.flatnonzero(faults)[0])
        names = {fault: f" ({fault.name.lower()})" for fault in Fault}
        return f", with fault {faults[first]:g}{names.get(faults[first], '')} from {self.time[first]:g} s on"

    def columns(self, name: str) -> tuple[tuple[str, str], ...]:
        """The joint and the unit of each column of a channel; the joint is "" in a channel that has no joints.

        Raises InputError for an unknown channel.
        """
        values, unit = self[name], self.units[name]
        if values.ndim == 1:
            return (("", str(unit)),)
        units = (unit,) * len(self.joints) if isinstance(unit, str) else unit
        return tuple(zip(self.joints, units, strict=True))

    def rms(self, name: str) -> Array:
        """Root mean square over the samples, (n,) or (), in the channel's unit; NaN where a sample is.

        Raises InputError for an unknown channel.
        """
        values = self[name]
        return np.sqrt(np.einsum("n...,n...->...", values, values) / len(values))

    def max(self, name: str) -> Array:
        """Largest absolute value, (n,) or (), in the channel's unit; NaN where a sample is.

        Raises InputError for an unknown channel.
        """
        return np.abs(self[name]).max(axis=0)

    def between(self, start: float, end: float) -> "Log":
        """The samples from `start` to `end` s, both included.  Raises InputError where there are none."""
        start, end = number("between", "start", start, "s"), number("between", "end", end, "s")
        kept = (self.time >= start) & (self.time <= end)
        if not kept.any():
            span = f"from {self.time[0]:g} s to {self.time[-1]:g} s"
            raise InputError(f"no samples from {start} s to {end} s: the log runs {span}", start=start, end=end)
        channels = {name: values[kept] for name, values in self.channels.items()}
        run = self.run
        if run:
            run = run._replace(reference=run.reference[:, kept], end=run.end if kept[-1] else None)
        return Log(self.time[kept], channels, self.units, self.joints, self.meta, run)

    @property
    def end(self) -> "State":
        """The plant's state at the last sample, to continue from: `simulate(..., initial=log.end)`.

        Law, sensors and reference start afresh; commands still delayed in a motor are not included.
        Raises InputError for a log that was not simulated here with all channels, or without its last sample.
        """
        if self.run is None or self.run.end is None:
            raise InputError(
                "end: only a complete log of this process's own simulation, with all channels, has its final state"
            )
        return self.run.end

    def plot(self, *names: str, beside: "Mapping[str, Log] | None" = None, label: str = "") -> "Figure":
        """A picture, angles in degrees: `log.plot("q", "reference_q").savefig("run.png")`.

        With names, channels of the same unit share one small axis per joint, and errors another.  Without, each channel
        has one axis.
        beside: other logs by name, whose named channels are drawn too: `log.plot("position_error", beside={"VDC": b})`.
        label: this log's own name in the legend, among others.
        Raises InputError for a channel that a log lacks, logs beside without names of channels, or a name given twice.
        """
        from cutpoint.simulation.log.plot import check_beside, picture

        others: Mapping[str, Log] = beside or {}
        check_beside(others, names, label)
        return picture({label: self, **others}, names)

    def certificate(self) -> "Certificate":
        """The power-flow certificate of a run under `control.VDC`: see `analysis.certificate.Certificate`.

        Raises InputError for a log that was not simulated here, or under another law.
        """
        from cutpoint.analysis.certificate import certificate

        return certificate(self)

    def to_dataframe(self) -> Any:
        """A pandas DataFrame: index `time`, s, columns `q.elbow` (or `power`), `attrs` with units and meta.

        Raises CutpointError where pandas is not installed.
        """
        from cutpoint.simulation.log.frame import frame

        return frame(self)

    def save(self, path: str | Path) -> None:
        """Writes an .npz or a .csv, as the path's ending says; `Log.load` gives back every number exactly.

        An existing file is replaced, whole or not at all.
        Raises InputError for another ending, a folder that does not exist, or a log too large for a file.
        """
        from cutpoint.simulation.log.files import save

        save(self, path_of("save", path))

    @classmethod
    def load(cls, path: str | Path) -> "Log":
        """A log that `save` wrote; its `run` is None.  Raises InputError for a file that is none."""
        from cutpoint.simulation.log.files import load

        return load(path_of("Log.load", path, "a log"))


def column_name(channel: str, joint: str) -> str:
    """How tables call a column."""
    return f"{channel}.{joint}" if joint else channel


def _frozen(name: str, values: Any) -> Array:
    """A read-only copy; an array that is read-only already is not copied.  Raises InputError."""
    found = checked_numbers("Log", name, values)
    owner: Any = found if found.base is None else found.base
    if found is values and not found.flags.writeable and isinstance(owner, np.ndarray) and not owner.flags.writeable:
        return found
    copy = found.copy()
    copy.setflags(write=False)
    return copy


def _check_channel(name: str, values: Array, count: int, joints: int) -> None:
    if not name.isidentifier() or name in RESERVED:
        raise InputError(f"channel {name!r} must be named like a variable, and not one of {RESERVED}", channel=name)
    if values.shape not in ((count,), (count, joints)):
        raise InputError(f"channel {name!r} has shape {values.shape}: it must be {(count,)} or {(count, joints)}")


def _all_strings(found: Iterable[Any]) -> bool:
    return all(isinstance(each, str) for each in found)


def _unit(name: str, units: Mapping[str, Unit], joints: int) -> Unit:
    if name not in units:
        raise InputError(f"channel {name!r} has no unit: units must name every channel; '' means none", channel=name)
    unit = units[name]
    if isinstance(unit, str):
        return unit
    if len(unit) != joints or not _all_strings(unit):
        raise InputError(f"channel {name!r} has units {unit}: it must have one, or one for each of {joints} joints")
    return tuple(unit)


def _as_json(meta: Mapping[str, Any]) -> dict[str, Any]:
    """The meta as read back from a file: lists for tuples, strings for keys."""
    try:
        return json.loads(json.dumps(dict(meta)))
    except (TypeError, ValueError) as error:
        raise InputError(f"meta must be JSON: numbers, strings, lists and dicts: {error}") from error

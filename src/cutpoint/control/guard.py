"""Safety around a law: what it may not do, what it may not be told, and what happens then."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Literal, NamedTuple

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Wrapper
from cutpoint.errors import InputError, unknown_name
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar, absolute, clip, leaves, maximum, rebuild, where

Reaction = Literal["hold", "ramp", "stop"]
SEVERITY = {"hold": 1, "ramp": 2, "stop": 3}
LARGEST = 1e12
"""A number beyond this counts as not finite."""


class Fault(IntEnum):
    """What was found first; the log's channel `fault` holds its number."""

    NONE = 0
    MEASUREMENT = 1
    STALE = 2
    DEADLINE = 3
    SPEED = 4
    POSITION = 5
    COMMAND = 6


REACTIONS: dict[str, Reaction] = {
    "measurement": "hold", "stale": "hold", "deadline": "ramp", "speed": "ramp", "position": "ramp", "command": "ramp",
}  # fmt: skip
"""measurement: not finite.  stale: its time stamp stands still.  deadline: it comes half a period late or later.
speed, position: a joint beyond its limits.  command: the law's torque is not finite."""


class Watch(NamedTuple):
    """The guard's memory: last time stamp (s), the fault found first, how severe reactions have become, what is left of
    the torque, the last safe command, and the law's own memory."""

    time: Any
    fault: Any
    severity: Any
    share: Any
    torque: Any
    theta: Any
    theta_dot: Any
    inner: Any


@dataclass(frozen=True, eq=False)
class Guard(Wrapper):
    """A law within limits, and a stated reaction to each fault: once one is found, it is latched.

    "hold" keeps the last safe torque; "ramp" takes it to zero within ramp_time (s); "stop" drops it at once.  A later
    fault can only make the reaction more severe.  `reactions` replaces some of REACTIONS.  Torques are clipped to
    torque_limit, which is no fault.  Limits are those of the robot's joints and drives unless given, one for each drive
    or one for all: torque_limit (N m), speed_limit (rad/s), lower and upper (rad).
    A fault is a number in the log, see `Fault`; after it the law's memory stands still.
    """

    law: Any
    robot: Robot
    reactions: Any = field(default_factory=dict)
    ramp_time: Any = 0.2
    torque_limit: Any = None
    speed_limit: Any = None
    lower: Any = None
    upper: Any = None

    @property
    def reports_faults(self) -> bool:
        return True

    def __post_init__(self) -> None:
        for name, reaction in self.reactions.items():
            if name not in REACTIONS:
                raise unknown_name("fault", name, REACTIONS)
            if reaction not in SEVERITY:
                raise unknown_name("reaction", reaction, SEVERITY)
        if isinstance(self.ramp_time, (int, float)) and not self.ramp_time > 0:
            raise InputError(f"Guard: ramp_time {self.ramp_time} s must be positive")
        limits = [body.joint.limits for body in self._driven]
        own = [drive.limits for drive in self.robot.drives.values()]
        found = {
            "torque_limit": [min(a.effort or np.inf, b.effort) for a, b in zip(limits, own, strict=True)],
            "speed_limit": [min(a.velocity or np.inf, b.velocity) for a, b in zip(limits, own, strict=True)],
            "lower": [a.lower for a in limits],
            "upper": [a.upper for a in limits],
        }
        for name, values in found.items():
            given = getattr(self, name)
            object.__setattr__(self, name, self._limit(name, values if given is None else given))

    @property
    def _driven(self) -> list[Any]:
        bodies = {body.joint.name: body for body in self.robot.mechanism.bodies}
        return [bodies[name] for name in self.robot.drives]

    def _limit(self, name: str, value: Any) -> Any:
        array = np.asarray(value)
        if array.dtype == object:
            return array
        n = len(self.robot.drives)
        if array.shape not in ((), (n,)) or np.isnan(array).any():
            raise InputError(f"Guard: {name} {value} must be numbers, one or one for each of {n} drives", limit=name)
        return np.broadcast_to(array, n).astype(float)

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.robot.drives)

    def start(self) -> Watch:
        nothing = [0.0] * self.size
        return Watch(-np.inf, 0.0, 0.0, 1.0, nothing, nothing, nothing, self.inner_start())

    def step(self, memory: Watch, measurement: Measurement, reference: Reference) -> tuple[Watch, Command]:
        inner, command = self.inner_step(memory.inner, measurement, reference)
        theta = reference.theta if command.theta is None else command.theta
        theta_dot = reference.theta_dot if command.theta_dot is None else command.theta_dot
        found, severity = self._found(memory, measurement, command)
        fault = where(memory.fault > 0, memory.fault, found)
        severity = maximum(memory.severity, severity)
        # what is left of the last safe torque
        ramped = maximum(memory.share - measurement.period / self.ramp_time, 0)
        share = where(severity > 2, 0.0, where(severity > 1, ramped, memory.share))
        safe = [clip(u, -limit, limit) for u, limit in zip(command.torque, self.torque_limit, strict=True)]
        torque = self._unless(fault, safe, memory.torque)
        theta, theta_dot = (
            self._unless(fault, [*x], y) for x, y in ((theta, memory.theta), (theta_dot, memory.theta_dot))
        )
        kept = rebuild(inner, iter(self._unless(fault, leaves(inner), leaves(memory.inner))))
        told = np.array([share * u for u in torque])
        after = Watch(measurement.time, fault, severity, share, torque, theta, theta_dot, kept)
        return after, Command(told, command.feedforward, np.array(theta), np.array(theta_dot), fault)

    def _found(self, memory: Watch, m: Measurement, command: Command) -> tuple[Scalar, Scalar]:
        """The first fault of this sample, and how severe the reactions to all of them are."""
        late = m.time - memory.time
        speeds, positions = [*m.v, *m.theta_dot], [*m.q, *m.theta]
        limits = [*self.speed_limit] * 2
        happened = {
            Fault.MEASUREMENT: _any(_is_odd(x) for x in (*positions, *speeds, m.time)),
            Fault.STALE: where(late < m.period / 2, 1.0, 0.0),
            Fault.DEADLINE: where(late < 3 * m.period / 2, 0.0, where(late < LARGEST, 1.0, 0.0)),
            Fault.SPEED: _any(where(absolute(v) > limit, 1.0, 0.0) for v, limit in zip(speeds, limits, strict=True)),
            Fault.POSITION: _any(
                where(q < low, 1.0, where(q > high, 1.0, 0.0))
                for q, low, high in zip(m.q, self.lower, self.upper, strict=True)
            ),
            Fault.COMMAND: _any(_is_odd(x) for x in command.torque),
        }
        found: Scalar = 0.0
        severity: Scalar = 0.0
        reactions = {**REACTIONS, **self.reactions}
        for fault, here in reversed([*happened.items()]):
            found = where(here > 0, float(fault), found)
            severity = maximum(severity, here * float(SEVERITY[reactions[fault.name.lower()]]))
        return found, severity

    @staticmethod
    def _unless(fault: Scalar, new: list[Scalar], old: list[Scalar]) -> list[Scalar]:
        return [where(fault > 0, y, x) for x, y in zip(new, old, strict=True)]


def _is_odd(x: Scalar) -> Scalar:
    """1 where a number is not finite."""
    return where(absolute(x) < LARGEST, 0.0, 1.0)


def _any(conditions: Any) -> Scalar:
    total: Scalar = 0.0
    for x in conditions:
        total = maximum(total, x)
    return total

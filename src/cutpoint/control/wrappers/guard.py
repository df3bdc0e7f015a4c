"""Safety around a law: limits on its torque, checks of its measurements, and the reaction to faults."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import partial, reduce
from typing import Any, NamedTuple

import numpy as np

from cutpoint.control.interface import SENSED, Command, Measurement, Reference, completed
from cutpoint.control.law import Wrapper, as_law, check_drives
from cutpoint.control.own_law import own_parts
from cutpoint.control.wrappers.guard_limits import LIMITS, limits_of
from cutpoint.door import check_kind, checked_name, positive
from cutpoint.kernels import Traced
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot
from cutpoint.scalars import Scalar, absolute, clip, leaves, maximum, rebuild, where, with_float_leaves

SEVERITY = {"hold": 1, "ramp": 2, "stop": 3}
"""Of the reactions to a fault: see `Guard`."""

BEYOND_MEASURE = 1e12
"""A number beyond this counts as not finite."""


class Fault(IntEnum):
    """The first fault found; the log's channel `fault` holds its number.

    MEASUREMENT: a number that the law needs is not finite; the law then reads the last that was.  STALE: the time stamp
    stands still; DEADLINE follows once it goes on.  DEADLINE: a measurement comes half a period late or later.  SPEED:
    a joint's limit is passed by either encoder.  POSITION: it is by the link's or, where that says nothing, by the
    motor's.  COMMAND: what the law commands is not finite.  MEMORY: the guard's is none that began with `start`, such
    as zeros, or NaN, in a C program.
    """

    NONE = 0
    MEASUREMENT = 1
    STALE = 2
    DEADLINE = 3
    SPEED = 4
    POSITION = 5
    COMMAND = 6
    MEMORY = 7


REACTIONS = {
    "measurement": "hold", "stale": "hold", "deadline": "ramp", "speed": "ramp", "position": "ramp", "command": "ramp",
    "memory": "stop",
}  # fmt: skip
"""To faults by name, unless a guard is given others."""


class Watch(NamedTuple):
    """The guard's memory: last time stamp (s), last finite measurement, first fault, severity of the reaction so far,
    remaining share of the torque, last safe command, and the law's own memory."""

    time: Any
    seen: Any
    fault: Any
    severity: Any
    share: Any
    torque: Any
    theta: Any
    theta_dot: Any
    inner: Any


@dataclass(frozen=True, eq=False)
class Guard(Wrapper):
    """Keeps a law within limits, with a stated reaction to each fault; faults are latched.

    "hold" keeps the last safe torque; "ramp" takes it to zero within ramp_time (s); "stop" drops it at once.  None of
    them brakes, and a ramp keeps pushing in the direction of the last torque: choose "stop" where that torque caused an
    overspeed.  A later fault can only make the reaction more severe.  "measurement" and "stale" are held, "memory"
    stops and the other faults ramp, unless `reactions` has another entry.
    Torques are clipped to torque_limit, which is no fault.  Limits default to those of the robot's joints and drives;
    given ones are one per drive or one for all: torque_limit (N m), speed_limit (rad/s), lower and upper (rad).
    A law that stops learning at a torque limit does not know a guard's own: state it there too.  What is added outside
    of a guard, as in Guard(robot, a) + b, acts on after its fault: put the guard around the sum.
    A fault is a number in the log, see `Fault`; after it the law's memory is frozen.  If the law has a guard of its
    own, its fault is reported if it came first, and the reaction is left to that guard.
    """

    robot: Robot
    law: Any
    reactions: Any = field(default_factory=dict[str, str])
    ramp_time: Any = 0.2
    torque_limit: Any = None
    speed_limit: Any = None
    lower: Any = None
    upper: Any = None

    @property
    def reports_faults(self) -> bool:
        """Whether its command reports faults: always."""
        return True

    def __post_init__(self) -> None:
        check_robot("Guard", self.robot)
        self._set(law=as_law(self.law))
        check_kind("Guard", "reactions", self.reactions, Mapping, "a reaction for each of some faults, by name")
        for name, reaction in self.reactions.items():
            checked_name("fault", name, REACTIONS)
            checked_name("reaction", reaction, SEVERITY)
        if not isinstance(self.ramp_time, Traced):
            self._set(ramp_time=positive("Guard", "ramp_time", self.ramp_time, "s"))
        self._set(**limits_of(self.robot, {name: getattr(self, name) for name in LIMITS}))
        check_drives(self.law, self.robot.joints)

    @property
    def all_reactions(self) -> dict[str, str]:
        """The reaction to each fault, by name."""
        return {**REACTIONS, **self.reactions}

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.robot.drives)

    def start(self) -> Watch:
        """No sample yet, no fault, zero torque to hold, and the memory of the law inside."""
        nothing, inner = [0.0] * self.size, with_float_leaves(self.inner_start())
        return Watch(-np.inf, nothing * 4, 0.0, 0.0, 1.0, nothing, nothing, nothing, inner)

    def step(self, memory: Watch, measurement: Measurement, reference: Reference) -> tuple[Watch, Command]:
        finite, odd = self._last_finite(memory, measurement)
        inner, command = self.inner_step(memory.inner, finite, reference)
        *parts, reported = completed(command, reference, self.size)
        # a link without an encoder is taken to be where its motor is
        pairs = zip(measurement.q, finite.q, finite.theta, strict=True)
        places = [where(_is_odd(raw) > 0, theta, q) for raw, q, theta in pairs]
        found, severity = self._found(memory, finite, odd, places, parts)
        fault = where(memory.fault > 0, memory.fault, where(found > 0, found, reported))
        # maximum gives its first where its second is NaN, which a memory that was never started may hold
        severity = maximum(severity, memory.severity)
        # remaining share of the last safe torque
        left = maximum(0.0, memory.share)
        ramped = maximum(left - measurement.period / self.ramp_time, 0)
        share = where(severity >= SEVERITY["ramp"], ramped, left)
        share = where(severity >= SEVERITY["stop"], 0.0, share)
        safe = [clip(u, -limit, limit) for u, limit in zip(parts[0], self.torque_limit, strict=True)]
        held = [*map(_finite, (memory.torque, [0.0] * self.size, memory.theta, memory.theta_dot))]
        torque, feedforward, theta, theta_dot = map(partial(_unless, severity), (safe, *parts[1:]), held)
        inner = with_float_leaves(inner)
        kept = rebuild(inner, iter(_unless(severity, leaves(inner), leaves(with_float_leaves(memory.inner)))))
        seen = [x for name in SENSED for x in getattr(finite, name)]
        after = Watch(measurement.time, seen, fault, severity, share, torque, theta, theta_dot, kept)
        commanded = np.array([share * u for u in torque])
        return after, Command(commanded, np.array(feedforward), np.array(theta), np.array(theta_dot), fault)

    def _last_finite(self, memory: Watch, m: Measurement) -> tuple[Measurement, Scalar]:
        """The measurement, non-finite numbers replaced by their last finite ones; whether the law reads any of them."""
        n, odd = self.size, _is_odd(m.time)
        is_silent = any(not hasattr(part, "needs") for part in own_parts(self.law))
        needed = SENSED if is_silent else self.needs
        finite: dict[str, Any] = {}
        for k, name in enumerate(SENSED):
            numbers, last = getattr(m, name), memory.seen[k * n : (k + 1) * n]
            odds = [_is_odd(x) for x in numbers]
            finite[name] = np.array([where(bad > 0, y, x) for bad, x, y in zip(odds, numbers, last, strict=True)])
            odd = reduce(maximum, odds, odd) if name in needed else odd
        return m._replace(**finite), odd

    def _found(
        self, memory: Watch, m: Measurement, odd: Scalar, places: list[Scalar], commanded: list[list[Scalar]]
    ) -> tuple[Scalar, Scalar]:
        """The first fault of this sample, and the severest reaction to any of its faults."""
        late = m.time - memory.time
        speeds, limits = [*m.v, *m.theta_dot], [*self.speed_limit] * 2
        happened = {
            Fault.MEMORY: where(memory.share > 0, 0.0, where(memory.fault > 0, 0.0, 1.0)),
            Fault.MEASUREMENT: odd,
            Fault.STALE: where(late < m.period / 2, 1.0, 0.0),
            Fault.DEADLINE: where(late < 3 * m.period / 2, 0.0, where(late < BEYOND_MEASURE, 1.0, 0.0)),
            Fault.SPEED: _any(where(absolute(v) > limit, 1.0, 0.0) for v, limit in zip(speeds, limits, strict=True)),
            Fault.POSITION: _any(
                where(q < low, 1.0, where(q > high, 1.0, 0.0))
                for q, low, high in zip(places, self.lower, self.upper, strict=True)
            ),
            Fault.COMMAND: _any(_is_odd(x) for part in commanded for x in part),
        }
        found: Scalar = 0.0
        severity: Scalar = 0.0
        reactions = self.all_reactions
        for fault, here in reversed([*happened.items()]):
            found = where(here > 0, float(fault), found)
            severity = maximum(severity, here * float(SEVERITY[reactions[fault.name.lower()]]))
        return found, severity


def _unless(severity: Scalar, new: Sequence[Scalar], old: Sequence[Scalar]) -> list[Scalar]:
    return [where(severity > 0, y, x) for x, y in zip(new, old, strict=True)]


def _finite(held: Sequence[Scalar]) -> list[Scalar]:
    """What is held, 0 where it is not finite, as in a memory that was never started."""
    return [where(_is_odd(x) > 0, 0.0, x) for x in held]


def _is_odd(x: Scalar) -> Scalar:
    """1 where a number is not finite."""
    return where(absolute(x) < BEYOND_MEASURE, 0.0, 1.0)


def _any(conditions: Iterable[Scalar]) -> Scalar:
    return reduce(maximum, conditions, 0.0)

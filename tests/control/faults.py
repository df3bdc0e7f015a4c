"""Faults to put around a guard, or under it, for a while."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint import where
from cutpoint.control.law import Wrapper


@dataclass(frozen=True, eq=False)
class Corrupted(Wrapper):
    """What a law is told of one quantity, from start until end (s): scale times it, plus shift.

    joint: which entry is false; None is all of them.
    """

    law: Any
    quantity: str
    shift: Any
    start_at: Any
    end_at: Any
    scale: Any = 1.0
    joint: int | None = None

    def start(self) -> Any:
        return self.inner_start()

    def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
        t, x = measurement.time, getattr(measurement, self.quantity)
        told = [self._told(t, y) if self.joint in (None, k) else y for k, y in enumerate(np.atleast_1d(x))]
        seen = measurement._replace(**{self.quantity: told[0] if self.quantity == "time" else np.array(told)})
        return self.inner_step(memory, seen, reference)

    def _told(self, t: Any, x: Any) -> Any:
        return where(t < self.start_at, x, where(t < self.end_at, self.scale * x + self.shift, x))


@dataclass(frozen=True, eq=False)
class Mad(Wrapper):
    """A law that commands `torque` (N m) from start until end (s)."""

    law: Any
    torque: Any
    start_at: Any
    end_at: Any

    def start(self) -> Any:
        return self.inner_start()

    def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
        after, command = self.inner_step(memory, measurement, reference)
        t = measurement.time
        told = [where(t < self.start_at, u, where(t < self.end_at, self.torque, u)) for u in command.torque]
        return after, command._replace(torque=np.array(told))

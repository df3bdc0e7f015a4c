"""Interface of all references: position and its time derivatives at any time, constant outside the duration."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import check_kind, check_takes, checked_array, checked_names, given_times, number, whole
from cutpoint.errors import InputError
from cutpoint.trajectories.arrays import numbers


class Sample(NamedTuple):
    """A reference at given times, each (..., n): rad, rad/s, ..., rad/s4 (m, m/s, ... on a prismatic joint)."""

    q: Array
    v: Array
    a: Array
    jerk: Array
    snap: Array


@runtime_checkable
class Moves(Protocol):
    """What a user's own trajectory must have; see `Trajectory`."""

    @property
    def duration(self) -> float: ...

    @property
    def size(self) -> int: ...

    def derivatives(self, t: Any, order: int, /) -> Array: ...


A_TRAJECTORY = "a trajectory: one of cutpoint.trajectories, or what has duration, size and derivatives(t, order)"


def check_trajectory(function: str, trajectory: Any) -> None:
    """Raises InputError for what is no trajectory.  function: who asks."""
    check_kind(function, "trajectory", trajectory, Moves, A_TRAJECTORY)
    if isinstance(trajectory, type):
        name = trajectory.__name__
        raise InputError(f"{function}: trajectory {name} is a class; pass an instance, {name}(...)")
    check_takes(f"{function}: trajectory.derivatives", trajectory.derivatives, "t", "order")


def duration_of(function: str, trajectory: Moves) -> float:
    """Duration of anyone's trajectory, s.  Raises InputError for what is no number."""
    return number(function, "trajectory.duration", trajectory.duration, "s")


def size_of(function: str, trajectory: Moves) -> int:
    """Number of joints of anyone's trajectory.  Raises InputError for what is none."""
    return whole(function, "trajectory.size", trajectory.size, least=0)


def names_of(function: str, trajectory: Moves) -> tuple[str, ...]:
    """Names of the joints of anyone's trajectory; empty if it has none.  Raises InputError for what are none."""
    return checked_names(function, getattr(trajectory, "joints", ()), "trajectory.joints")


def derivatives_of(function: str, trajectory: Moves, times: Array, order: int) -> Array:
    """Position and its first `order` derivatives, (order + 1, ..., size), at times (...), of anyone's trajectory.

    Raises InputError for numbers of another shape, or that are not finite.
    """
    asked, size = f"trajectory.derivatives(times, {order})", size_of(function, trajectory)
    with given_times("trajectory.derivatives", times):
        given = trajectory.derivatives(times, order)
    found = checked_array(function, asked, given, size)
    expected = (order + 1, *times.shape, size)
    if found.shape != expected:
        parts = "position to snap" if order == 4 else f"position and {order} derivatives"
        rule = f"it must be {expected}: {parts}, times, joints"
        raise InputError(f"{function}: {asked} has shape {found.shape}: {rule}", shape=found.shape)
    return found


@dataclass(frozen=True, eq=False)
class Trajectory(ABC):
    """A reference of n joints over the times 0 to `duration`, s.

    Before and after, it holds its first and last position, and all derivatives are zero.  At exactly 0 and `duration`
    the derivatives are the limits from inside.
    """

    duration: float

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of joints, n."""

    @abstractmethod
    def _inside(self, t: Array, order: int) -> Array:
        """(order + 1, ..., n) at times (...), all of them from 0 to `duration`."""

    def derivatives(self, t: ArrayLike, order: int = 4) -> Array:
        """Position and its first `order` time derivatives, (order + 1, ..., n), at times t (...), s.

        Raises:
            InputError: a time is NaN, the order is no whole number from 0, or a derivative is too large for a float.
        """
        times = numbers("time t", t)
        if np.isnan(times).any():
            raise InputError("time t is NaN: it must be a number of seconds", t=t)
        order = whole("derivatives", "order", order, least=0)
        with np.errstate(all="ignore"):
            found = self._inside(np.clip(times, 0.0, self.duration), order)
        if not np.isfinite(found).all():
            told = f"duration {self.duration:g} s is too short for derivatives up to order {order}"
            raise InputError(f"{told}: they are too large for a float", duration=self.duration, order=order)
        found[1:, (times < 0.0) | (times > self.duration)] = 0.0
        return found

    def __call__(self, t: ArrayLike) -> Sample:
        """Position to snap at times t (...), s."""
        return Sample(*self.derivatives(t, 4))

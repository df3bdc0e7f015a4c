"""Arrays of numbers, with the checks that all trajectories share."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import LARGEST, checked_numbers
from cutpoint.errors import InputError, counted


def joint_name(joints: Sequence[str] | None, index: int) -> str:
    """How a message calls a joint: by its name, or where there are no names by its index, counted from 0."""
    return f"joint {joints[index]!r}" if joints else f"joint {index}"


def durations(time: Array) -> Array:
    """Trapezoidal weights of sample times (N,): half of both neighbouring intervals."""
    steps = np.diff(time)
    return (np.r_[steps, 0.0] + np.r_[0.0, steps]) / 2


def numbers(name: str, value: ArrayLike) -> Array:
    """A copy of the value as an array of float64.  Raises InputError for anything else, and for masked ones."""
    return np.array(checked_numbers("trajectory", name, value, "an array of numbers"))


def positions(name: str, value: ArrayLike) -> Array:
    """One position per joint, (n,), finite and within LARGEST; a copy nobody can write to."""
    found = numbers(name, value)
    if found.ndim != 1 or found.size == 0:
        raise InputError(f"{name} has shape {found.shape}: it must be a list of one position per joint", name=name)
    if (wrong := ~(np.abs(found) <= LARGEST)).any():
        index = int(np.argmax(wrong))
        rule = f"it must be finite and within {LARGEST:g}"
        raise InputError(f"{name} of joint {index} is {found[index]}: {rule}", name=name, joint=index)
    found.setflags(write=False)
    return found


def timed_positions(
    times: ArrayLike, points: ArrayLike, least: int, joints: Sequence[str] | None = None
) -> tuple[Array, Array]:
    """Strictly increasing times (N,), counted from the first, and positions (N, n), none beyond LARGEST.

    least: N at least.
    """
    t = numbers("times", times)
    q = numbers("positions", points)
    _check_shapes(t, q, least, joints)
    _check_finite(t, q, joints)
    steps = np.diff(t)
    if (steps <= 0.0).any():
        index = int(np.argmax(steps <= 0.0)) + 1
        raise InputError(f"time {t[index]} s at index {index} must be later than {t[index - 1]} s, the one before it")
    return t - t[0], q


def _check_shapes(t: Array, q: Array, least: int, joints: Sequence[str] | None) -> None:
    if t.ndim != 1 or q.ndim != 2 or q.shape[0] != t.size or q.shape[1] == 0:
        raise InputError(f"times of shape {t.shape} and positions of shape {q.shape} must be (N,) and (N, joints)")
    if t.size < least:
        raise InputError(f"{counted(t.size, 'point')} found: at least {least} are needed", count=t.size)
    if joints is not None and len(joints) != q.shape[1]:
        raise InputError(f"{len(joints)} joint names must match the number of positions, {q.shape[1]}")


def _check_finite(t: Array, q: Array, joints: Sequence[str] | None) -> None:
    if (wrong := ~(np.abs(t) <= LARGEST)).any():
        index = int(np.argmax(wrong))
        rule = f"it must be finite and within {LARGEST:g} s"
        raise InputError(f"time at index {index} is {t[index]}: {rule}", index=index)
    if (wrong := ~(np.abs(q) <= LARGEST)).any():
        row, column = (int(i) for i in np.argwhere(wrong)[0])
        name, rule = joint_name(joints, column), f"must be finite and within {LARGEST:g}"
        raise InputError(f"{name}: position {q[row, column]} at index {row} {rule}", joint=name, index=row)

"""Gains as laws store them: arrays with one entry per drive, validated when a user gives them."""

from typing import Any

import numpy as np

from cutpoint.control.interface import is_traced
from cutpoint.door import checked_numbers, refused
from cutpoint.errors import InputError
from cutpoint.robot import Robot

BOUNDLESS = 1e9
"""N m, of motors without a stated limit: gains are finite."""


def gains(law: str, name: str, value: Any, size: int | None = None, positive: bool = False) -> Any:
    """The gains as an array (n,), finite and not negative; gains of a law that is being traced pass unchecked.

    size: n, if known; a single number is then used for all.  positive: whether zero is refused as well.
    Raises InputError for invalid gains.
    """
    array = np.atleast_1d(numbers_or_traced(law, name, value, "numbers, one for each drive"))
    if is_traced(array):
        return array
    if array.ndim > 1:
        raise InputError(f"{law}: {name} has shape {array.shape}; it must be a number, or a list of one for each drive")
    if not np.isfinite(array).all() or (array < 0).any() or (positive and (array == 0).any()):
        rule = f"finite and {'positive' if positive else 'not negative'}"
        raise InputError(f"{law}: {name} = {value} must be {rule}{', one for each drive' * (size != 1)}", gains=value)
    if size is None:
        return array.astype(float)
    if array.size not in (1, size):
        rule = "one" if size == 1 else f"one, or one for each of {size} drives"
        raise InputError(f"{law}: {name} has {array.size} numbers; it must have {rule}")
    return np.broadcast_to(array, size).astype(float)


def numbers_or_traced(law: str, name: str, value: Any, rule: str) -> Any:
    """The value as an array of floats, or of traced numbers.  Raises InputError.  rule: what it must be."""
    try:
        array = np.asarray(value)
    except ValueError:  # lists of different lengths
        raise refused(law, name, value, rule) from None
    return array if is_traced(array) else checked_numbers(law, name, value, rule)


def motor_limits(robot: Robot) -> Any:
    """(n,) N m at the joint: motor torque limits that robot and drives state, BOUNDLESS where they state none."""
    return np.minimum(robot.effort_limits, BOUNDLESS)


def gain_matrices(law: str, name: str, value: Any, size: int) -> Any:
    """One symmetric positive definite matrix (6, 6) per body, from a number, (6,), (6, 6) or (size, 6, 6).

    Raises InputError where one is not positive definite, with its least eigenvalue.
    """
    array = numbers_or_traced(law, name, value, "numbers")
    if is_traced(array):
        return array
    if array.ndim == 0 or array.shape == (6,):
        array = np.broadcast_to(array, 6) * np.eye(6)
    if array.shape not in ((6, 6), (size, 6, 6)):
        shapes = f"(), (6,), (6, 6) or ({size}, 6, 6)"
        raise InputError(f"{law}: {name} has shape {array.shape}; it must have one of {shapes}", gains=value)
    array = np.broadcast_to(array, (size, 6, 6)).astype(float)
    for k, K in enumerate(array):
        if not np.isfinite(K).all() or not np.array_equal(K, K.T):
            raise InputError(f"{law}: {name} of body {k} must be finite and symmetric", gains=K)
        least = float(np.linalg.eigvalsh(K)[0])
        if least <= 0:
            rule = f"must be positive definite; its least eigenvalue is {least:.3g}"
            raise InputError(f"{law}: {name} of body {k} {rule}", gains=K)
    return array

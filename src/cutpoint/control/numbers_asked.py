"""Single numbers that users ask for: a period, a bandwidth, a duration, a count."""

from typing import Any

import numpy as np

from cutpoint.door import refused
from cutpoint.errors import InputError

_REAL = (int, float, np.integer, np.floating)


def number(function: str, name: str, value: Any, unit: str = "") -> float:
    """The argument as a float.  Raises InputError for anything but one real number."""
    if isinstance(value, bool) or not isinstance(value, (*_REAL, np.ndarray)) or np.ndim(value):
        raise refused(function, name, value, f"one number{unit and f', {unit}'}")
    return float(value)


def positive(function: str, name: str, value: Any, unit: str = "") -> float:
    """The argument as a float above zero.  Raises InputError for anything else."""
    found = number(function, name, value, unit)
    if not (np.isfinite(found) and found > 0):
        raise InputError(f"{function}: {name} {found}{unit and f' {unit}'} must be positive and finite", name=name)
    return found


def whole(function: str, name: str, value: Any, least: int = 1) -> int:
    """The argument as a whole number from `least` on.  Raises InputError for anything else."""
    if isinstance(value, bool) or not (isinstance(value, _REAL) and value >= least and value % 1 == 0):
        raise InputError(f"{function}: {name} {value!r} must be a whole number, at least {least}", name=name)
    return int(value)

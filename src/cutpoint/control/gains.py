"""Gains as laws keep them: arrays with one entry a drive, checked where a user gives them."""

from typing import Any

import numpy as np

from cutpoint.errors import InputError


def gains(law: str, name: str, value: Any) -> Any:
    """The gains as an array (n,), finite and not negative; gains of a law that is being traced pass as they are."""
    array = np.atleast_1d(np.asarray(value))
    if array.dtype == object:
        return array
    if array.ndim != 1 or not np.isfinite(array).all() or (array < 0).any():
        raise InputError(f"{law}: {name} = {value} must be finite and not negative, one for each drive", gains=value)
    return array.astype(float)

"""Numbers as JSON, which has neither infinity nor NaN, and no types of NumPy's."""

import json
from dataclasses import is_dataclass
from typing import Any

import numpy as np


def json_bytes(value: Any) -> bytes:
    """What a JSON file with these numbers holds."""
    return json.dumps(json_values(value), indent=1, ensure_ascii=False, allow_nan=False).encode()


def json_values(value: Any) -> Any:
    """The same in JSON's own types: null for a number that is not finite, nothing for a dataclass's field of None."""
    if isinstance(value, dict):
        return {str(name): json_values(each) for name, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_values(each) for each in value]
    if is_dataclass(value):
        return {name: json_values(each) for name, each in vars(value).items() if each is not None}
    if isinstance(value, (np.ndarray, np.generic)):
        return json_values(value.tolist())
    return None if isinstance(value, float) and not np.isfinite(value) else value

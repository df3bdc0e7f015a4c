"""Records: nests of dataclasses, tuples, lists, dicts and arrays, as a flat list of their numbers and back.

A whole number, a truth value, a text or None is structure, not a number: it stays in the record.
"""

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

_NEVER_NUMBERS = (str, bytes, bool, np.bool_, type(None))
_STRUCTURE = (*_NEVER_NUMBERS, int, np.integer)


def leaves(record: Any) -> list[Any]:
    """The numbers of a record, depth first, in the order of its fields."""
    found: list[Any] = []
    map_leaves(lambda x: found.append(x) or x, record)
    return found


def rebuild(record: Any, numbers: Iterator[Any]) -> Any:
    """A record of the same structure with these numbers."""
    return map_leaves(lambda _: next(numbers), record)


def with_float_leaves(record: Any) -> Any:
    """The same record with its whole numbers as floats, so that they count as numbers."""
    return map_leaves(lambda x: float(x) if isinstance(x, (int, np.integer)) else x, record, _NEVER_NUMBERS)


def map_leaves(function: Callable[[Any], Any], record: Any, structure: tuple[type, ...] = _STRUCTURE) -> Any:
    """A record of the same structure whose numbers are function(number)."""
    if isinstance(record, np.ndarray):
        return _array([function(x) for x in record.astype(object).reshape(-1)], record.shape)
    if isinstance(record, (list, tuple)):
        parts = [map_leaves(function, part, structure) for part in record]
        return type(record)(*parts) if hasattr(record, "_fields") else type(record)(parts)
    if isinstance(record, dict):
        return {key: map_leaves(function, part, structure) for key, part in record.items()}
    if is_dataclass(record) and not isinstance(record, type):
        names = [f.name for f in fields(record) if f.init]
        return replace(record, **{name: map_leaves(function, getattr(record, name), structure) for name in names})
    if isinstance(record, structure) or callable(record):
        return record
    return function(record)


def _array(elements: list[Any], shape: tuple[int, ...]) -> np.ndarray:
    array = np.array(elements, dtype=float if all(isinstance(x, float) for x in elements) else object)
    return array.reshape(shape)

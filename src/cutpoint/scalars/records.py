"""Records: nested dataclasses, tuples, lists, dicts and arrays, to a flat list of their numbers and back.

An integer, a bool, a string, or any object that is not a number is structure: it stays in the record.  A dict's numbers
come in the order of its sorted keys: equal dicts have equal numbers, whatever their insertion order.
"""

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any

import numpy as np

_NEVER_NUMBERS = (bool, np.bool_, str, bytes)
"""NumPy's texts are of these, and have a minus sign like its numbers."""

_STRUCTURE = (*_NEVER_NUMBERS, int, np.integer)


def leaves(record: Any) -> list[Any]:
    """The numbers of a record, depth first, in the order of its fields."""
    if type(record) is float:  # most are
        return [record]
    if isinstance(record, np.ndarray):
        return record.reshape(-1).tolist()
    parts = _parts(record)
    if parts is None:
        return [record] if _is_number(record) else []
    return [x for part in parts for x in leaves(part)]


def named_parts(record: Any) -> list[tuple[str, Any]]:
    """The items of a nest, in order, with their fields, keys, or indices in brackets; none for anything else."""
    parts = _parts(record)
    if not parts:
        return []
    if isinstance(record, dict):
        names = map(str, _keys(record))
    elif isinstance(record, (list, tuple)):
        names = getattr(record, "_fields", None) or [f"[{k}]" for k in range(len(record))]
    else:
        names = _fields(type(record))
    return [*zip(names, parts, strict=True)]


def rebuild(record: Any, numbers: Iterator[Any]) -> Any:
    """A record of the same structure with these numbers."""
    return map_leaves(lambda _: next(numbers), record)


def with_float_leaves(record: Any) -> Any:
    """The same record with its integers as floats, so that they count as numbers."""
    return map_leaves(lambda x: float(x) if isinstance(x, (int, np.integer)) else x, record, _NEVER_NUMBERS)


def map_leaves(function: Callable[[Any], Any], record: Any, structure: tuple[type, ...] = _STRUCTURE) -> Any:
    """A record of the same structure whose numbers are function(number)."""
    if isinstance(record, np.ndarray):
        return _array([function(x) for x in record.astype(object).reshape(-1)], record.shape)
    if isinstance(record, (list, tuple)):
        parts = [map_leaves(function, part, structure) for part in record]
        return type(record)(*parts) if hasattr(record, "_fields") else type(record)(parts)
    if isinstance(record, dict):
        parts = {key: map_leaves(function, record[key], structure) for key in _keys(record)}
        return {key: parts[key] for key in record}
    if is_dataclass(record) and not isinstance(record, type):
        parts = {name: map_leaves(function, getattr(record, name), structure) for name in _fields(type(record))}
        return _refilled(record, parts) if _is_law_of_user(record) else replace(record, **parts)
    if isinstance(record, structure) or not hasattr(type(record), "__neg__"):
        return record
    return function(record)


def constants(record: Any) -> list[Any]:
    """The contents of a record other than numbers, depth first."""
    parts = _parts(record)
    if parts is None:
        return [] if _is_number(record) else [record]
    return [x for part in parts for x in constants(part)]


def keys_of(record: Any) -> list[Any]:
    """The keys of all dicts in a record, depth first."""
    own = _keys(record) if isinstance(record, dict) else []
    return [*own, *(key for part in _parts(record) or () for key in keys_of(part))]


def is_of_cutpoint(thing: Any) -> bool:
    """Whether a thing's class is from this package."""
    return type(thing).__module__.partition(".")[0] == "cutpoint"


def structure_of(record: Any, known: Mapping[int, Hashable] | None = None) -> Hashable:
    """The structure of a record without its numbers: equal for records that can share a trace.

    An object that is not a record counts by its `trace_key`, if it has one, or by its identity.
    known: what parts count by instead, keyed by identity.
    """
    if type(record) is float:  # most are this, or nothing
        return float
    if record is None:
        return None
    if known and id(record) in known:
        return known[id(record)]
    if isinstance(record, np.ndarray):
        return (np.ndarray, record.shape)
    if isinstance(record, (list, tuple)):
        return (type(record), *(structure_of(part, known) for part in record))
    if isinstance(record, dict):
        return (dict, *((key, structure_of(record[key], known)) for key in _keys(record)))
    if is_dataclass(record) and not isinstance(record, type):
        return (type(record), *(structure_of(getattr(record, name), known) for name in _fields(type(record))))
    if isinstance(record, (*_STRUCTURE, str, bytes)):
        return (type(record), record)
    if hasattr(type(record), "__neg__"):
        return float
    return (type(record), getattr(record, "trace_key", id(record)))


def _parts(record: Any) -> Sequence[Any] | None:
    """The items of a nest, in order; None for anything else, and for an array."""
    if isinstance(record, (list, tuple)):
        return record
    if isinstance(record, dict):
        return [record[key] for key in _keys(record)]
    if is_dataclass(record) and not isinstance(record, type):
        return [getattr(record, name) for name in _fields(type(record))]
    return None


def _keys(record: dict[Any, Any]) -> list[Any]:
    return sorted(record, key=repr)


def _is_number(thing: Any) -> bool:
    """Whether a thing other than a nest counts as a number, or as an array of them."""
    return not isinstance(thing, _STRUCTURE) and hasattr(type(thing), "__neg__")


def _is_law_of_user(record: Any) -> bool:
    return hasattr(type(record), "step") and not is_of_cutpoint(record)


def _refilled(record: Any, parts: dict[str, Any]) -> Any:
    """A copy with other fields, for classes whose `__init__` may have other parameters, or change its arguments."""
    again = copy(record)
    for name, part in parts.items():
        object.__setattr__(again, name, part)
    return again


@cache
def _fields(kind: type) -> tuple[str, ...]:
    return tuple(f.name for f in fields(kind) if f.init)


def _array(elements: list[Any], shape: tuple[int, ...]) -> np.ndarray:
    array = np.array(elements, dtype=float if all(isinstance(x, float) for x in elements) else object)
    return array.reshape(shape)

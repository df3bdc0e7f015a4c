"""Ports: the named numbers, vectors and arrays that enter and leave a graph."""

import math
import operator
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from itertools import islice
from typing import Any, TypeVar

import numpy as np

from cutpoint.errors import InputError

Shape = tuple[int, ...]

T = TypeVar("T")


@dataclass(frozen=True)
class Port:
    """A named array: () is a scalar, (n,) a vector."""

    name: str
    shape: Shape

    @property
    def size(self) -> int:
        return math.prod(self.shape)


def port(name: str, shape: int | Sequence[int]) -> Port:
    """A port from a caller's shape: an int for a vector, () for a scalar, a tuple for an array."""
    try:
        lengths = tuple(operator.index(n) for n in ((shape,) if not isinstance(shape, Sequence) else shape))
    except TypeError:
        lengths = (-1,)
    if any(n < 0 for n in lengths):
        raise InputError(f"input {name!r}: shape {shape!r} must be (), a length or a tuple of lengths", name=name)
    return Port(name, lengths)


def nest(numbers: Iterator[Any], shape: Shape) -> Any:
    """The next numbers as a scalar, or as an array of a shape whose entries are objects."""
    if not shape:
        return next(numbers)
    size = math.prod(shape)
    return np.fromiter(islice(numbers, size), object, size).reshape(shape)


def flatten(value: Any) -> tuple[Shape, list[Any]]:
    """Shape and numbers of nested lists, tuples, arrays and dataclasses.

    Raises:
        ValueError: the nest is ragged.
    """
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value[()]
    parts = _parts(value)
    if parts is None:
        return (), [value]
    rows = [flatten(part) for part in parts]
    shapes = [*dict.fromkeys(shape for shape, _ in rows)]
    if len(shapes) > 1:
        raise ValueError(f"rows of shapes {', '.join(map(str, shapes))} do not make one array")
    return (len(parts), *(shapes[0] if shapes else ())), [x for _, row in rows for x in row]


def slots_of(ports: Sequence[Port], memory: Sequence[T]) -> list[tuple[T, int]]:
    """For every number, the memory that holds its port, and its offset there."""
    return [(own, k) for port, own in zip(ports, memory, strict=True) for k in range(port.size)]


def places_of(ports: Sequence[Port]) -> list[tuple[str, int]]:
    """For every number, the name of its port, and its offset there."""
    return slots_of(ports, [port.name for port in ports])


def slot_names(ports: Sequence[Port]) -> list[str]:
    """What every number is called: v[0], v[1], ..."""
    return [f"{name}[{k}]" for name, k in places_of(ports)]


def with_numbers(ports: Sequence[Port]) -> list[Port]:
    """The ports of nonzero size."""
    return [port for port in ports if port.size]


def record_fields(value: Any) -> dict[str, Any] | None:
    """The fields of a dataclass or NamedTuple instance by name; None for anything else."""
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: getattr(value, f.name) for f in fields(value)}
    return value._asdict() if isinstance(value, tuple) and hasattr(value, "_asdict") else None  # type: ignore[attr-defined]


def _parts(value: Any) -> list[Any] | None:
    if isinstance(value, np.ndarray):
        return [*value]
    if isinstance(value, (list, tuple)):
        return [*value]
    named = record_fields(value)
    return None if named is None else [*named.values()]

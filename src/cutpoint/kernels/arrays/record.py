"""The record of several outputs: a picklable NamedTuple made for a kernel."""

from collections import namedtuple
from collections.abc import Sequence
from functools import cache
from typing import Any


@cache
def record_class(name: str, fields: tuple[str, ...]) -> Any:
    """The same class for the same names, so that results unpickled from another process are instances of it."""
    made = namedtuple(name, fields)
    made.__reduce__ = lambda self: (_record, (name, fields, tuple(self)))  # type: ignore[method-assign]
    return made


def _record(name: str, fields: tuple[str, ...], values: Sequence[Any]) -> tuple[Any, ...]:
    return record_class(name, fields)(*values)

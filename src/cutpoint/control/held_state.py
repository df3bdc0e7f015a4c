"""Mutable state of a law, saved, compared and restored: attributes, closures, globals and their contents.

Modules are left out, and so are objects of NumPy, of this package (except laws) and of the standard library (except
those with state that advances by itself).
"""

import random
import sys
from array import array
from collections import deque
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from functools import cached_property, partial
from queue import Queue
from types import CellType, CodeType, FunctionType, MethodType, ModuleType, SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from cutpoint.control.law import FunctionLaw, Law

_NOTHING = object()
_PLAIN = (bool, int, float, complex, str, bytes, np.generic)


class _Kind(NamedTuple):
    """How to read the contents of an object, and how to write them if possible."""

    read: Callable[[Any], Any]
    write: Callable[[Any, Any], object] = lambda thing, content: None


class Held(NamedTuple):
    """An object, the name under which it was found, and its contents."""

    thing: Any
    name: str
    kind: _Kind
    content: Any


def held_by(law: Any) -> dict[int, Held]:
    """Everything reachable from a law, by identity."""
    found: dict[int, Held] = {}
    law = law.function if isinstance(law, FunctionLaw) else law
    waiting: list[tuple[str, Any]] = [("", law), ("", getattr(type(law), "step", None))]
    waiting += [("", base) for base in type(law).__mro__]
    while waiting:
        name, thing = waiting.pop()
        kind = None if id(thing) in found else _kind_of(thing)
        if kind is not None:
            content = kind.read(thing)
            found[id(thing)] = Held(thing, name, kind, content)
            if kind in _CLOSED:
                continue
            parts = content.items() if isinstance(content, dict) else [(name, x) for x in content]
            waiting += [(name or str(key).removeprefix("__dict__"), x) for key, x in parts]
    return found


def changed(before: dict[int, Held], after: dict[int, Held]) -> list[str]:
    """Names of the objects that have changed."""
    names: list[str] = []
    for key, then in before.items():
        was, now = then.content, after.get(key, then).content
        if not _alike(was, now):
            keys = was | now if isinstance(was, dict) and not then.name else ()
            names += [str(k) for k in keys if not _alike(was.get(k, _NOTHING), now.get(k, _NOTHING))] or [then.name]
    return names


def put_back(before: dict[int, Held]) -> None:
    """Restores everything that has changed; the rest is not touched."""
    for thing, _, kind, content in before.values():
        if not _alike(content, kind.read(thing)):
            kind.write(thing, content)


@contextmanager
def as_it_was(law: Any) -> Generator[None, None, None]:
    """Restores the law's state at the end of the block."""
    before = held_by(law)
    try:
        yield
    finally:
        put_back(before)


def _kind_of(thing: Any) -> _Kind | None:
    """How to read an object; None if its kind is left out."""
    is_function = isinstance(thing, FunctionType)
    for base in () if is_function else type(thing).__mro__[:-1]:
        if base in _KINDS:
            return _KINDS[base]
    is_class = isinstance(thing, type)
    package = str((thing if is_function or is_class else type(thing)).__module__).partition(".")[0]
    if package in sys.stdlib_module_names and hasattr(type(thing), "__next__"):
        return MOVING
    is_left_out = package in ("cutpoint", "numpy", *sys.stdlib_module_names) and not isinstance(thing, Law)
    if is_left_out or isinstance(thing, ModuleType):
        return None
    return _FUNCTION if is_function else _CLASS if is_class else _OBJECT


def _alike(one: Any, other: Any) -> bool:
    """Whether contents are equal; objects in them are compared by identity."""
    if one is other or type(one) is not type(other):
        return one is other
    if isinstance(one, np.ndarray) and one.dtype != object:
        return one.shape == other.shape and one.dtype == other.dtype and one.tobytes() == other.tobytes()
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_alike(x, other[key]) for key, x in one.items())
    if isinstance(one, np.ndarray):
        return one.shape == other.shape and all(map(_alike, one.ravel().tolist(), other.ravel().tolist()))
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(_alike, one, other))
    return isinstance(one, (*_PLAIN, set)) and bool(one == other or (one != one and other != other))


def _attributes(thing: Any) -> dict[str, Any]:
    """All attributes except cached properties, which follow from the others."""
    kind = type(thing)
    slots = [name for base in kind.__mro__ for name in vars(base).get("__slots__", ())]
    names = [name for name in (*slots, *getattr(thing, "__dict__", ())) if hasattr(thing, name)]
    return {name: getattr(thing, name) for name in names if not isinstance(getattr(kind, name, None), cached_property)}


def _set_attributes(thing: Any, attributes: dict[str, Any]) -> None:
    for name in _attributes(thing).keys() - attributes.keys():
        object.__delattr__(thing, name)
    for name, value in attributes.items():
        object.__setattr__(thing, name, value)


def _class_attributes(kind: type) -> dict[str, Any]:
    """Class attributes without methods, properties and Python's own."""
    return {k: x for k, x in vars(kind).items() if not k.startswith("__") and not hasattr(type(x), "__get__")}


def _set_class_attributes(kind: type, attributes: dict[str, Any]) -> None:
    for name in _class_attributes(kind).keys() - attributes.keys():
        delattr(kind, name)
    for name, value in attributes.items():
        setattr(kind, name, value)


def _variables(function: FunctionType) -> dict[str, Any]:
    """A function's closure and global variables, and its own attributes."""
    there = {name: function.__globals__[name] for name in _names(function.__code__) if name in function.__globals__}
    cells = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
    return {**there, **cells, "__dict__": function.__dict__, "__defaults__": function.__defaults__}


def _set_globals(function: FunctionType, variables: dict[str, Any]) -> None:
    known = function.__globals__
    known.update({name: x for name, x in variables.items() if name in _names(function.__code__) and name in known})


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names(inner)


def _cell(cell: CellType) -> list[Any]:
    try:
        return [cell.cell_contents]
    except ValueError:  # an empty cell
        return []


def _set_cell(cell: CellType, content: list[Any]) -> None:
    if content:
        cell.cell_contents = content[0]


def _refill(thing: Any, content: Any) -> None:
    thing.clear()
    thing.extend(content) if isinstance(thing, deque) else thing.update(content)


_FUNCTION = _Kind(_variables, _set_globals)
_OBJECT = _Kind(_attributes, _set_attributes)
_CLASS = _Kind(_class_attributes, _set_class_attributes)
_ARRAY = _Kind(np.copy, np.copyto)
_GENERATOR = _Kind(lambda g: g.bit_generator.state, lambda g, state: setattr(g.bit_generator, "state", state))
_RANDOM = _Kind(random.Random.getstate, random.Random.setstate)
_BYTES = _Kind(bytes, lambda thing, content: thing.__setitem__(slice(None), content))
_NUMBERS = _Kind(array.tolist, lambda thing, content: thing.__setitem__(slice(None), array(thing.typecode, content)))
MOVING = _Kind(lambda _: [])
"""Iterators, generators and files: what they hold cannot be read without moving them on."""

_KINDS: dict[type, _Kind] = {
    np.ndarray: _ARRAY, np.random.Generator: _GENERATOR, random.Random: _RANDOM,
    list: _Kind(list, lambda thing, content: thing.__setitem__(slice(None), content)),
    dict: _Kind(dict, _refill), set: _Kind(set, _refill), deque: _Kind(list, _refill),
    tuple: _Kind(list), partial: _Kind(lambda p: [p.func, p.args, p.keywords]),
    MethodType: _Kind(lambda m: [m.__self__, m.__func__]),
    CellType: _Kind(_cell, _set_cell), SimpleNamespace: _OBJECT, Queue: _OBJECT, bytearray: _BYTES, array: _NUMBERS,
}  # fmt: skip
_CLOSED = (_ARRAY, _GENERATOR, _RANDOM, _BYTES, _NUMBERS, MOVING)
"""Kinds that hold no further things."""

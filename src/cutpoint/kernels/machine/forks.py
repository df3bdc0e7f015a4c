"""Locks in a child process: fork copies those that other threads of the parent hold, and nobody releases them."""

import os
import sys
import threading
from collections.abc import Iterator
from functools import cached_property
from typing import Any
from weakref import WeakSet

_locks: "WeakSet[threading.Lock]" = WeakSet()


def new_lock() -> threading.Lock:
    """A lock that is released in a child process.  What it guards must be consistent, or rebuildable, at any time."""
    lock = threading.Lock()
    _locks.add(lock)
    return lock


def _open_all() -> None:
    for lock in _locks:
        if lock.locked():
            lock.release()
    for attributes in _cached_properties():
        if "lock" in attributes:  # before Python 3.12: held while the property is computed, for any object
            attributes["lock"] = threading.RLock()


def _cached_properties() -> Iterator[dict[str, Any]]:
    """The cached properties of this package's classes."""
    modules = [x for name, x in sys.modules.items() if name.partition(".")[0] == "cutpoint"]
    for kind in {x for module in modules for x in vars(module).values() if isinstance(x, type)}:
        yield from (vars(x) for x in vars(kind).values() if isinstance(x, cached_property))


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_open_all)

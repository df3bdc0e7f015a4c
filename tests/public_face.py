"""Writes tests/public_face.txt: what users may call, with the names and the order of its arguments.

python tests/public_face.py
"""

import inspect
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_suffix(".txt")

MODULES = (
    "", "analysis", "control", "derivatives", "export", "formats", "identification", "identification.drives", "kernels",
    "simulation", "trajectories",
)  # fmt: skip


def text() -> str:
    return "".join(f"{line}\n" for line in lines())


def lines() -> Iterator[str]:
    """Functions and constructors, package by package; then what classes have besides their constructor's arguments."""
    classes: dict[type, str] = {}
    for name in MODULES:
        module = import_module(f"cutpoint.{name}".rstrip("."))
        for key in sorted(module.__all__):
            if callable(found := getattr(module, key)):
                yield f"{name}{name and '.'}{key}{arguments(found)}"
                if isinstance(found, type):
                    classes.setdefault(found, f"{name}{name and '.'}{key}")
    for kind, name in classes.items():
        known = set().union(*(members(base) for base in kind.__mro__[1:] if base in classes))
        yield from (f"{name}.{member}" for member in sorted(members(kind) - known))


def members(kind: type) -> set[str]:
    """Methods, properties and constants, inherited ones too, if no class from elsewhere has them."""
    elsewhere = {key for base in kind.__mro__ if not base.__module__.startswith("cutpoint") for key in dir(base)}
    given = inspect.signature(kind).parameters if arguments(kind) else ()
    offered = [key for key in dir(kind) if not key.startswith("_") and key not in elsewhere and key not in given]
    return {f"{key}{arguments(found) if callable(found := getattr(kind, key)) else ''}" for key in offered}


def arguments(found: Any) -> str:
    """Of a function or a constructor, as in its definition, without types; none of protocols, enums and warnings."""
    if isinstance(found, type) and (issubclass(found, (Enum, Warning)) or getattr(found, "_is_protocol", False)):
        return ""
    parameters = inspect.signature(found).parameters.values()
    plain = [x.replace(annotation=x.empty, default=x.empty if x.default is x.empty else 0) for x in parameters]
    return str(inspect.Signature(plain)).replace("=0", "=").removesuffix(" -> None")


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")

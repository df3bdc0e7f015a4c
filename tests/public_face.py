"""Writes tests/public_face.txt: what users may call, with the names and the order of its arguments.

python tests/public_face.py
"""

import inspect
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Any

import cutpoint

FILE = Path(__file__).with_suffix(".txt")

MODULES = (
    "", "analysis", "control", "derivatives", "export", "formats", "identification", "identification.drives", "kernels",
    "simulation", "trajectories",
)  # fmt: skip
CLASSES = (cutpoint.Robot, cutpoint.Log, cutpoint.Kernel)
"""Classes whose methods are listed too."""


def text() -> str:
    return "".join(f"{line}\n" for line in lines())


def lines() -> Iterator[str]:
    for name in MODULES:
        module = import_module(f"cutpoint.{name}".rstrip("."))
        for key in sorted(module.__all__):
            if callable(found := getattr(module, key)):
                yield f"{name}{name and '.'}{key}{arguments(found)}"
    for kind in CLASSES:
        for key, found in sorted(vars(kind).items()):
            if not key.startswith("_"):
                yield f"{kind.__name__}.{key}{arguments(getattr(kind, key)) if callable(found) else ''}"


def arguments(found: Any) -> str:
    """Of a function or a constructor, as in its definition, without types; none of protocols, enums and warnings."""
    if isinstance(found, type) and (issubclass(found, (Enum, Warning)) or getattr(found, "_is_protocol", False)):
        return ""
    parameters = inspect.signature(found).parameters.values()
    plain = [x.replace(annotation=x.empty, default=x.empty if x.default is x.empty else 0) for x in parameters]
    return str(inspect.Signature(plain)).replace("=0", "=").removesuffix(" -> None")


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")

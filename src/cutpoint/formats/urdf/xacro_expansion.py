"""Expansion of .xacro files, by the `xacro` package where it is installed.

A xacro file is a program: it may include other files and evaluate expressions.  Expand only what you trust.
"""

import re
import sys
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

from cutpoint.errors import ModelError

_ROS = "ament_index_python"
"""The part of ROS that knows where packages are."""


def expand(path: Path, arguments: Mapping[str, str]) -> str:
    """The URDF text that a .xacro file stands for.

    $(find PACKAGE) asks ROS where that is installed, and else looks in the folders around the file.

    Raises ModelError: the package is missing, or it cannot expand the file.
    """
    try:
        import xacro
    except ImportError as problem:
        complaint = 'a .xacro file needs the xacro package: pip install "cutpoint[xacro]"'
        raise ModelError(complaint, place=path) from problem
    try:
        with _packages_around(path):
            texts = {name: str(value) for name, value in arguments.items()}
            document: Any = xacro.process_file(str(path), mappings=texts)  # typed as a file, but it is a DOM document
        return document.toprettyxml(indent="  ")
    except Exception as problem:  # expressions in the file may raise anything
        told, remedy = " ".join(str(problem).split()), ""
        if missing := re.search(r"Undefined substitution argument (\w+)", told):
            remedy = f"; give it: load(..., xacro={{{missing[1]!r}: ...}}), --xacro {missing[1]}:=VALUE"
        raise ModelError(f"xacro cannot expand this file: {told}{remedy}", place=path) from problem


@contextmanager
def _packages_around(path: Path) -> Generator[None, None, None]:
    """Where ROS is not installed, xacro finds packages in the folders around a file."""
    if find_spec(_ROS):
        yield
        return
    packages: Any = ModuleType(f"{_ROS}.packages")
    packages.get_package_share_directory = partial(_package, path)
    for module in (ModuleType(_ROS), packages):
        sys.modules[module.__name__] = module
    try:
        yield
    finally:
        del sys.modules[_ROS], sys.modules[packages.__name__]


def _package(path: Path, name: str) -> str:
    """The folder of a ROS package: one that holds the file, or one beside these."""
    for folder in path.resolve().parents:
        if _name_of(folder) == name:
            return str(folder)
        if _name_of(folder / name) == name:
            return str(folder / name)
    rule = "ROS, which knows all packages, is not installed; put the package's folder beside that of this file"
    raise ImportError(f"no folder around this file is the package {name!r}, and {rule}")


def _name_of(folder: Path) -> str | None:
    """What a folder's package.xml calls it."""
    try:
        text = (folder / "package.xml").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    found = re.search(r"<name>\s*([\w-]+)\s*</name>", text)
    return found and found[1]

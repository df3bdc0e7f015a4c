"""Expansion of .xacro files, by the `xacro` package where it is installed.

A xacro file is a program: it may include other files and evaluate expressions.  Expand only what you trust.
"""

import re
import sys
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

from cutpoint.errors import ModelError

_ROS = "ament_index_python"
"""The part of ROS that knows where packages are."""

_ENDS = ("maximum recursion depth exceeded", "File name too long")
"""What files that include each other in a circle end with, the second where each adds to a relative path."""

_STATE = ("filestack", "macrostack", "all_includes", "substitution_args_context")
"""What the module `xacro` changes in itself while it expands a file."""


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
    with _state_kept(xacro), _packages_around(path):
        try:
            texts = {name: str(value) for name, value in arguments.items()}
            document: Any = xacro.process_file(str(path), mappings=texts)  # typed as a file, but it is a DOM document
            return document.toprettyxml(indent="  ")
        except Exception as problem:  # expressions in the file may raise anything
            raise _refused(problem, xacro, path) from problem


def _refused(problem: Exception, xacro: Any, path: Path) -> ModelError:
    """The error for what went wrong, in the file where it did."""
    files, macros = xacro.filestack or [str(path)], xacro.macrostack or []
    told, remedy = " ".join(str(problem).split()).replace("substitution args not supported: ", ""), ""
    if any(end in told for end in _ENDS):
        told, files, macros = _circle(files, macros) or told, files[:1], []
    if missing := re.search(r"Undefined substitution argument (\w+)", told):
        remedy = f"; give it: load(..., xacro={{{missing[1]!r}: ...}}), --xacro {missing[1]}:=VALUE"
    within = "".join(f", in macro {_name(macro)!r} of {str(macro.history[-1][-1])!r}" for macro in reversed(macros))
    return ModelError(f"xacro cannot expand this file: {told}{within}{remedy}", place=files[-1])


def _circle(files: Sequence[str], macros: Sequence[Any]) -> str:
    """What files or macros lead back to themselves; "" if none do."""
    names = [str(Path(file).resolve()) for file in files]
    if circle := _since_it_was_last(names):
        return f"files include each other in a circle, {circle}; take one of these includes out"
    if circle := _since_it_was_last([*map(_name, macros)]):
        return f"macros call each other in a circle, {circle}; end it by an <xacro:if>"
    return ""


def _since_it_was_last(names: Sequence[str]) -> str:
    """The end of a list, from where its last name stood before."""
    before = [k for k, name in enumerate(names[:-1]) if name == names[-1]]
    return " -> ".join(map(repr, names[before[-1] :])) if before else ""


def _name(macro: Any) -> str:
    return macro.body.getAttribute("name")


@contextmanager
def _state_kept(xacro: Any) -> Generator[None, None, None]:
    """Whatever happens to a file, the module is as before."""
    before = {name: getattr(xacro, name) for name in _STATE if hasattr(xacro, name)}
    vars(xacro).update({name: copy(value) for name, value in before.items()})
    try:
        yield
    finally:
        vars(xacro).update(before)


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
    """The folder of a ROS package, the nearest that holds the file or is beside one that does.

    That is one whose package.xml has the name or, if there is none, a folder of that name without a package.xml.
    """
    folders = [folder for around in path.resolve().parents for folder in (around, around / name) if folder.is_dir()]
    found = [folder for folder in folders if _name_of(folder) == name]
    found += [folder for folder in folders if folder.name == name and _name_of(folder) is None]
    if found:
        return str(found[0])
    rule = "ROS, which knows all packages, is not installed; put the package's folder beside that of this file"
    raise ImportError(f"no folder around this file is the package {name!r} or has its name, and {rule}")


def _name_of(folder: Path) -> str | None:
    """What a folder's package.xml calls it."""
    try:
        text = (folder / "package.xml").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    found = re.search(r"<name>\s*([\w-]+)\s*</name>", text)
    return found and found[1]

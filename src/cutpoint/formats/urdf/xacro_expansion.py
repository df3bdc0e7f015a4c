"""Expansion of .xacro files, by the `xacro` package where it is installed.

A xacro file is a program: it may include other files and evaluate expressions.  Expand only what you trust.
"""

from pathlib import Path
from typing import Any

from cutpoint.errors import ModelError


def expand(path: Path) -> str:
    """The URDF text that a .xacro file stands for.

    Raises ModelError: the package is missing, or it cannot expand the file.
    """
    try:
        import xacro
    except ImportError as problem:
        complaint = 'a .xacro file needs the xacro package: pip install "cutpoint[xacro]"'
        raise ModelError(complaint, place=path) from problem
    try:
        document: Any = xacro.process_file(str(path))  # typed as a file by the package, but it is a DOM document
        return document.toprettyxml(indent="  ")
    except Exception as problem:  # expressions in the file may raise anything
        told, remedy, urdf = " ".join(str(problem).split()), "", f"{path.name.split('.')[0]}.urdf"
        if "ament_index_python" in told:
            remedy = f"; $(find ...) needs ROS: expand it where ROS is, xacro {path.name} > {urdf}, and give that file"
        if "Undefined substitution argument" in told:
            remedy = f"; set its arguments, xacro {path.name} NAME:=VALUE > {urdf}, and give that file"
        raise ModelError(f"xacro cannot expand this file: {told}{remedy}", place=path) from problem

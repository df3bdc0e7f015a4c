"""Orocos KDL's side: the distribution's library (on Debian or Ubuntu liborocos-kdl-dev), where it is installed.

Its chains are made as its reader of URDF files makes them: a joint about any axis, anywhere on its carrier.
"""

import ctypes
import shlex
import shutil
import subprocess
from functools import cache
from pathlib import Path

import compilers
import numpy as np
from cases import Case, Entry
from pinocchio_cpp import STANDARD, Robot

FUNCTIONS = {
    "inverse dynamics": "inverse_dynamics", "forward dynamics": "forward_dynamics", "mass matrix": "mass_matrix",
    "Jacobian": "jacobian",
}  # fmt: skip
"""Of kdl_cpp.cpp; it has none for the other tasks."""

AS_THERE = "-march=x86-64"
"""As the library was compiled, which holds the solvers: matrices of wider vectors would be aligned differently."""


def version() -> str:
    """The installed library's; empty where there is none, or no compiler."""
    return _told("--modversion") if compilers.version("g++") else ""


def _told(what: str) -> str:
    """By pkg-config."""
    command = ["pkg-config", what, "orocos-kdl"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() if shutil.which(command[0]) else ""


@cache
def built() -> ctypes.CDLL:
    text = Path(__file__).with_name("kdl_cpp.cpp").read_text()
    flags, linked = [*STANDARD, AS_THERE, *shlex.split(_told("--cflags"))], shlex.split(_told("--libs"))
    found = compilers.library(text, compiler="g++", suffix=".cpp", flags=flags, linked=linked)
    found.robot.restype = ctypes.c_void_p
    return found


def entries(case: Case, task: str, inputs: list[np.ndarray]) -> dict[str, Entry]:
    function = FUNCTIONS.get(task)
    if function is None or not version():
        return {}
    robot, out = Robot(built(), case.model, case.flange), np.empty((len(inputs[0]), *case.shape(task)))
    robot.run(function, inputs, out)
    return {"Orocos KDL": Entry(lambda: robot.run(function, inputs, None), out)}

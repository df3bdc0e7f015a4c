"""Exported C, built by the compiler that this machine has, and called."""

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.kernels import Graph

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wdouble-promotion", "-Werror", "-ffp-contract=off")


def compilers() -> list[str]:
    """gcc and clang, those that there are, or else cc; one is needed."""
    found = [path for name in ("gcc", "clang") if (path := shutil.which(name))] or [shutil.which("cc") or ""]
    assert all(found), "these tests need a C compiler: install gcc or clang (on Debian or Ubuntu: apt install gcc)"
    return found


def cpp_compilers() -> list[str]:
    """g++ and clang++, those that there are, or else c++; one is needed."""
    found = [path for name in ("g++", "clang++") if (path := shutil.which(name))] or [shutil.which("c++") or ""]
    assert all(found), "these tests need a C++ compiler: install g++ or clang++ (on Debian or Ubuntu: apt install g++)"
    return found


def build(folder: Path, *arguments: str, compiler: str = "", flags: Sequence[str] = STRICT) -> None:
    command = [compiler or compilers()[0], *flags, *arguments, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def run(folder: Path, program: str = "check") -> tuple[int, str]:
    done = subprocess.run([folder / program], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


class CFunction:
    """A C function of a graph's ports, built as a library, called on arrays of one case."""

    def __init__(self, folder: Path, name: str, graph: Graph, compiler: str = "", flags: Sequence[str] = ()) -> None:
        library = f"{name}-{Path(compiler).name}{''.join(flags)}.so"
        build(folder, "-shared", "-fPIC", f"{name}.c", "-o", library, compiler=compiler, flags=(*STRICT, *flags))
        self._inputs, self._outputs = ([p for p in ports if p.size] for ports in (graph.inputs, graph.outputs))
        self.call = ctypes.CDLL(str(folder / library))[name]
        self.call.restype = None

    def __call__(self, *arguments: Any) -> list[np.ndarray]:
        given = [np.array(x, float, order="C") for x in arguments]
        out = [np.full(p.shape, np.pi) for p in self._outputs]
        pairs = zip(self._inputs, given, strict=True)
        numbers = [pointer(x) if p.shape else ctypes.c_double(float(x)) for p, x in pairs]
        self.call(*numbers, *map(pointer, out))
        return out


def pointer(array: np.ndarray) -> Any:
    return array.ctypes.data_as(ctypes.c_void_p)


def assert_same_bits(found: Any, expected: Any) -> None:
    """Bit for bit; what is not a number has no bits of its own."""
    ours, theirs = np.asarray(found, float), np.asarray(expected, float)
    same = (ours.view(np.uint64) == theirs.view(np.uint64)) | (np.isnan(ours) & np.isnan(theirs))
    assert ours.shape == theirs.shape and same.all(), (ours[~same], theirs[~same])

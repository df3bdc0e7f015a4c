"""Logs as MATLAB files, to version 7; of version 7.3, which is HDF5, see `read_hdf5`."""

import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError, mat_struct

from cutpoint.identification.logs.mat_nesting import ARRAY, check_nesting
from cutpoint.identification.logs.read_hdf5 import read_hdf5
from cutpoint.identification.logs.table import LARGEST_FILE, Table, channel, read_as

HEADER = 128
"""Bytes before the first element of a version 5 file: MathWorks, MAT-File Format, "Level 5 MAT-File Format"."""

COMPRESSED = 15
"""The tag of an element compressed by zlib: the same, table 1-1."""

DEEPEST = 8
"""Deepest nesting of structures."""


def read_mat(path: Path) -> Table:
    """The matrices of numbers in a .mat, by name; the fields of structures as `rec.position`.

    Raises InputError: no MATLAB file, one that unpacks to more than `LARGEST_FILE` bytes, or whose cells nest too deep.
    """
    with path.open("rb") as file:
        start = file.read(HEADER)
    if start.startswith(b"MATLAB 7.3"):
        return read_hdf5(path)
    with read_as("MATLAB file", path, MatReadError, MemoryError, NotImplementedError):
        if 0 not in start[:4]:  # as SciPy distinguishes version 5 from 4, which neither compresses nor nests
            _check_elements(path, "little" if start[126:] == b"IM" else "big")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # on sparse matrices: none is read
            contents = loadmat(path, struct_as_record=False, squeeze_me=True, chars_as_strings=False)
    leaves = dict(_leaves("", contents, DEEPEST))
    channels = {name: found for name, values in leaves.items() if (found := channel(values))}
    left_out = {name: "cells or several structures" for name, values in leaves.items() if values.dtype == object}
    return Table(str(path), channels, left_out)


def _leaves(prefix: str, found: dict[str, Any], depth: int) -> Iterator[tuple[str, Any]]:
    """The arrays in structures, by their path."""
    for name, value in found.items():
        if isinstance(name, str) and not name.startswith("_"):
            if isinstance(value, mat_struct) and depth:
                yield from _leaves(f"{prefix}{name}.", vars(value), depth - 1)
            elif isinstance(value, np.ndarray):
                yield prefix + name, value


def _check_elements(path: Path, order: Any) -> None:
    """Raises ValueError for what SciPy would not refuse: more than `LARGEST_FILE` bytes, or too deep a nesting."""
    left = LARGEST_FILE
    with path.open("rb") as file:
        file.seek(HEADER)
        while len(tag := file.read(8)) == 8:
            kind, size = int.from_bytes(tag[:4], order), int.from_bytes(tag[4:], order)
            content = file.read(min(size, LARGEST_FILE))
            if kind == COMPRESSED:
                unpacked = zlib.decompressobj().decompress(content, left + 1)
                left -= len(unpacked)
                if left < 0:
                    raise ValueError(f"it unpacks to more than {LARGEST_FILE:,} bytes")
                check_nesting(memoryview(unpacked), order)
            elif kind == ARRAY:
                check_nesting(memoryview(tag + content), order)

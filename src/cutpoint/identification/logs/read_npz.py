"""Logs as NumPy archives: an array for each channel."""

import zipfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.logs.table import Table, channel, check_size, read_as

OBJECTS = "Python objects"


def read_npz(path: Path) -> Table:
    """The arrays of numbers in an .npz, by name; Python objects are never unpickled, and a note names them.

    Raises InputError: no archive of arrays, or one that unpacks to more than is read.
    """
    with opened_archive(path) as archive:
        members = archive.infolist()
        check_size(sum(member.file_size for member in members), "archive", str(path))
        if len({member.filename for member in members}) < len(members):
            raise ValueError("it holds two arrays of the same name")
        names = [name for name in archive.namelist() if name.endswith(".npy")]
        contents = {name.removesuffix(".npy"): _array(archive, name) for name in names}
    arrays = {name: values for name, values in contents.items() if not isinstance(values, str)}
    channels = {name: found for name, values in arrays.items() if (found := channel(values))}
    left_out = {name: kind for name, kind in contents.items() if isinstance(kind, str)}
    remedy = "they are never read; save an array of numbers"
    notes = tuple(f"{name!r} holds {OBJECTS}: {remedy}" for name, kind in left_out.items() if kind == OBJECTS)
    return Table(str(path), channels, left_out, notes)


@contextmanager
def opened_archive(path: Path) -> Generator[zipfile.ZipFile, None, None]:
    """An .npz to read from.  Raises InputError for any error in it, when opened and while it is read."""
    remedy = "; copy it again, or save it with NumPy"
    with read_as("archive of NumPy arrays", path, remedy=remedy), zipfile.ZipFile(path) as archive:
        packings = {member.compress_type for member in archive.infolist()}
        if not packings <= {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
            raise ValueError("its compression is not one that NumPy uses")
        yield archive


def _array(archive: zipfile.ZipFile, name: str) -> NDArray[Any] | str:
    """A member's numbers, or what it contains instead; ValueError for one that states more than it contains."""
    member = archive.getinfo(name)
    with archive.open(member) as file:
        read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
        shape, _, dtype = read[np.lib.format.read_magic(file)](file)
    if dtype.kind not in "fiub":
        return {"O": OBJECTS, "U": "text", "S": "text"}.get(dtype.kind, f"{dtype}, not numbers")
    if dtype.itemsize * int(np.prod(shape, dtype=object)) > member.file_size:
        raise ValueError(f"{name} of type {dtype} and shape {shape} is larger than its {member.file_size} bytes")
    with archive.open(member) as file:
        return np.lib.format.read_array(file, allow_pickle=False)

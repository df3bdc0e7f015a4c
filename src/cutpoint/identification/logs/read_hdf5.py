"""Logs as MATLAB files of version 7.3, which are HDF5."""

from pathlib import Path
from typing import Any

from cutpoint.identification.logs.table import Channel, Table, channel, check_size, optional, read_as

REFERENCES = "#refs#"
"""Where MATLAB stores the targets of cells and objects."""


def read_hdf5(path: Path) -> Table:
    """The matrices of numbers, by their path: `rec.position`.  Only this file is read, whatever links it contains.

    Raises InputError: no HDF5, or arrays of more than `LARGEST` bytes; CutpointError if h5py is missing.
    """
    h5py = optional("h5py", "a .mat file of version 7.3")
    channels: dict[str, Channel] = {}
    size = 0

    def visit(name: str, item: Any) -> None:
        nonlocal size
        # external or virtual data would let a log read any file
        if not isinstance(item, h5py.Dataset) or name.startswith(REFERENCES) or item.is_virtual or item.external:
            return
        if item.dtype.kind in "fiub" and "MATLAB_empty" not in item.attrs:
            size += item.nbytes
            check_size(size, "arrays", str(path))
            if found := channel(item[()]):
                channels[name.replace("/", ".")] = found

    with read_as("MATLAB file", path), h5py.File(path, "r") as file:
        file.visititems(visit)  # follows neither soft nor external links
    return Table(str(path), channels)

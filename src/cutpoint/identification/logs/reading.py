"""A log file as a table of channels; its kind is that of its suffix."""

from collections.abc import Callable
from pathlib import Path

from cutpoint.door import path_of
from cutpoint.errors import InputError
from cutpoint.files import check_readable
from cutpoint.identification.logs.own_log import is_own_log, read_own_log
from cutpoint.identification.logs.read_bag import read_bag
from cutpoint.identification.logs.read_csv import read_csv
from cutpoint.identification.logs.read_mat import read_mat
from cutpoint.identification.logs.read_npz import read_npz
from cutpoint.identification.logs.read_parquet import read_parquet
from cutpoint.identification.logs.table import LARGEST_FILE, Table

READERS: dict[str, Callable[[Path], Table]] = {
    ".csv": read_csv,
    ".db3": read_bag,
    ".mat": read_mat,
    ".mcap": read_bag,
    ".npz": read_npz,
    ".parquet": read_parquet,
    ".tsv": read_csv,
    ".txt": read_csv,
}


def read_table(path: str | Path) -> Table:
    """The channels of a log: .csv (.tsv, .txt), .npz, .mat, .parquet, a ROS 2 bag (.db3, .mcap, folder), or our own.

    Raises:
        InputError: no such file, an unsupported suffix, or a file that is not what its suffix says.
        CutpointError: a format whose library is missing; pip install 'cutpoint[logs]'.
    """
    path = path_of("read_table", path, "a log")
    if _is_folder(path):
        return read_bag(path)
    check_readable(path, LARGEST_FILE)
    ending = path.suffix.lower()
    if ending not in READERS:
        raise InputError(f"ending {path.suffix!r} of {path.name!r} must be one of {', '.join(READERS)}", path=path)
    if ending in (".csv", ".npz") and is_own_log(path):
        return read_own_log(path)
    return READERS[ending](path)


def _is_folder(path: Path) -> bool:
    """Whether a path is a folder; False also for one that the system refuses, which `check_readable` reports."""
    try:
        return path.is_dir()
    except OSError:
        return False

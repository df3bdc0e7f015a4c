"""Our own logs, as `Log.save` writes them: simulated measurements are read like those of a machine."""

from pathlib import Path

from cutpoint.identification.logs.read_npz import opened_archive
from cutpoint.identification.logs.table import Channel, Table
from cutpoint.simulation.log.log import Log

LONGEST_START = 1000
"""Bytes of a member within which its text starts."""


def is_own_log(path: Path) -> bool:
    """Whether a file begins like ours.  Raises InputError for an .npz that is not an archive, or is damaged."""
    if path.suffix.lower() == ".npz":
        with opened_archive(path) as archive:
            if "header.npy" not in archive.namelist():
                return False
            with archive.open("header.npy") as header:
                return '{"cutpoint_log"'.encode("utf-32-le") in header.read(LONGEST_START)
    with path.open("rb") as file:
        return file.read(17) == b'# {"cutpoint_log"'


def read_own_log(path: Path) -> Table:
    """The channels of a log, with its joints and units.  Raises InputError for any other file."""
    log = Log.load(path)
    found: dict[str, Channel] = {}
    for name, values in log.channels.items():
        unit = log.units[name]
        labels = log.joints if values.ndim == 2 else ()
        found[name] = Channel(values, labels, unit if isinstance(unit, str) else "", log.time)
    return Table(str(path), found)

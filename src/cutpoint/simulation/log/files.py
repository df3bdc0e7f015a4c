"""Logs as files.  An .npz holds an array per channel, `time`, and a `header` of JSON; a .csv the same as text.

The header is `{"cutpoint_log": 1, "joints": [...], "units": {...}, "meta": {...}}`.  In a .csv it is the first line,
after a `#`; the second names the columns as `q.elbow [rad]`.
"""

import csv
import io
import json
import zipfile
from array import array
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any, TextIO

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import InputError, counted
from cutpoint.files import UNREADABLE, check_readable, check_target_file, replacing
from cutpoint.simulation.log.log import Log, column_name

VERSION = 1

LARGEST_FILE = 1_000_000_000
"""Bytes of a file, and of the arrays in it: half an hour of sixty columns at 1 kHz."""

LONGEST_HEADER = 1_000_000
"""Characters."""

LINES_AT_ONCE = 1000
"""Of a .csv, before its size is looked at."""

LONGEST_LINE = 10_000_000
"""Characters of a line in a .csv."""

OTHER_COLUMNS = "its columns are not those its first line announces"


def save(log: Log, path: Path) -> None:
    """Writes the log; on failure an existing file stays unchanged.  Raises InputError if the path cannot be written."""
    write = _by_ending(path, {".npz": _write_npz, ".csv": _write_csv})
    check_target_file(path, "log")
    _check_size(sum(values.nbytes for values in log.channels.values()))
    with replacing(path) as file:
        write(log, file)
        _check_size(file.tell())


def _check_size(size: int) -> None:
    if size > LARGEST_FILE:
        remedy = "save parts of it, log.between(start, end), or simulate with only the channels= you need"
        raise InputError(f"log of {size:,} bytes is more than a file may hold, {LARGEST_FILE:,}: {remedy}", size=size)


def load(path: Path) -> Log:
    """Reads what `save` wrote."""
    read = _by_ending(path, {".npz": _read_npz, ".csv": _read_csv})
    check_readable(path, LARGEST_FILE)
    try:
        return read(path)
    except UNREADABLE as error:
        raise InputError(f"file is not a log written by Log.save: {error}", place=path) from error


def _by_ending(path: Path, choices: dict[str, Callable[..., Any]]) -> Callable[..., Any]:
    ending = path.suffix.lower()
    if ending not in choices:
        raise InputError(f"ending {path.suffix!r} of {path.name!r} must be one of {', '.join(choices)}", path=path)
    return choices[ending]


def _header(log: Log) -> str:
    header = json.dumps({"cutpoint_log": VERSION, "joints": log.joints, "units": log.units, "meta": log.meta})
    if len(header) >= LONGEST_HEADER:
        raise InputError(f"meta of {len(header):,} characters is too long for a file: at most {LONGEST_HEADER:,}")
    return header


def _parsed(header: str) -> dict[str, Any]:
    found = json.loads(header)
    version = found.pop("cutpoint_log") if isinstance(found, dict) else None
    if version != VERSION:
        raise ValueError(f"its version is {version}, not {VERSION}")
    if not isinstance(found["joints"], list):
        raise ValueError(f"its joints are {found['joints']!r}, not a list of names")
    return {"joints": found["joints"], "units": found["units"], "meta": found["meta"]}


def _write_npz(log: Log, file: IO[bytes]) -> None:
    arrays = {"header": np.array(_header(log)), "time": log.time, **log.channels}
    with zipfile.ZipFile(file, "w") as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, values, allow_pickle=False)


def _read_npz(path: Path) -> Log:
    with zipfile.ZipFile(path) as archive:
        if sum(member.file_size for member in archive.infolist()) > LARGEST_FILE:
            raise ValueError(f"its arrays are larger than {LARGEST_FILE:,} bytes")
        header = _parsed(_member(archive, "header").item())
        channels = {name: _member(archive, name) for name in header["units"]}
        return Log(_member(archive, "time"), channels, **header)


def _member(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """An array of the archive; its declared size is checked against the true one before memory is allocated."""
    member = archive.getinfo(f"{name}.npy")
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"the compression of {name} is not one that NumPy uses")
    with archive.open(member) as file:
        if np.lib.format.read_magic(file) != (1, 0):
            raise ValueError(f"{name} is not in version 1.0 of the format")
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    kind, most = ("U", 4 * LONGEST_HEADER) if name == "header" else ("f", LARGEST_FILE)
    if dtype.kind != kind:
        raise ValueError(f"{name} is of type {dtype}, not {'text' if kind == 'U' else 'float64'}")
    if not dtype.itemsize * int(np.prod(shape, dtype=object)) <= min(member.file_size, most):
        raise ValueError(f"{name} is of type {dtype} and shape {shape}, more than its {member.file_size} bytes hold")
    with archive.open(member) as file:
        return np.lib.format.read_array(file, allow_pickle=False)


def _titles(log: Log) -> list[str]:
    columns = [(column_name(name, joint), unit) for name in log.channels for joint, unit in log.columns(name)]
    return ["time [s]", *(f"{title} [{unit}]" for title, unit in columns)]


def _write_csv(log: Log, file: IO[bytes]) -> None:
    table = np.column_stack([log.time, *log.channels.values()])
    text = io.TextIOWrapper(file, encoding="utf-8", newline="")
    text.write(f"# {_header(log)}\n")
    writer = csv.writer(text, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    writer.writerow(_titles(log))
    for start in range(0, len(table), LINES_AT_ONCE):
        writer.writerows(table[start : start + LINES_AT_ONCE].tolist())
        _check_size(file.tell())
    text.detach()


def _read_csv(path: Path) -> Log:
    with path.open(encoding="utf-8", newline="") as text:
        lines = _lines(text)
        first = next(lines, "")
        if not first.startswith("# "):
            raise ValueError("its first line must be '# {\"cutpoint_log\": 1, ...}'; read other logs with read_table")
        header = _parsed(first.removeprefix("# "))
        reader = csv.reader(lines)
        titles = next(reader, [])
        numbers = array("d")
        for row in reader:
            numbers.extend(_numbers(row, len(titles), 1 + reader.line_num))
            # of the channels, and at most as much again of the time
            if numbers.itemsize * len(numbers) > 2 * LARGEST_FILE:
                raise ValueError(f"its channels are larger than {LARGEST_FILE:,} bytes")
    table = np.frombuffer(numbers).reshape(-1, max(1, len(titles)))
    log = Log(table[:, 0], _channels(titles, table, header), **header)
    if titles != _titles(log):
        raise ValueError(OTHER_COLUMNS)
    return log


def _lines(text: TextIO) -> Iterator[str]:
    """All lines; the last must end with a newline, or else its last number may be truncated.  Raises ValueError."""
    count = 0
    while line := text.readline(LONGEST_LINE):
        count += 1
        if not line.endswith(("\n", "\r")):
            raise ValueError(f"line {count} has no end: the file was cut off; copy it again, or remove that line")
        yield line


def _numbers(cells: list[str], width: int, line: int) -> list[float]:
    """A line's numbers.  Raises ValueError, with the line, for a wrong number of cells, or a cell without a number."""
    if len(cells) != width:
        rule = "copy the file again, or remove that line"
        raise ValueError(
            f"line {line} has {counted(len(cells), 'cell')}, but must have {width} like the line of titles; {rule}"
        )
    try:
        if any("_" in cell for cell in cells):  # Python takes 1_000 for a number
            raise ValueError(f"{next(cell for cell in cells if '_' in cell)!r} is not a number")
        return [float(cell) for cell in cells]
    except ValueError as error:
        raise ValueError(f"line {line}: {str(error)[:100]}") from error


def _channels(titles: list[str], table: Array, header: dict[str, Any]) -> dict[str, Array]:
    """The channels that the titles begin with, in turn: as many columns as there are joints, or one."""
    channels: dict[str, Array] = {}
    next_column = 1
    for name in header["units"]:
        alone = next_column < len(titles) and titles[next_column].startswith(f"{name} [")
        width = 1 if alone else len(header["joints"])
        if next_column + width > len(titles):
            raise ValueError(OTHER_COLUMNS)
        columns = table[:, next_column : next_column + width]
        channels[name] = columns[:, 0] if alone else columns
        next_column += width
    return channels

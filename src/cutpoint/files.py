"""Users' files and our output files: bounded reading, atomic writing."""

import csv
import stat
import tempfile
import zipfile
import zlib
from collections.abc import Generator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from secrets import token_hex
from tokenize import TokenError
from typing import Any, BinaryIO

from cutpoint.errors import InputError

UNREADABLE = (
    ValueError,
    TypeError,
    LookupError,
    EOFError,
    OSError,
    OverflowError,
    RuntimeError,
    SyntaxError,
    TokenError,
    csv.Error,
    zipfile.BadZipFile,
    zlib.error,
)
"""What the standard library and NumPy raise for a file that is not what it should be."""


def check_readable(path: Path, largest: int, remedy: str = "") -> None:
    """Raises InputError unless the path is a regular file of at most `largest` bytes.

    remedy: for a larger one.
    """
    try:
        if not path.is_file():
            what = "is not a regular file" if path.exists() else "does not exist"
            raise InputError(f"{str(path)!r} {what}; give the path of a file", path=path)
        size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{str(path)!r} cannot be read ({error.strerror}); give another path", path=path) from error
    if size > largest:
        rule = f"file of {size:,} bytes is too large: at most {largest:,} are read"
        raise InputError(f"{rule}; {remedy}" if remedy else rule, place=path, size=size)


def delimiter_of(line: str) -> str:
    """What separates the cells of a line of text: the first of semicolon, tab and comma that it contains, or blanks."""
    return next((mark for mark in ";\t," if mark in line), " ")


def check_target_file(path: Path, name: str = "output") -> None:
    """Checks a target before the work whose result is to be written there.

    name: of the path, in errors.

    Raises:
        InputError: the path is a folder, or no file can be written beside it.
    """
    with _told(path, name):
        if path.is_dir():
            raise InputError(f"{name} {str(path)!r} is a folder; name a file in it", path=path)
        if not path.parent.is_dir():
            rule = f"folder {str(path.parent)!r} does not exist; create it, or name another"
            raise InputError(f"{name} {str(path)!r}: {rule}", path=path)
        with tempfile.NamedTemporaryFile(prefix=f".{path.name}.", dir=path.parent):
            pass


def check_target_folder(folder: Path, name: str = "output") -> None:
    """The same for a folder that exists or will be created.

    Raises:
        InputError: it exists but is not a folder, or cannot be created or written to.
    """
    with _told(folder, name):
        with suppress(FileNotFoundError, NotADirectoryError):
            folder.stat()  # `exists` is silent about what no path can be
        there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        if not there.is_dir():
            raise InputError(f"{name} {str(there)!r} is not a folder; name an existing or a new one", output=folder)
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=there):
            pass


@contextmanager
def _told(path: Path, name: str) -> Generator[None, None, None]:
    """Reports what is wrong with a path, with the path that the user gave."""
    try:
        yield
    except InputError:
        raise
    except (OSError, ValueError, RuntimeError) as error:  # ValueError: a null byte; RuntimeError: a link to itself
        why = error.strerror if isinstance(error, OSError) else error
        what = f"{name} {str(path)!r} cannot be written ({why}); name a place where files can be created"
        raise InputError(what, path=path) from error


@contextmanager
def replacing(path: Path) -> Generator[BinaryIO, None, None]:
    """A file to write to that replaces the path on success, and otherwise leaves it unchanged.

    Raises InputError if no file can be created.
    """
    with _told(path, "file"):
        target = path.resolve()  # for a link, its target
        temporary = target.with_name(f".{target.name}.{token_hex(4)}")
        file = temporary.open("xb")
    try:
        with file:
            if target.exists():
                temporary.chmod(stat.S_IMODE(target.stat().st_mode))
            yield file
        temporary.replace(target)
    except BaseException as error:
        with suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError) and error.filename is None:
            # errors while writing, as on a full disk, do not name the file
            error.filename = str(path)
        raise


def save_figure(figure: Any, path: Path) -> None:
    """Saves a matplotlib figure in the format of the path's suffix, atomically as in `replacing`."""
    settings: Any = import_module("matplotlib").rc_context  # slow to import

    # neither the time nor names by chance: the same figure gives the same file
    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix.lower())
    with replacing(path) as file, settings({"svg.hashsalt": "cutpoint"}):
        figure.savefig(file, format=path.suffix.removeprefix("."), metadata=undated)

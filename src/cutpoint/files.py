"""Files that users bring and files that we leave: bounded reading, all-or-nothing writing."""

import os
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from cutpoint.errors import InputError


def check_readable(path: Path, largest: int) -> None:
    """Raises InputError unless the path is a regular file of at most `largest` bytes."""
    if not path.is_file():
        what = "is not a regular file" if path.exists() else "does not exist"
        raise InputError(f"{str(path)!r} {what}; give the path of a file", path=path)
    size = path.stat().st_size
    if size > largest:
        raise InputError(f"file of {size:,} bytes is too large: at most {largest:,} are read", place=path, size=size)


@contextmanager
def replacing(path: Path) -> Generator[BinaryIO, None, None]:
    """A file to write to that takes the path's place when all went well, and else leaves what was there."""
    descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with open(descriptor, "wb") as file:
            yield file
        # mkstemp lets only its owner read; a new file follows the user's mask
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise

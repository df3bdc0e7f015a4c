"""Machine code on disk, so that a second start does not compile.

A folder holds an entry a key: a header that names the key and the length and digest of the code, then the code.  What
stands in the way of keeping code - no home, a full disk, a folder that others may write to - turns the cache off, never
the work that would have used it: code is then compiled each time.  Entries appear whole under their names or not at
all, so that processes at once, and those that are killed, leave nothing that misleads the next.
"""

import hashlib
import os
import stat
import struct
import sys
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path

VARIABLE = "CUTPOINT_CACHE"
"""The environment variable that names another folder; empty, no cache is kept."""

LARGEST_FOLDER = 512 * 2**20
"""What the folder may hold, in bytes; where it holds more, what was used least recently goes."""

_SUFFIX = ".code"
_HEADER = struct.Struct("<8s32s32sQ")  # format, key, digest of the code, length of the code
_FORMAT = b"cutpnt01"
_FLAGS = os.O_RDONLY | sum(getattr(os, flag, 0) for flag in ("O_BINARY", "O_NOFOLLOW", "O_NONBLOCK"))
"""To open an entry with, as far as the platform has them; without the last a pipe in its place would be waited for."""
_WRITES_BETWEEN_LOOKS = 32
_ABANDONED = 3600.0
"""The age at which a temporary file is nobody's any more, s."""


def key_of(*parts: str) -> bytes:
    """A digest of everything that decides what the code is."""
    return hashlib.sha256(b"".join(hashlib.sha256(part.encode()).digest() for part in parts)).digest()


class Cache:
    """Code by key, in a folder of the user's own; see `user_folder`."""

    def __init__(self, folder: Path | None, largest: int = LARGEST_FOLDER) -> None:
        """folder: None keeps nothing.  largest: what it may hold, in bytes."""
        self._folder, self._largest, self._writes = folder, largest, 0

    def read(self, key: bytes) -> bytes | None:
        """The code kept under a key, verified; None if there is none that can be trusted."""
        path = self._path(key)
        if path is None:
            return None
        with suppress(OSError):
            content = _own_content(path)
            code = content[_HEADER.size :]
            if content[: _HEADER.size] == _header(key, code):
                with suppress(OSError):  # a file system may be there to be read only
                    os.utime(path)
                return code
        return None

    def write(self, key: bytes, code: bytes) -> None:
        """Keeps code, in place of what was there, if it can be kept."""
        path = self._path(key)
        if path is None:
            return
        with suppress(OSError):
            _write_whole(path, _header(key, code) + code)
            if self._writes % _WRITES_BETWEEN_LOOKS == 0:
                self._discard(path.parent)
            self._writes += 1

    def _path(self, key: bytes) -> Path | None:
        return self._folder / f"{key.hex()}{_SUFFIX}" if self._folder and _is_own_folder(self._folder) else None

    def _discard(self, folder: Path) -> None:
        """Down to what the folder may hold, and without what killed processes have left."""
        with os.scandir(folder) as entries:
            found = [(entry.stat().st_mtime, entry.stat().st_size, entry.path) for entry in entries]
        room = self._largest
        for used, size, path in sorted(found, reverse=True):
            is_entry = path.endswith(_SUFFIX)
            room -= size if is_entry else 0
            if room < 0 if is_entry else used < time.time() - _ABANDONED:
                with suppress(OSError):
                    os.unlink(path)


def user_folder() -> Path | None:
    """Where the user's code is kept: as the environment says, else with the user's other caches; None for nowhere."""
    named = os.environ.get(VARIABLE)
    if named == "":
        return None
    with suppress(OSError, RuntimeError):  # there may be no home, and no working directory
        # a folder inside, to be closed to others where the one that was named is not
        return (Path(named).absolute() if named else _caches() / "cutpoint") / "kernels"
    return None


@contextmanager
def not_kept() -> Generator[None, None, None]:
    """For those who time compilation: nothing is read from disk, and nothing kept."""
    before = os.environ.get(VARIABLE)
    os.environ[VARIABLE] = ""
    try:
        yield
    finally:
        os.environ.pop(VARIABLE)
        if before is not None:
            os.environ[VARIABLE] = before


def _caches() -> Path:
    """The folder of the user's caches, by the customs of the platform (XDG Base Directory Specification 0.8)."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    named = Path(os.environ.get("XDG_CACHE_HOME") or "")
    return named if named.is_absolute() else Path.home() / ".cache"


def _is_own_folder(folder: Path) -> bool:
    """Whether the folder, made if it is not there, is the user's and closed to all others."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = os.lstat(folder)
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and _is_own(found, 0o077)


def _is_own(found: os.stat_result, forbidden: int) -> bool:
    """Whether something is this user's, with none of these permissions; Windows keeps such folders by other means."""
    return not hasattr(os, "geteuid") or (found.st_uid == os.geteuid() and not found.st_mode & forbidden)


def _own_content(path: Path) -> bytes:
    """What a file of the user's own holds.

    Raises:
        OSError: there is none.
    """
    with open(path, "rb", opener=lambda name, _: os.open(name, _FLAGS)) as file:
        found = os.fstat(file.fileno())
        return file.read() if stat.S_ISREG(found.st_mode) and _is_own(found, 0o022) else b""


def _header(key: bytes, code: bytes) -> bytes:
    return _HEADER.pack(_FORMAT, key, hashlib.sha256(code).digest(), len(code))


def _write_whole(path: Path, content: bytes) -> None:
    descriptor, temporary = tempfile.mkstemp(dir=path.parent)
    try:
        with open(descriptor, "wb") as file:
            file.write(content)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise

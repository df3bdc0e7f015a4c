"""Machine code cached on disk, so that a second start does not compile.

A folder holds one entry per key: a header with the key and the length and digest of the code, then the code.  Whatever
prevents caching - no home, a full disk, a folder that others may write to - disables the cache but never the work that
would have used it: code is then compiled each time.  Entries are created atomically, so that concurrent processes, and
killed ones, leave nothing that misleads the next.
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
    """A digest of everything that determines the code."""
    return hashlib.sha256(b"".join(hashlib.sha256(part.encode()).digest() for part in parts)).digest()


class Cache:
    """Code by key, in a private folder of the user; see `user_folder`."""

    def __init__(self, folder: Path | None, largest: int = LARGEST_FOLDER) -> None:
        """folder: None to cache nothing.  largest: its capacity, bytes."""
        self._folder, self._largest, self._writes = folder, largest, 0

    def read(self, key: bytes) -> bytes | None:
        """The code cached under a key, verified; None if there is none that can be trusted."""
        path = self._path(key)
        if path is None:
            return None
        with suppress(OSError):
            content = _own_content(path)
            code = content[_HEADER.size :]
            if content[: _HEADER.size] == _header(key, code):
                with suppress(OSError):  # the file system may be read-only
                    os.utime(path)
                return code
        return None

    def write(self, key: bytes, code: bytes) -> None:
        """Caches code, replacing an earlier entry, if possible."""
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
        """Evicts entries down to the folder's capacity, and removes leftovers of killed processes."""
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
    """The folder of the user's code: from the environment, else among the user's caches; None for no caching."""
    named = os.environ.get(VARIABLE)
    if named == "":
        return None
    with suppress(OSError, RuntimeError):  # there may be no home and no working directory
        # a folder inside, to be closed to others where the one that was named is not
        return (Path(named).absolute() if named else _caches() / "cutpoint") / "kernels"
    return None


@contextmanager
def not_kept() -> Generator[None, None, None]:
    """Disables the cache, both reads and writes: for timing compilation."""
    before = os.environ.get(VARIABLE)
    os.environ[VARIABLE] = ""
    try:
        yield
    finally:
        os.environ.pop(VARIABLE)
        if before is not None:
            os.environ[VARIABLE] = before


def _caches() -> Path:
    """The user's cache folder by the platform's conventions (XDG Base Directory Specification 0.8)."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    named = Path(os.environ.get("XDG_CACHE_HOME") or "")
    return named if named.is_absolute() else Path.home() / ".cache"


def _is_own_folder(folder: Path) -> bool:
    """Whether the folder, created if missing, is the user's own and closed to others."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = os.lstat(folder)
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and _is_own(found, 0o077)


def _is_own(found: os.stat_result, forbidden: int) -> bool:
    """Whether this user owns it, with none of these permissions; Windows protects such folders by other means."""
    return not hasattr(os, "geteuid") or (found.st_uid == os.geteuid() and not found.st_mode & forbidden)


def _own_content(path: Path) -> bytes:
    """The content of a file that the user owns.

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

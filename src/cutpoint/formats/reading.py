"""Bytes and numbers from untrusted files."""

import math
import re
from pathlib import Path

from cutpoint.errors import ModelError

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


def read_bytes(path: Path, limit: int) -> bytes:
    """All of a regular file of at most `limit` bytes.

    Raises ModelError: missing, not a file, unreadable, empty, too large.
    """
    try:
        if not path.exists():
            raise ModelError(f"file {str(path)!r} does not exist", path=path)
        if not path.is_file():
            kind = "a directory" if path.is_dir() else "not a regular file"
            raise ModelError(f"{str(path)!r} is {kind}; give the path of a file", path=path)
        with path.open("rb") as file:
            content = file.read(limit + 1)
    except OSError as problem:
        raise ModelError(f"file {str(path)!r} cannot be read: {problem.strerror}", path=path) from problem
    if len(content) > limit:
        raise ModelError(f"file is larger than {limit:,} bytes, the limit", place=path)
    if not content.strip():
        raise ModelError("file is empty", place=path)
    return content


def parse_number(text: str) -> float | None:
    """The finite number a text writes in plain decimal notation, or None: no nan, no inf, no 1_000, no overflow."""
    if not _NUMBER.fullmatch(text):
        return None
    value = float(text)
    return value if math.isfinite(value) else None

"""The user's line, at which errors and warnings point."""

import sys
import warnings
from collections.abc import Iterator
from types import FrameType

_NOT_THE_USER = {"cutpoint", "numpy", "concurrent", "threading"}


def user_place() -> str | None:
    """File and line of the user's innermost frame; None in a thread that this package started."""
    for frame in _frames():
        if not is_ours(frame):
            return f"{frame.f_code.co_filename}:{frame.f_lineno}"
    return None


def warn(message: Warning | str, category: type[Warning] = UserWarning) -> None:
    """Warns at the user's line; at none if `user_place` finds none."""
    frames = [*map(is_ours, _frames())]
    warnings.warn(message, category, stacklevel=1 + (frames.index(False) if False in frames else len(frames)))


def _frames() -> Iterator[FrameType]:
    """The caller's frame and those around it, the innermost first."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        yield frame
        frame = frame.f_back


def is_ours(frame: FrameType) -> bool:
    """Whether a frame is of this package, or of what runs a user's code for it."""
    return str(frame.f_globals.get("__name__", "")).partition(".")[0] in _NOT_THE_USER

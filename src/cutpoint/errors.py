"""What can go wrong, said once: which thing, what was found, what was expected, where, and how to mend it."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

INTERRUPTED = 130
"""The exit status of a command that Ctrl-C ends, as shells have it."""


class CutpointError(Exception):
    """Base of every error that cutpoint raises on purpose.

    Attributes:
        evidence: what was found, by name, for programs that want to react (`error.evidence["joint"]`).
        place: file, and line where known, that the wrong value came from.
    """

    def __init__(self, message: str, *, place: str | Path | None = None, **evidence: Any) -> None:
        super().__init__(f"{message} ({place})" if place else message)
        self.place = str(place) if place else None
        self.evidence = evidence


class ModelError(CutpointError, ValueError):
    """A robot, a drive or a file that describes them is wrong."""


class InputError(CutpointError, ValueError):
    """An argument of a call is wrong: its shape, its numbers, or a name in it."""


class TraceError(CutpointError, TypeError):
    """A function cannot be traced into a kernel."""


class SimulationError(CutpointError, RuntimeError):
    """A simulation stopped before its end; `log` holds what it had reached."""

    def __init__(self, message: str, *, log: Any = None, **evidence: Any) -> None:
        super().__init__(message, **evidence)
        self.log = log


def unknown_name(kind: str, name: str, known: Collection[str], **kwargs: Any) -> InputError:
    """An error for a name that does not exist: it lists those that do."""
    names = ", ".join(repr(k) for k in known)
    return InputError(f"no {kind} is named {name!r}; there are: {names}", name=name, known=list(known), **kwargs)

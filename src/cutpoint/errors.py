"""Errors: each says which thing, what was found, what was expected, where, and how to fix it."""

import difflib
import re
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

INTERRUPTED = 130
"""The exit status of a command that Ctrl-C ends, as shells have it."""

LONG_LIST = 24
"""Up to this many names an error lists them all; of more, those that are like the wrong one, or a cut list."""

AT_A_GLANCE = 3
"""Names among which nobody overlooks the right one."""

LONGEST_MESSAGE = 20_000
"""Characters of a message, which may quote what a file holds; of a longer one the middle is left out."""

MOST_GUESSED = 3

LONGEST_GUESS = 100
"""Characters of a wrong name that are compared: the cost grows with their square."""


class CutpointError(Exception):
    """Base of every error that cutpoint raises on purpose.

    Attributes:
        evidence: what was found, by name, for programs that want to react (`error.evidence["joint"]`).
        place: file, and line where known, that the wrong value came from.
    """

    def __init__(self, message: str, *, place: str | Path | None = None, **evidence: Any) -> None:
        if len(message) > LONGEST_MESSAGE:
            message = f"{message[: LONGEST_MESSAGE // 2]} ... {message[-LONGEST_MESSAGE // 2 :]}"
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
    """A simulation stopped before its end; `log` holds its results so far."""

    def __init__(self, message: str, *, log: Any = None, **evidence: Any) -> None:
        super().__init__(message, **evidence)
        self.log = log


def unknown_name(kind: str, name: str, known: Collection[str], **kwargs: Any) -> InputError:
    """An error for an unknown name, which lists those that exist."""
    complaint = f"no {kind} is named {name!r}; {those_that_exist(name, known)}"
    return InputError(complaint, name=name, known=list(known), **kwargs)


def those_that_exist(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name: the known names and the closest one; of many, only close ones.

    None is close that differs in digits only: joint 6 of a robot with five is not its joint 5.
    """
    known = list(known)
    near = [x for x in close_to(name, known) if not _numbered_alike(x, name)] if len(known) > AT_A_GLANCE else []
    if near and len(known) > LONG_LIST:
        return f"did you mean {' or '.join(map(repr, near))}?"
    meant = f"; did you mean {near[0]!r}?" if near else ""
    return f"there are: {listed(known)}{meant}" if known else "there are none"


def close_to(name: Any, known: Iterable[str]) -> list[str]:
    """Names that a wrong one is a prefix of, or resembles, ignoring case; none for anything but a name."""
    if not isinstance(name, str):
        return []
    folded, asked = {str(one).casefold(): one for one in known}, name.casefold()[:LONGEST_GUESS]
    begun = [one for one in folded if asked and one.startswith(asked)][:MOST_GUESSED]
    return [folded[one] for one in begun or difflib.get_close_matches(asked, folded, MOST_GUESSED)]


def _numbered_alike(one: str, other: str) -> bool:
    """Whether two names, whatever their case, differ in digits and in nothing else."""
    one, other = one.casefold(), other.casefold()
    return one != other and re.sub(r"\d+", "0", one) == re.sub(r"\d+", "0", other)


def counted(count: int, noun: str) -> str:
    """`1 sample`, `2 samples`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def listed(names: Iterable[str], separator: str = ", ") -> str:
    """Quoted names for a message; a long list is cut in the middle."""
    quoted = [repr(name) for name in names]
    if len(quoted) > LONG_LIST:
        quoted = [*quoted[: LONG_LIST // 2], f"... ({len(quoted)} in all)", quoted[-1]]
    return separator.join(quoted)

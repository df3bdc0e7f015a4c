"""Where the parts of a robot are written, so that an error can say it."""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cutpoint.errors import ModelError

SHORT_LIST = 12
"""Up to this many names an error lists them all; beyond, only those that resemble the wrong one."""

LONGEST_GUESS = 100
"""Characters of a wrong name that are compared: the cost grows with their square."""


@dataclass(frozen=True)
class Places:
    """A file and the lines of its parts, keyed as messages name them: `link 'base'`, `joint 'elbow'`."""

    file: str | Path | None = None
    lines: Mapping[str, int] = field(default_factory=dict)

    def of(self, thing: str) -> str | None:
        """`arm.urdf:41`, or the file alone where the line is not known, or None."""
        line = self.lines.get(thing)
        return f"{self.file}:{line}" if line and self.file else str(self.file) if self.file else None

    def error(self, thing: str, complaint: str, **evidence: Any) -> ModelError:
        """A ModelError about one part: `joint 'elbow': axis has zero length (arm.urdf:41)`."""
        return ModelError(f"{thing}: {complaint}", place=self.of(thing), thing=thing, **evidence)


def listed(names: Sequence[str], separator: str = ", ") -> str:
    """Quoted names for a message; a long list is cut in the middle."""
    quoted = [repr(name) for name in names]
    if len(quoted) > SHORT_LIST:
        quoted = [*quoted[: SHORT_LIST - 2], f"... ({len(quoted)} in all)", quoted[-1]]
    return separator.join(quoted)


def those_that_exist(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name: which names there are, or which come near."""
    known = list(known)
    if not known:
        return "there are none"
    if len(known) <= SHORT_LIST:
        return f"there are: {listed(known)}"
    near = difflib.get_close_matches(name[:LONGEST_GUESS], known, n=3, cutoff=0.5)
    return f"did you mean {' or '.join(map(repr, near))}?" if near else f"none of the {len(known)} names comes near"

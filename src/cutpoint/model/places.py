"""Source locations of a robot's parts, for error messages."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cutpoint.errors import ModelError


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

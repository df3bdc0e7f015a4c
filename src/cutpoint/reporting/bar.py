"""Progress bars on stderr for work that takes longer than a user likes to wait."""

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

SHOWN_AFTER, EVERY = 1.0, 0.1
"""s: before a bar appears, and between its updates."""


class Bar:
    """what: the work, such as "simulating".  total: `done` at its end."""

    def __init__(self, what: str, total: float) -> None:
        self._what, self._total, self._next = what, total, time.perf_counter() + SHOWN_AFTER
        self._progress: Progress | None = None
        self._task: TaskID

    def show(self, done: float) -> None:
        """Shows the progress; may be called as often as desired."""
        now = time.perf_counter()
        if now < self._next:
            return
        self._next = now + EVERY
        if self._progress is None:
            from cutpoint.reporting.standing import Standing  # slow to import

            self._progress = Standing(lines=False)
            self._progress.start()
            self._task = self._progress.add_task(self._what, total=self._total)
        self._progress.update(self._task, completed=done)

    def __enter__(self) -> "Bar":
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

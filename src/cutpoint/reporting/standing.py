"""How far long work is: a bar on a terminal, and elsewhere, as in a log, a line from time to time."""

import time
from typing import Any

from rich.console import Console
from rich.progress import Progress, ProgressColumn, TaskID

EVERY = 10.0
"""s, between lines where nobody sees a bar."""


class Standing(Progress):
    """On stderr, a bar that is gone once its work is done, or lines.  shown: whether there is either."""

    def __init__(self, *columns: ProgressColumn, shown: bool = True, lines: bool = True) -> None:
        console = Console(stderr=True)
        # where nobody sees a bar Rich would leave an empty line of it
        seen = console.is_interactive or console.is_jupyter
        self._next = time.perf_counter() + EVERY if shown and lines and not seen else float("inf")
        super().__init__(*columns, console=console, transient=True, disable=not (shown and seen))

    def update(self, task_id: TaskID, **news: Any) -> None:
        super().update(task_id, **news)
        self._say()

    def advance(self, task_id: TaskID, advance: float = 1) -> None:
        super().advance(task_id, advance)
        self._say()

    def _say(self) -> None:
        if time.perf_counter() < self._next:
            return
        self._next = time.perf_counter() + EVERY
        task = self.tasks[-1]
        told = f"{task.description}, {task.percentage:.0f} % done" if task.total else task.description
        self.console.print(told, markup=False, highlight=False, soft_wrap=True)

"""A progress bar on stderr for slow steps."""

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn


class Steps:
    """Called with the name of a step, which ends the one before."""

    def __init__(self, count: int, shown: bool) -> None:
        columns = (
            SpinnerColumn(),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}", markup=False),
        )
        self._bar = Progress(*columns, console=Console(stderr=True), transient=True, disable=not shown)
        self._task = self._bar.add_task("", total=count)
        self._begun = 0
        self._count = count

    def expect(self, more: int) -> None:
        """Adds so many steps to the total."""
        self._count += more
        self._bar.update(self._task, total=self._count)

    def __call__(self, words: str) -> None:
        self._bar.update(self._task, description=words, completed=self._begun)
        self._begun += 1

    def __enter__(self) -> "Steps":
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

"""The stand of slow steps on stderr."""

from rich.progress import BarColumn, MofNCompleteColumn, SpinnerColumn, TextColumn, TimeElapsedColumn

from cutpoint.reporting.standing import Standing


class Steps(Standing):
    """Called with the name of a step, which ends the one before."""

    def __init__(self, count: int, shown: bool) -> None:
        columns = (
            SpinnerColumn(),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}", markup=False),
        )
        super().__init__(*columns, shown=shown)
        self._task = self.add_task("", total=count, completed=-1, visible=False)

    def expect(self, more: int) -> None:
        """Adds so many steps to the total."""
        self.update(self._task, total=(self.tasks[0].total or 0) + more)

    def __call__(self, words: str) -> None:
        self.update(self._task, description=words, advance=1, visible=True)

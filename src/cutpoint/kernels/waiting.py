"""What a user sees, and can do, while code is made that takes its time."""

import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, TypeVar

from cutpoint.kernels.forks import new_lock

T = TypeVar("T")

SHOWN_AFTER = 1.0
"""Until then a wait passes without a word, s."""

_HEARD_WITHIN = 0.1
"""The longest time that Ctrl-C goes unheard where a waiting thread cannot be interrupted, s."""

_terminal = new_lock()


@contextmanager
def shown(what: str) -> Generator[None, None, None]:
    """Says on a terminal what is compiled if that takes long; only the outermost of several speaks."""
    is_mine = sys.stderr is not None and sys.stderr.isatty() and _terminal.acquire(blocking=False)
    if not is_mine:
        yield
        return
    bars: list[Any] = []
    timer = threading.Timer(SHOWN_AFTER, lambda: bars.append(_bar(what)))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        for bar in bars:
            bar.stop()
        _terminal.release()


def _bar(what: str) -> Any:
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("compiling {task.description}", markup=False), TimeElapsedColumn())
    # what a traced function prints stays where it belongs
    bar = Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=False, redirect_stderr=False)
    bar.add_task(what, total=None)
    bar.start()
    return bar


def interruptible(work: Callable[[], T]) -> T:
    """What some work in machine code returns, or raises, done by another thread so that Ctrl-C is heard at once.

    After Ctrl-C the work goes on unseen, to no end but what it does besides returning.
    """
    found: list[T] = []
    failed: list[BaseException] = []

    def run() -> None:
        try:
            found.append(work())
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=run, name="cutpoint compiles", daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(_HEARD_WITHIN)
    if failed:
        raise failed[0]
    return found[0]

"""Progress messages, and Ctrl-C, during long compilations."""

import math
import sys
import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, TypeVar

from cutpoint.kernels.machine.forks import new_lock

T = TypeVar("T")

SHOWN_AFTER = 1.0
"""Until then a wait passes without a word, s."""

_HEARD_WITHIN = 0.1
"""The longest time that Ctrl-C goes unheard where a waiting thread cannot be interrupted, s."""

PAUSE = 0.2
"""Compilations that follow one another within this time are one wait, s."""

_terminal = new_lock()


class _Wait:
    """Start of the current wait, and end of its last compilation, s."""

    began = ended = -math.inf


@contextmanager
def shown(what: str) -> Generator[None, None, None]:
    """Reports on a terminal what is being compiled after a long wait; only the outermost of nested calls does."""
    is_mine = sys.stderr is not None and sys.stderr.isatty() and _terminal.acquire(blocking=False)
    if not is_mine:
        yield
        return
    now = time.monotonic()
    if now - _Wait.ended > PAUSE:
        _Wait.began = now
    bars: list[Any] = []
    timer = threading.Timer(max(0.0, _Wait.began + SHOWN_AFTER - now), lambda: bars.append(_bar(what)))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        for bar in bars:
            bar.stop()
        _Wait.ended = time.monotonic()
        _terminal.release()


def _bar(what: str) -> Any:
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("compiling {task.description}", markup=False), TimeElapsedColumn())
    # keeps a traced function's own output in place
    bar = Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=False, redirect_stderr=False)
    bar.add_task(what, total=None)
    bar.start()
    return bar


def interruptible(work: Callable[[], T]) -> T:
    """The result, or error, of work in machine code, run in another thread so that Ctrl-C acts at once.

    After Ctrl-C the work still runs to its end: its result is lost, its side effects remain.
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

"""The command line: one thin command per job, in `commands/`."""

import atexit
import gc
import os
import sys
import warnings
from io import TextIOWrapper
from typing import Any

from cutpoint.errors import INTERRUPTED, CutpointError

UNREAD = 141
"""The exit status of a command whose reader has gone, as shells have it."""


def main() -> None:
    """Entry point: errors, warnings and Ctrl-C as one line, without a traceback; `| head` ends it without a word."""
    try:
        _run()
    except SystemExit as ended:
        # Typer and Rich make 1 of it, as of an error
        if isinstance(ended.__context__, BrokenPipeError):
            sys.exit(UNREAD)
        raise


def _run() -> None:
    # what a command makes stays until its end: looking for garbage more often, and once more at the end, finds none
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    # pydantic would look through all installed packages for plugins of its own
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    warnings.showwarning = _warn
    # a terminal that cannot show a joint's name shows what it stands for
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        # here, so that Ctrl-C is heard while it is imported
        from cutpoint.commands import app

        app()
    except CutpointError as error:
        _say("red", "error", str(error))
        sys.exit(1)
    except OSError as error:
        # writing to what is open already, such as standard output, knows no name
        what = error.filename or "the output cannot be written"
        _say("red", "error", f"{what}: {error.strerror or error}")
        sys.exit(1)
    except (KeyboardInterrupt, ImportError) as stopped:
        # a module in C++ that Ctrl-C finds half imported makes an ImportError of it
        if isinstance(stopped, ImportError) and not isinstance(stopped.__cause__, KeyboardInterrupt):
            raise
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


def _warn(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    _say("yellow", "warning", str(message))


def _say(style: str, kind: str, message: str) -> None:
    from rich.console import Console
    from rich.markup import escape

    console = Console(stderr=True, emoji=False)
    # a file keeps each in one line, to be searched
    console.print(f"[{style}]{kind}:[/] {escape(message)}", highlight=False, soft_wrap=not console.is_terminal)

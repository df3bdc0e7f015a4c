"""The command line: one thin command per job, in `commands/`."""

import atexit
import gc
import sys
import warnings
from importlib import import_module
from typing import Any

from rich.console import Console
from rich.markup import escape

from cutpoint.commands.shared import app
from cutpoint.errors import CutpointError

# as they are imported, commands register themselves, in the order of the help
for room in ("robots", "drives", "deployment", "identification", "studies"):
    import_module(f"cutpoint.commands.{room}")


def main() -> None:
    """Entry point: errors and warnings as one line, without a traceback."""
    # what a command makes stays until its end: looking for garbage more often, and once more at the end, finds none
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    stderr = Console(stderr=True, emoji=False)

    def show(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        stderr.print(f"[yellow]warning:[/] {escape(str(message))}", highlight=False)

    warnings.showwarning = show
    try:
        app()
    except CutpointError as error:
        stderr.print(f"[red]error:[/] {escape(str(error))}", highlight=False)
        sys.exit(1)
    except OSError as error:
        stderr.print(f"[red]error:[/] {escape(str(error.filename))}: {escape(str(error.strerror))}", highlight=False)
        sys.exit(1)


if __name__ == "__main__":
    main()

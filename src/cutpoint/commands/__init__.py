"""One thin command per task, grouped by topic."""

from importlib import import_module

from cutpoint.commands.shared import app

__all__ = ["app"]

# commands register themselves on import, in the order of the help
for room in ("robots", "torques", "logs", "drives", "deployment", "identification", "studies"):
    import_module(f"cutpoint.commands.{room}")

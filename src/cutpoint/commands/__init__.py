"""One thin command per job, by what they are about."""

from importlib import import_module

from cutpoint.commands.shared import app

__all__ = ["app"]

# as they are imported, commands register themselves, in the order of the help
for room in ("robots", "torques", "logs", "drives", "deployment", "identification", "studies"):
    import_module(f"cutpoint.commands.{room}")

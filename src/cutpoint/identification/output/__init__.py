"""From a log to files: `identify`, what it found, its report."""

from cutpoint.identification.output.identify import Identification, identify

__all__ = ["Identification", "identify"]

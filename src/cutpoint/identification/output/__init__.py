"""From a log to files: `identify`, its result, its report."""

from cutpoint.identification.output.identification import Identification
from cutpoint.identification.output.identify import identify

__all__ = ["Identification", "identify"]

"""Time at which this process began to load the modules that write code."""

import time

LOADED_AT = time.time_ns()
"""ns since 1970."""

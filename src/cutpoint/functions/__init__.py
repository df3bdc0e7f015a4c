"""A robot's functions: compiled at their first use, with validated arguments."""

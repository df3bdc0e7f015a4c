"""Logs of machines: reading, mapping of channels, units, and plausibility checks."""

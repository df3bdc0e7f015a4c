"""Stepping programs: stages in loops that step through memory, as one machine-code function or interpreted."""

"""Recordings made fit to compute with: clocks, filters, derivatives, fewer rows."""

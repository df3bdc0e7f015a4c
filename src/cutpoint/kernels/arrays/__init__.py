"""Graphs on NumPy arrays: arguments of calls, and their execution on one element, on rows and on blocks."""

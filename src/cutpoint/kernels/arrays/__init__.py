"""Graphs on NumPy's arrays: what a call may be given, and what runs it on one element, on rows and on blocks."""

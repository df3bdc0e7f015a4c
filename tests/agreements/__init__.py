"""The package's results for random inputs against the transcript's, equation by equation.

A function under `@equations("(29)", ...)` takes a random generator and returns pairs (ours, the transcript's).
"""

"""What the package makes of random inputs, beside what the transcript makes of them, equation by equation.

A function under `@equations("(29)", ...)` takes a random generator and returns pairs (ours, the transcript's).
"""

"""For each numbered equation of the paper, what the package makes of random inputs beside what the transcript makes of them.

A function under `@equations("(29)", ...)` takes a random generator and returns pairs (ours, the transcript's).
"""

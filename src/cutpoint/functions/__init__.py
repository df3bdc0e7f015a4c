"""A robot's functions: made at their first use, behind a door that checks what they are given."""
